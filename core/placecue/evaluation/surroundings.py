"""Where the laser hit and where the robot was truly: the background of a map picture."""

from __future__ import annotations

from array import array

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import Observation, Pose2D

#: Side of a tile, cells: a bit each.
TILE = 64


class Surroundings:
    """Gathers laser end points and the labelled path of a log; a listener.

    Points and path are thinned to a grid as they come, so memory grows with the space seen and
    not with time: a bit for each cell of a tile that was hit, and the last label of each cell of
    the way.

    Parameters
    ----------
    cell : float
        Side of a grid cell, m.
    """

    def __init__(self, cell: float = 0.1) -> None:
        self.cell = cell
        self._tiles: dict[tuple[int, int], NDArray[np.uint8]] = {}
        self._rows: dict[int, int] = {}  # of the cells of the way
        self._way = array("d")  # x, y of each row
        self._labels = array("i")
        self._names: dict[str, int] = {}

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take in the scan and the pose of one observation."""
        pose = observation.pose
        if pose is None:
            return
        if observation.scan is not None:
            points = _placed(observation.scan.points(), pose)
            self._hit(np.round(points / self.cell).astype(np.int64))
        if observation.label is not None:
            self._pass(pose, observation.label)

    @property
    def points(self) -> NDArray[np.float64]:
        """Centres of the cells that the laser hit, m, shape (k, 2)."""
        found = [np.empty((0, 2), np.int64)]
        for (i, j), bits in self._tiles.items():
            columns, rows = np.nonzero(np.unpackbits(bits, axis=1))
            found.append(np.column_stack([columns + i * TILE, rows + j * TILE]))
        cells = np.concatenate(found)
        ordered = cells[np.lexsort((cells[:, 1], cells[:, 0]))]
        return np.asarray(ordered * self.cell, dtype=np.float64)

    @property
    def truth(self) -> list[tuple[float, float, str]]:
        """The path with the true label at each place, (x, y, label), m; empty if unlabelled."""
        names = list(self._names)
        xy = zip(self._way[::2], self._way[1::2], self._labels, strict=True)
        return [(x, y, names[label]) for x, y, label in xy]

    def _hit(self, cells: NDArray[np.int64]) -> None:
        if not len(cells):
            return
        tiles, of = np.unique(cells // TILE, axis=0, return_inverse=True)
        for number, (i, j) in enumerate(tiles.tolist()):
            tile = self._tiles.get((i, j))
            if tile is None:
                tile = self._tiles[i, j] = np.zeros((TILE, TILE // 8), np.uint8)
            columns, rows = (cells[of.ravel() == number] % TILE).T
            np.bitwise_or.at(tile, (columns, rows // 8), (128 >> rows % 8).astype(np.uint8))

    def _pass(self, pose: Pose2D, label: str) -> None:
        cell = round(pose.x / self.cell) * 2**32 + round(pose.y / self.cell)
        name = self._names.setdefault(label, len(self._names))
        row = self._rows.setdefault(cell, len(self._labels))
        if row == len(self._labels):
            self._way.extend((pose.x, pose.y))
            self._labels.append(name)
        else:
            self._way[2 * row], self._way[2 * row + 1] = pose.x, pose.y
            self._labels[row] = name


def _placed(points: NDArray[np.float64], pose: Pose2D) -> NDArray[np.float64]:
    c, s = np.cos(pose.theta), np.sin(pose.theta)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + [pose.x, pose.y])
