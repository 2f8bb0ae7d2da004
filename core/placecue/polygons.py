"""Polygons of cells: tracing the outline of a mask, and telling whether a point lies inside."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

#: Corners; the last is not the first again. Outlines go counter-clockwise, holes clockwise.
Ring = tuple[tuple[float, float], ...]
#: An outline, and holes in it.
Polygon = tuple[Ring, ...]
Corner = tuple[int, int]


def crossings(ring: NDArray[np.float64], x: float, y: float) -> int:
    """Count the sides that a ray from a point along x crosses; ``ring`` has shape (n, 2)."""
    (x0, y0), (x1, y1) = ring.T, np.roll(ring, -1, axis=0).T
    spans = (y0 > y) != (y1 > y)
    along = x0[spans] + (y - y0[spans]) / (y1[spans] - y0[spans]) * (x1[spans] - x0[spans])
    return int(np.count_nonzero(along > x))


def holds(polygons: Iterable[Polygon], x: float, y: float) -> bool:
    """Tell whether a point lies in one of some polygons, by the even-odd rule."""
    rings = (np.array(ring) for polygon in polygons for ring in polygon)
    return sum(crossings(ring, x, y) for ring in rings) % 2 == 1


def area_of(ring: Sequence[tuple[float, float]]) -> float:
    """Return the area within a ring, positive where it goes counter-clockwise."""
    x, y = np.array(ring, dtype=np.float64).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def outlines(mask: NDArray[np.bool_]) -> list[list[list[Corner]]]:
    """Trace the polygons of a mask along the sides of its cells.

    Parameters
    ----------
    mask : ndarray of bool, shape (rows, columns)
        Cell (i, j) covers x from j to j + 1 and y from i to i + 1. Cells that only touch at a
        corner are apart.

    Returns
    -------
    list of list of rings
        Polygons in order of size, each an outline and holes, of corners (x, y).
    """
    from scipy.ndimage import label  # here: not every command comes to it

    rings = _rings(_sides(mask))
    sizes = [area_of(ring) for ring in rings]
    outer = sorted((-size, row) for row, size in enumerate(sizes) if size > 0)
    parts, _ = label(mask)
    polygons = {parts[_beside(rings[row])]: [rings[row]] for _, row in outer}
    for ring, size in zip(rings, sizes, strict=True):
        if size < 0:
            polygons[parts[_beside(ring)]].append(ring)
    return list(polygons.values())


def _beside(ring: Sequence[Corner]) -> tuple[int, int]:
    """Return the row and column of a cell to the left of a ring: of the polygon that it bounds."""
    (x0, y0), (x1, y1) = ring[0], ring[1]
    right, up = x1 > x0, y1 > y0
    if y0 == y1:
        return (y0, x0) if right else (y0 - 1, x0 - 1)
    return (y0, x0 - 1) if up else (y0 - 1, x0)


def _sides(mask: NDArray[np.bool_]) -> dict[Corner, list[Corner]]:
    """Return the sides between cells inside and outside, the inside to their left."""
    inside = np.pad(mask, 1)
    sides: dict[Corner, list[Corner]] = defaultdict(list)
    rows, columns = np.nonzero(inside[1:] != inside[:-1])
    for i, j in zip(rows.tolist(), columns.tolist(), strict=True):
        left, right = (j - 1, i), (j, i)
        a, b = (left, right) if inside[i + 1, j] else (right, left)
        sides[a].append(b)
    rows, columns = np.nonzero(inside[:, 1:] != inside[:, :-1])
    for i, j in zip(rows.tolist(), columns.tolist(), strict=True):
        low, high = (j, i - 1), (j, i)
        a, b = (low, high) if inside[i, j] else (high, low)
        sides[a].append(b)
    return sides


def _rings(sides: dict[Corner, list[Corner]]) -> list[list[Corner]]:
    rings = []
    for start in sorted(sides):
        while start in sides:
            ring, at, before = [start], _next(sides, start, None), start
            while at != start:
                ring.append(at)
                at, before = _next(sides, at, before), at
            rings.append(_straightened(ring))
    return rings


def _next(sides: dict[Corner, list[Corner]], at: Corner, before: Corner | None) -> Corner:
    """Take the next side from a corner; where two begin, the one to the left."""
    ways = sides[at]
    if len(ways) > 1 and before is not None:
        dx, dy = at[0] - before[0], at[1] - before[1]
        ways.sort(key=lambda to: dx * (to[1] - at[1]) - dy * (to[0] - at[0]))
    taken = ways.pop()
    if not ways:
        del sides[at]
    return taken


def _straightened(ring: Sequence[Corner]) -> list[Corner]:
    """Leave out corners on a straight line."""
    corners = []
    for (x0, y0), (x1, y1), (x2, y2) in zip(
        [ring[-1], *ring[:-1]], ring, [*ring[1:], ring[0]], strict=True
    ):
        if (x1 - x0) * (y2 - y1) != (y1 - y0) * (x2 - x1):
            corners.append((x1, y1))
    return corners
