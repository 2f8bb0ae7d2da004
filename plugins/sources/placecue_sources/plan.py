"""A labelled floor plan: where a robot can be, and what the place is called there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue_sources.raycast import OccupancyGrid

WALL = -1


@dataclass(frozen=True, slots=True)
class Plan:
    """One floor, closed all around.

    Parameters
    ----------
    name : str
        What to call it.
    grid : OccupancyGrid
        What stops a laser beam.
    labels : ndarray of int16, shape (rows, cols)
        Index into ``classes``, or -1 in occupied cells. Rows grow with y, as in the grid.
    classes : tuple of str
        Names of the classes; some may have no cell.
    """

    name: str
    grid: OccupancyGrid
    labels: NDArray[np.int16]
    classes: tuple[str, ...]

    @classmethod
    def of(
        cls,
        name: str,
        labels: NDArray[np.int16],
        classes: Sequence[str],
        resolution: float,
        origin: tuple[float, float] = (0.0, 0.0),
    ) -> Plan:
        """Make a plan of labelled cells; a wall of one cell is put around them.

        Parameters
        ----------
        name : str
            What to call it.
        labels : ndarray of int16, shape (rows, cols)
            Index into ``classes``, or -1 for walls and the unknown; rows grow with y.
        classes : sequence of str
            Names of the classes.
        resolution : float
            Side of a cell, m.
        origin : tuple of float
            Position x, y of the lower left corner of cell [0, 0], m.
        """
        closed = np.pad(labels, 1, constant_values=WALL)
        corner = (origin[0] - resolution, origin[1] - resolution)
        grid = OccupancyGrid((closed == WALL).astype(np.uint8), resolution, corner)
        return cls(name, grid, closed, tuple(classes))

    def clearance(self) -> NDArray[np.float64]:
        """Return how far each cell's centre is from the nearest wall, m, shape (rows, cols)."""
        free = (self.labels != WALL).astype(np.uint8)
        cells = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        metres = (cells.astype(np.float64) - 0.5) * self.grid.resolution
        return np.asarray(np.maximum(metres, 0.0))

    def label_at(self, x: float, y: float) -> str | None:
        """Return the class at a position in m, None in a wall or outside."""
        row, column = (int(index) for index in self.grid.cells(x, y))
        rows, columns = self.labels.shape
        inside = 0 <= row < rows and 0 <= column < columns
        index = int(self.labels[row, column]) if inside else WALL
        return None if index == WALL else self.classes[index]
