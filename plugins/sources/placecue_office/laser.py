"""The robot's laser scanner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from placecue.observation import LaserScan, Pose2D
from placecue_office.trace import cast


@dataclass(frozen=True, slots=True)
class Laser:
    """A scanner in the middle of the robot that looks ahead.

    Parameters
    ----------
    beams : int
        Number of beams, over the whole field of view.
    field_of_view : float
        Degrees, up to 360.
    max_range : float
        Longest measured length, m; beams that go farther are infinite.
    noise : float
        Standard deviation of a length, m.
    min_range : float
        Shortest measured length, m.
    """

    beams: int
    field_of_view: float
    max_range: float
    noise: float
    min_range: float = 0.02

    def angles(self) -> NDArray[np.float64]:
        """Return the direction of each beam in the robot's frame, rad, shape (beams,)."""
        half = np.radians(0.5 * self.field_of_view)
        whole_turn = self.field_of_view >= 360.0
        return np.linspace(-half, half, self.beams, endpoint=not whole_turn)

    def scan(self, faces: NDArray[np.float64], pose: Pose2D, rng: np.random.Generator) -> LaserScan:
        """Measure.

        Parameters
        ----------
        faces : ndarray, shape (k, 4)
            What stands at the laser's height: x0, y0, x1, y1 in m.
        pose : Pose2D
            Where the robot truly is.
        rng : Generator
            Draws the noise.
        """
        angles = self.angles()
        lengths = cast(faces, pose.x, pose.y, pose.theta + angles)
        ranges = lengths + self.noise * rng.standard_normal(self.beams)
        ranges[lengths > self.max_range] = np.inf
        return LaserScan(angles, np.maximum(ranges, 0.0), self.min_range, self.max_range)
