"""Where the laser hit and where the robot was truly: the background of a map picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import Observation, Pose2D


class Surroundings:
    """Gathers laser end points and the labelled path of a log; a listener.

    Points and path are thinned to a grid as they come, so memory grows with the space seen and
    not with time.

    Parameters
    ----------
    cell : float
        Side of a grid cell, m.
    """

    def __init__(self, cell: float = 0.1) -> None:
        self.cell = cell
        self._cells: set[tuple[int, int]] = set()
        self._path: dict[tuple[int, int], tuple[float, float, str]] = {}

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take in the scan and the pose of one observation."""
        pose = observation.pose
        if pose is None:
            return
        if observation.scan is not None:
            points = _placed(observation.scan.points(), pose)
            self._cells.update(map(tuple, np.round(points / self.cell).astype(int).tolist()))
        if observation.label is not None:
            key = (round(pose.x / self.cell), round(pose.y / self.cell))
            self._path[key] = (pose.x, pose.y, observation.label)

    @property
    def points(self) -> NDArray[np.float64]:
        """Centres of the cells that the laser hit, m, shape (k, 2)."""
        cells = np.array(sorted(self._cells), dtype=np.float64).reshape(-1, 2)
        return cells * self.cell

    @property
    def truth(self) -> list[tuple[float, float, str]]:
        """The path with the true label at each place, (x, y, label), m; empty if unlabelled."""
        return list(self._path.values())


def _placed(points: NDArray[np.float64], pose: Pose2D) -> NDArray[np.float64]:
    c, s = np.cos(pose.theta), np.sin(pose.theta)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + [pose.x, pose.y])
