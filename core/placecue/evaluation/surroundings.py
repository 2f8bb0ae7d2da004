"""Where the laser hit, where the robot was truly, and what it believed: for a map picture."""

from __future__ import annotations

from array import array

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.free_space import FREE, Grid
from placecue.observation import Observation, Pose2D

#: Side of a tile, cells: a bit each.
TILE = 64


class LabelledWay:
    """The way of a robot with labels, the last one of each cell.

    Parameters
    ----------
    cell : float
        Side of a cell, m.
    """

    def __init__(self, cell: float) -> None:
        self.cell = cell
        self._rows: dict[int, int] = {}  # of the cells of the way
        self._at = array("d")  # x, y of each row
        self._labels = array("i")
        self._names: dict[str, int] = {}

    def add(self, pose: Pose2D, label: str) -> None:
        """Take note of a position and what it is called."""
        cell = round(pose.x / self.cell) * 2**32 + round(pose.y / self.cell)
        name = self._names.setdefault(label, len(self._names))
        row = self._rows.setdefault(cell, len(self._labels))
        if row == len(self._labels):
            self._at.extend((pose.x, pose.y))
            self._labels.append(name)
        else:
            self._at[2 * row], self._at[2 * row + 1] = pose.x, pose.y
            self._labels[row] = name

    @property
    def places(self) -> list[tuple[float, float, str]]:
        """The positions in order, (x, y, label), m."""
        names = list(self._names)
        xy = zip(self._at[::2], self._at[1::2], self._labels, strict=True)
        return [(x, y, names[label]) for x, y, label in xy]


class Surroundings:
    """Gathers laser end points, the labelled path of a log and what was believed; a listener.

    Points and path are thinned to a grid as they come, so memory grows with the space seen and
    not with time: a bit for each cell of a tile that was hit, and the last labels of each cell of
    the way. Poses of another frame than the first are left out.

    Parameters
    ----------
    cell : float
        Side of a grid cell, m.
    """

    def __init__(self, cell: float = 0.1) -> None:
        self.cell = cell
        self.frame: str | None = None
        self._tiles: dict[tuple[int, int], NDArray[np.uint8]] = {}
        self._truth = LabelledWay(cell)
        self._beliefs = LabelledWay(cell)

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take in the scan, the pose and the labels of one observation."""
        pose = observation.pose
        if pose is None:
            return
        self.frame = pose.frame if self.frame is None else self.frame
        if pose.frame != self.frame:
            return
        if observation.scan is not None:
            points = _placed(observation.scan.points(), pose)
            self._hit(np.round(points / self.cell).astype(np.int64))
        if observation.label is not None:
            self._truth.add(pose, observation.label)
        if belief is not None:
            self.believe(pose, belief.label)

    def believe(self, pose: Pose2D, label: str) -> None:
        """Take note of a position and what was believed there."""
        self._beliefs.add(pose, label)

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
        return self._truth.places

    @property
    def beliefs(self) -> list[tuple[float, float, str]]:
        """The path with what was believed at each place, (x, y, label), m."""
        return self._beliefs.places

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


def _placed(points: NDArray[np.float64], pose: Pose2D) -> NDArray[np.float64]:
    c, s = np.cos(pose.theta), np.sin(pose.theta)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + [pose.x, pose.y])


def walls(points: NDArray[np.float64], grid: Grid | None) -> NDArray[np.float64]:
    """Return the hit cells that did not turn out to be free later: what does not move.

    Parameters
    ----------
    points : ndarray of float64, shape (k, 2)
        Centres of the cells that the laser hit, m.
    grid : Grid or None
        Free space; None leaves all.
    """
    if grid is None or not len(points):
        return points
    seen = np.full(len(points), True)
    for corner in ((-1, -1), (-1, 1), (1, -1), (1, 1)):  # a point may lie where four cells meet
        seen &= grid.state_at(points + np.array(corner) * grid.cell / 4) == FREE
    return np.asarray(points[~seen])
