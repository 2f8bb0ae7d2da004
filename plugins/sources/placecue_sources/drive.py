"""A robot that drives through all places of a plan, again and again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from placecue.observation import Pose2D
from placecue_sources.plan import Plan
from placecue_sources.roads import Roads

Points = NDArray[np.float64]


class Drive:
    """An endless drive along shortest paths to random goals in all places, nearest place first.

    Parameters
    ----------
    plan : Plan
        Where to drive.
    clearance : float
        Least distance of the planned path to a wall, m.
    step : float
        Distance between two poses, m.
    turn : float
        Angle between two poses while the robot turns on the spot at a goal, rad.
    smoothing : float
        Standard deviation of the Gaussian that rounds the path's corners, m.
    spacing : float
        Distance between the points that paths are planned over, m.
    """

    def __init__(
        self,
        plan: Plan,
        clearance: float,
        step: float,
        turn: float,
        smoothing: float,
        spacing: float,
    ) -> None:
        self.plan = plan
        self.clearance = clearance
        self.step = step
        self.turn = turn
        self.smoothing = smoothing
        self.free = plan.clearance()
        self.roads = Roads(plan, self.free, clearance, spacing)

    def poses(self, rng: np.random.Generator) -> Iterator[Pose2D]:
        """Yield poses without end."""
        heading: float | None = None
        for corners in self._legs(rng):
            path = self._smooth(corners)
            headings = np.unwrap(np.arctan2(*np.gradient(path, axis=0).T[::-1]))
            if heading is not None:
                yield from self._turn(path[0], heading, headings[0])
            for (x, y), theta in zip(path, headings, strict=True):
                yield Pose2D(float(x), float(y), float(theta), "map")
            heading = headings[-1]

    def _legs(self, rng: np.random.Generator) -> Iterator[Points]:
        """Yield paths from goal to goal, m, each of shape (n, 2) with n > 1."""
        roads = self.roads
        here = int(rng.integers(roads.size))
        left: set[int] = set()
        while True:
            left = left or set(range(roads.places))
            search = roads.search(here)
            place = min(left, key=lambda number: search.length_to_place[number])
            goals = np.flatnonzero(roads.place == place)
            path = search.path(int(goals[rng.integers(goals.size)]))
            left -= set(roads.place[path].tolist()) | {place}
            here = int(path[-1])
            if len(path) > 1:
                yield roads.points[path]

    def _smooth(self, corners: Points) -> Points:
        """Return the path at a step's distance from pose to pose, with round corners."""
        fine = _resampled(corners, self.step / 4)
        width = self.smoothing / (self.step / 4)
        smooth = gaussian_filter1d(fine, width, axis=0, mode="nearest") if width > 0 else fine
        smooth[[0, -1]] = fine[[0, -1]]
        rows, columns = self.plan.grid.cells(*smooth.T)
        wide = self.free[rows, columns] >= self.clearance
        return _resampled(np.where(wide[:, None], smooth, fine), self.step)

    def _turn(self, point: Points, start: float, end: float) -> Iterator[Pose2D]:
        """Yield the poses between two headings at a goal, the shorter way round."""
        angle = np.arctan2(np.sin(end - start), np.cos(end - start))
        count = int(np.ceil(abs(angle) / self.turn))
        for theta in start + angle * np.arange(1, count) / max(count, 1):
            yield Pose2D(float(point[0]), float(point[1]), float(theta), "map")


def _resampled(path: Points, step: float) -> Points:
    """Return points along a path at equal distances of at most ``step``, at least two of them."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    count = max(2, int(np.ceil(along[-1] / step)) + 1)
    wanted = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(wanted, along, path[:, axis]) for axis in (0, 1)])
