"""The end points of a scan, thinned so that near walls do not outweigh far ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue.observation import LaserScan

#: One end point a cell of so many metres is kept.
CELL = 0.05
#: What lies farther is not used: a small error of the heading moves it too far.
LONGEST = 25.0
#: What lies nearer may be the robot itself.
SHORTEST = 0.1

Points = NDArray[np.float64]


def cloud_of(scan: LaserScan, cell: float = CELL) -> Points:
    """Return the end points of a scan in the robot's frame, thinned, m, shape (k, 2)."""
    points = scan.points()
    away = np.hypot(points[:, 0] - scan.mount.x, points[:, 1] - scan.mount.y)
    return thinned(points[(away <= LONGEST) & (away >= SHORTEST)], cell)


def thinned(points: Points, cell: float) -> Points:
    """Return the first point in each cell of a grid, in the order in which they come.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        m.
    cell : float
        Side of a cell, m.
    """
    cells = np.floor(points / cell).astype(np.int64)
    keys = cells[:, 0] * (1 << 32) + cells[:, 1]
    _, first = np.unique(keys, return_index=True)
    return np.asarray(points[np.sort(first)])
