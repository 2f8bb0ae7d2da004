"""A simulated 2D laser scanner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from placecue.observation import LaserScan, Pose2D
from placecue_sources.raycast import OccupancyGrid, cast_rays


@dataclass(frozen=True, slots=True)
class Scanner:
    """A scanner in the middle of the robot, looking ahead.

    Parameters
    ----------
    field_of_view : float
        Angle covered, degrees. Under 360 the outer beams lie on its two ends; at 360 the beams
        are spread evenly, the first pointing backwards.
    beams : int
        Number of beams.
    max_range : float
        Longest range, m.
    noise : float
        Standard deviation of a range, m.
    """

    field_of_view: float
    beams: int
    max_range: float
    noise: float

    def angles(self) -> NDArray[np.float64]:
        """Return the direction of each beam, rad, shape (beams,)."""
        full = np.deg2rad(self.field_of_view)
        around = self.field_of_view >= 360
        return np.linspace(-full / 2, full / 2, self.beams, endpoint=not around)

    def scan(self, grid: OccupancyGrid, pose: Pose2D, rng: np.random.Generator) -> LaserScan:
        """Return what the scanner measures at a pose; infinite where nothing is in reach."""
        angles = self.angles()
        ranges = cast_rays(grid, pose.x, pose.y, angles + pose.theta, self.max_range)
        ranges += self.noise * rng.standard_normal(ranges.size)
        return LaserScan(angles, np.maximum(ranges, 0.0), 0.0, self.max_range)
