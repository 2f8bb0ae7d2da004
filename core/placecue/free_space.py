"""Where the robot saw that it could go: a grid of free and occupied cells, from poses and scans."""

from __future__ import annotations

import logging
from collections import defaultdict
from dataclasses import dataclass
from math import hypot, isfinite, pi

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import LaserScan, Observation, Pose2D

#: Side of a tile, cells.
TILE = 64
#: What a beam that went through a cell, and one that ended there, add to it; and the limits.
THROUGH, ENDED, LIMIT = -1, 3, 60
#: Cells that a grid may have: 300 m by 300 m of 0.1 m. A pose far away would make it as large as
#: one likes.
MOST = 9_000_000
#: What is known of a cell.
FREE, OCCUPIED, UNSEEN = np.uint8(0), np.uint8(1), np.uint8(2)

Cells = NDArray[np.int64]

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Grid:
    """Cells of a map.

    Parameters
    ----------
    states : ndarray of uint8, shape (rows, columns)
        FREE, OCCUPIED or UNSEEN; row 0 is the lowest y.
    cell : float
        Side of a cell, m.
    x, y : float
        Lower left corner, m.
    frame : str
        The frame of the positions.
    """

    states: NDArray[np.uint8]
    cell: float
    x: float
    y: float
    frame: str

    def cells_of(self, points: NDArray[np.float64]) -> Cells:
        """Return row and column of positions (m, shape (n, 2)), those outside left out."""
        columns, rows = np.floor((points - [self.x, self.y]) / self.cell).astype(np.int64).T
        height, width = self.states.shape
        inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        return np.asarray(np.column_stack([rows, columns])[inside])

    def state_at(self, points: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Return what is known of positions (m, shape (n, 2)); UNSEEN outside."""
        columns, rows = np.floor((points - [self.x, self.y]) / self.cell).astype(np.int64).T
        height, width = self.states.shape
        inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        found = np.full(len(points), UNSEEN)
        found[inside] = self.states[rows[inside], columns[inside]]
        return found


class FreeSpace:
    """Gathers free and occupied cells; a listener.

    A cell is free where more beams went through it than ended there, or the robot stood there;
    people who walk past vanish with the next beams. Memory grows with the space seen, 1 byte a
    cell. Poses of another frame than the first, which cannot be put on one map, are left out.

    Parameters
    ----------
    cell : float
        Side of a cell, m.
    longest : float
        Beams are followed so far, m.
    radius : float
        Radius of the robot, m: where it stands is free.
    every, turn : float
        Scans are used after so much motion, m or rad.
    """

    def __init__(
        self,
        cell: float = 0.1,
        longest: float = 8.0,
        radius: float = 0.25,
        every: float = 0.1,
        turn: float = 0.1,
    ) -> None:
        self.cell = cell
        self.longest = longest
        self.radius = radius
        self.every = every
        self.turn = turn
        self.frame: str | None = None
        self._tiles: dict[tuple[int, int], NDArray[np.int8]] = defaultdict(
            lambda: np.zeros((TILE, TILE), np.int8)
        )
        self._last: Pose2D | None = None

    def observe(
        self,
        observation: Observation,
        belief: Belief | None = None,
        update: AreaUpdate | None = None,
    ) -> None:
        """Take in the scan and the pose of one observation."""
        pose = observation.pose
        if pose is None or not all(map(isfinite, (pose.x, pose.y, pose.theta))):
            return
        self.frame = pose.frame if self.frame is None else self.frame
        if pose.frame != self.frame or not self._moved(pose):
            return
        self._last = pose
        if observation.scan is not None:
            through, ended = self._beams(pose, observation.scan)
            self._add(through, THROUGH)
            self._add(ended, ENDED)
        self._set_free(self._footprint(pose))

    def grid(self) -> Grid | None:
        """Return what is known so far; None where nothing is."""
        if not self._tiles:
            return None
        kept = _together(sorted(self._tiles))
        if lost := len(self._tiles) - len(kept):
            log.warning(
                f"{lost} of {len(self._tiles)} pieces of free space lie so far from the others "
                "that no map holds both: rooms there have no surface"
            )
        keys = np.array(kept)
        low, high = keys.min(axis=0), keys.max(axis=0) + 1
        columns, rows = (high - low) * TILE
        values = np.zeros((rows, columns), np.int8)
        for i, j in kept:
            tile = self._tiles[i, j]
            at = (j - low[1]) * TILE, (i - low[0]) * TILE
            values[at[0] : at[0] + TILE, at[1] : at[1] + TILE] = tile
        states = np.where(values < 0, FREE, np.where(values > 0, OCCUPIED, UNSEEN))
        corner = low * TILE * self.cell
        return Grid(states, self.cell, float(corner[0]), float(corner[1]), self.frame or "odom")

    def _moved(self, pose: Pose2D) -> bool:
        last = self._last
        if last is None or hypot(pose.x - last.x, pose.y - last.y) >= self.every:
            return True
        return abs((pose.theta - last.theta + pi) % (2 * pi) - pi) >= self.turn

    def _beams(self, pose: Pose2D, scan: LaserScan) -> tuple[Cells, Cells]:
        """Return the cells that beams went through, and those that they ended in."""
        valid = scan.valid()
        origin = pose.compose(scan.mount)
        ranges, angles = scan.ranges[valid], scan.angles[valid] + origin.theta
        towards = np.column_stack([np.cos(angles), np.sin(angles)])
        steps = np.arange(0, self.longest, self.cell)
        within = steps[None, :] < np.minimum(ranges, self.longest)[:, None] - self.cell
        beam, step = np.nonzero(within)
        start = np.array([origin.x, origin.y])
        through = self._cells(start + steps[step, None] * towards[beam])
        near = ranges <= self.longest
        ended = self._cells(start + ranges[near, None] * towards[near])
        return through, ended

    def _footprint(self, pose: Pose2D) -> Cells:
        reach = np.arange(-self.radius, self.radius + self.cell / 2, self.cell / 2)
        x, y = (each.ravel() for each in np.meshgrid(reach, reach))
        disc = np.hypot(x, y) <= self.radius
        return self._cells(np.column_stack([pose.x + x[disc], pose.y + y[disc]]))

    def _cells(self, points: NDArray[np.float64]) -> Cells:
        """Return column and row of each cell that some points lie in, once."""
        return np.unique(np.floor(points / self.cell).astype(np.int64), axis=0)

    def _add(self, cells: Cells, what: int) -> None:
        for tile, rows, columns in self._in_tiles(cells):
            values = tile[rows, columns].astype(np.int64) + what
            tile[rows, columns] = np.clip(values, -LIMIT, LIMIT)

    def _set_free(self, cells: Cells) -> None:
        for tile, rows, columns in self._in_tiles(cells):
            tile[rows, columns] = -LIMIT

    def _in_tiles(self, cells: Cells) -> list[tuple[NDArray[np.int8], Cells, Cells]]:
        if not len(cells):
            return []
        homes, of = np.unique(cells // TILE, axis=0, return_inverse=True)
        parts = []
        for number, (i, j) in enumerate(homes.tolist()):
            columns, rows = (cells[of.ravel() == number] % TILE).T
            parts.append((self._tiles[i, j], rows, columns))
        return parts


def _together(tiles: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the tiles that one grid can hold: clusters of them, the largest first."""
    if _size(tiles) <= MOST:
        return tiles
    kept: list[tuple[int, int]] = []
    for cluster in sorted(_clusters(tiles), key=len, reverse=True):
        if _size(kept + cluster) <= MOST:
            kept += cluster
    return sorted(kept or tiles[:1])


def _size(tiles: list[tuple[int, int]]) -> int:
    """Return how many cells the rectangle around some tiles has."""
    columns, rows = np.ptp(np.array(tiles), axis=0) + 1
    return int(columns) * int(rows) * TILE * TILE


def _clusters(tiles: list[tuple[int, int]]) -> list[list[tuple[int, int]]]:
    """Return tiles in groups that hang together, side by side or corner to corner."""
    left, found = set(tiles), []
    while left:
        waiting, cluster = [left.pop()], []
        while waiting:
            i, j = waiting.pop()
            cluster.append((i, j))
            near = {(i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1)} & left
            left -= near
            waiting += near
        found.append(cluster)
    return found
