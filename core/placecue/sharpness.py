"""How straight walls come out: whether what is seen again lies where it was."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import Observation, Pose2D

#: Side of a cell, m, and of a tile, cells.
CELL, TILE = 0.1, 64
#: Scans are looked at after so much way, m; their end points up to this range, m.
EVERY, LONGEST = 0.5, 10.0
#: What was seen so much way before, m, counts as seen before.
BEFORE = 10.0
#: An end point sees a wall again where something seen before lies within the second distance, and
#: where it was if within the first, m.
SAME, AGAIN = 0.15, 0.6
#: With fewer end points seen again there is no telling.
FEWEST = 2000
#: Walls whose share is less than this are smeared.
SMEARED = 0.75


@dataclass(frozen=True, slots=True)
class Seen:
    """End points of walls that were seen before.

    Parameters
    ----------
    again : int
        How many lie near something seen before.
    same : int
        How many of them lie on it.
    """

    again: int
    same: int

    @property
    def share(self) -> float | None:
        """The share of walls seen again that lie where they were; None with too few to tell."""
        return self.same / self.again if self.again >= FEWEST else None


class Sharpness:
    """Measures a map as it grows; a listener.

    Of each scan's end points, those are *seen again* that lie within :data:`AGAIN` of a cell in
    which something was seen first, ``before`` of way earlier. The measure is the share of them
    that lie within :data:`SAME` of such a cell. Walls of right poses have nearly all; a wall drawn
    twice, 0.2 m or more apart, has none. People, chairs and what was hidden cost a little
    everywhere. Memory grows with the space seen, 4 bytes a cell.

    Parameters
    ----------
    before : float
        What was seen so much way before, m, counts as seen before.
    """

    def __init__(self, before: float = BEFORE) -> None:
        self.before = before
        self._first: dict[tuple[int, int], NDArray[np.float32]] = {}  # way when first seen, m
        self._last: Pose2D | None = None
        self._frame = ""
        self._way = 0.0
        self._looked = -EVERY
        self._again = self._same = 0

    def observe(
        self,
        observation: Observation,
        belief: Belief | None = None,
        update: AreaUpdate | None = None,
    ) -> None:
        """Take in the scan and the pose of one observation."""
        pose, scan = observation.pose, observation.scan
        if pose is None or not all(map(isfinite, (pose.x, pose.y, pose.theta))):
            return
        self._frame = self._frame or pose.frame
        if pose.frame != self._frame:
            return
        last, self._last = self._last, pose
        self._way += 0.0 if last is None else hypot(pose.x - last.x, pose.y - last.y)
        if scan is None or self._way - self._looked < EVERY:
            return
        self._looked = self._way
        points = scan.points()
        near = points[np.hypot(points[:, 0], points[:, 1]) <= LONGEST]
        if len(near):
            self._look(_cells(near, pose))

    @property
    def seen(self) -> Seen:
        """What was seen again so far."""
        return Seen(self._again, self._same)

    def _look(self, cells: NDArray[np.int64]) -> None:
        low = cells.min(axis=0) // TILE - 1
        high = cells.max(axis=0) // TILE + 2
        first = np.full((high - low) * TILE, np.inf, np.float32)
        for i in range(low[0], high[0]):
            for j in range(low[1], high[1]):
                if (i, j) in self._first:
                    at = (i - low[0]) * TILE, (j - low[1]) * TILE
                    first[at[0] : at[0] + TILE, at[1] : at[1] + TILE] = self._first[i, j]
        fresh = (first > self._way - self.before).astype(np.uint8)
        if not fresh.all():
            away = cv2.distanceTransform(fresh, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * CELL
            found = away[tuple((cells - low * TILE).T)]
            self._again += int((found <= AGAIN).sum())
            self._same += int((found <= SAME).sum())
        self._keep(cells)

    def _keep(self, cells: NDArray[np.int64]) -> None:
        for i, j in np.unique(cells // TILE, axis=0).tolist():
            tile = self._first.setdefault((i, j), np.full((TILE, TILE), np.inf, np.float32))
            rows, columns = (cells[(cells // TILE == [i, j]).all(axis=1)] % TILE).T
            tile[rows, columns] = np.minimum(tile[rows, columns], self._way)


def _cells(points: NDArray[np.float64], pose: Pose2D) -> NDArray[np.int64]:
    c, s = np.cos(pose.theta), np.sin(pose.theta)
    placed = points @ np.array([[c, s], [-s, c]]) + [pose.x, pose.y]
    return np.unique(np.floor(placed / CELL).astype(np.int64), axis=0)
