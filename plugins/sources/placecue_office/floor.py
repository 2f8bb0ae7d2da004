"""Where on the floor there is room for a thing."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue_office.blocks import blocks_of
from placecue_office.plan import Furniture, Plan, Points
from placecue_office.raster import Raster

#: What hangs higher than this leaves room on the floor below, m.
HEADROOM = 0.6


class Floor:
    """Cells of the floor, and what stands on them.

    Parameters
    ----------
    plan : Plan
        The building; its furniture stands on the floor to begin with.
    way : ndarray, shape (n, 2)
        Points that have to stay clear, m.
    clear : float
        Distance from them that nothing is put within, m.
    cell : float
        Width of a cell, m.
    """

    def __init__(self, plan: Plan, way: Points, clear: float, cell: float = 0.05) -> None:
        self.raster = Raster.over(plan, cell)
        self.rooms = plan.room_at(self.raster.centres()).reshape(self.raster.shape)
        walls = [block.outline for block in blocks_of(plan, ()) if block.solid and block.closed]
        self.rooms[self.raster.fill(walls)] = -1
        off_way = np.ones(self.raster.shape, dtype=np.uint8)
        off_way[tuple(self.raster.cells_of(way).T)] = 0
        metres = cell * cv2.distanceTransform(off_way, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        self.way: NDArray[np.bool_] = metres <= clear
        self.taken = np.zeros(self.raster.shape, dtype=np.int64)
        for item in plan.furniture:
            self.put(item)

    def put(self, item: Furniture, count: int = 1) -> None:
        """Note that a thing stands where it does; ``count`` -1 takes it away."""
        if item.bottom < HEADROOM:
            self.taken += count * self.raster.fill([item.outline])

    def take(self, item: Furniture) -> None:
        """Note that a thing stands there no more."""
        self.put(item, -1)

    def fits(self, outline: Points, room: int | None = None) -> bool:
        """Tell whether a thing of that outline can stand there, wholly in one room."""
        cells = self.raster.fill([outline])
        rooms = self.rooms[cells]
        if rooms.size == 0 or (rooms != (rooms[0] if room is None else room)).any():
            return False
        return bool(rooms[0] >= 0 and not self.taken[cells].any() and not self.way[cells].any())

    def in_the_way(self, outline: Points) -> bool:
        """Tell whether a thing of that outline stands where the way is."""
        return bool(self.way[self.raster.fill([outline])].any())

    def free(self) -> Points:
        """Return the middle of every cell that a thing can be put on, shape (n, 2)."""
        empty = (self.rooms >= 0) & (self.taken == 0) & ~self.way
        return np.asarray(self.raster.centres()[empty.ravel()])


def dense(corners: Points, step: float = 0.05) -> Points:
    """Return points every ``step`` metres along the straight lines between corners (n, 2)."""
    pieces: Iterable[Points] = (
        np.linspace(a, b, max(2, int(np.linalg.norm(b - a) / step) + 2))
        for a, b in pairwise(corners)
    )
    return np.vstack([corners[:1], *pieces])
