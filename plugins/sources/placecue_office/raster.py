"""Footprints drawn into a grid of cells."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue_office.plan import Plan, Points

#: Binary digits behind the point that OpenCV takes in polygon corners.
_FRACTION = 8


@dataclass(frozen=True, slots=True)
class Raster:
    """Square cells over a plan.

    Parameters
    ----------
    origin : ndarray, shape (2,)
        Lower left corner of the first cell, m.
    cell : float
        Width of a cell, m.
    shape : (int, int)
        Rows (along y) and columns (along x).
    """

    origin: Points
    cell: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, plan: Plan, cell: float, margin: float = 0.5) -> Raster:
        """Return cells that cover the rooms of a plan and ``margin`` metres around."""
        x0, y0, x1, y1 = plan.bounds()
        columns = int(np.ceil((x1 - x0 + 2 * margin) / cell))
        rows = int(np.ceil((y1 - y0 + 2 * margin) / cell))
        return cls(np.array([x0 - margin, y0 - margin]), cell, (rows, columns))

    def centres(self) -> Points:
        """Return the middle of every cell, row by row, m, shape (rows * columns, 2)."""
        rows, columns = np.indices(self.shape).reshape(2, -1)
        return self.origin + self.cell * (np.column_stack([columns, rows]) + 0.5)

    def cells_of(self, points: Points) -> NDArray[np.int64]:
        """Return row and column of the cell that holds each point (n, 2), clipped, shape (n, 2)."""
        columns_rows = np.floor((points - self.origin) / self.cell).astype(np.int64)
        return np.clip(columns_rows[:, ::-1], 0, np.array(self.shape) - 1)

    def fill(self, outlines: Iterable[Points]) -> NDArray[np.bool_]:
        """Return the cells whose middle lies in one of the polygons, or nearly so."""
        canvas = np.zeros(self.shape, dtype=np.uint8)
        for outline in outlines:
            corners = ((outline - self.origin) / self.cell - 0.5) * 2**_FRACTION
            cv2.fillPoly(canvas, [np.rint(corners).astype(np.int32)], 1, shift=_FRACTION)
        return canvas.astype(bool)
