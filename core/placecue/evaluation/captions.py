"""Where the captions of a map's areas fit: each inside its own area, so that none meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from placecue.polygons import Polygon
from placecue.semantic_map import UNKNOWN, Area

#: Cells along the longer side of the picture that captions are fitted in.
CELLS = 800
NOBODY = -1

#: Width and height of a text of a size in points, m.
Measure = Callable[[str, float], tuple[float, float]]
#: Left, lower, right and upper side, m.
Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Caption:
    """A text in a picture of a map.

    Parameters
    ----------
    area : int
        The id of its area.
    text : str
        What it says; of one line or two.
    size : float
        Of the letters, points.
    x, y : float
        Its middle, m.
    upright : bool
        Whether it is turned by a quarter, from below upwards.
    """

    area: int
    text: str
    size: float
    x: float
    y: float
    upright: bool = False


def captions(areas: Sequence[Area], extent: NDArray[np.float64], measure: Measure) -> list[Caption]:
    """Find for each area the longest and largest text that lies wholly inside its surface.

    Parameters
    ----------
    areas : sequence of Area
        One whose surface is too small for its number gets no caption; one without a surface gets
        it on its way, where there is room.
    extent : ndarray of float64, shape (2, 2)
        Lower left and upper right corner of the picture, m.
    measure : callable
        Tells how large a text is.

    Notes
    -----
    Holes of an area, such as tables, may be written over unless another area lies in them.
    """
    cell = float((extent[1] - extent[0]).max()) / CELLS
    owners = _owners(areas, extent, cell)
    found = []
    for row, area in enumerate(areas):
        if area.surface and (own := _Cells.of(owners == row)) is not None:
            caption = _fitted(area, own, extent[0], cell, measure)
            found += [caption] if caption is not None else []
    for area in areas:
        if not area.surface and area.trajectory:
            caption = _on_way(area, [_box(each, measure) for each in found], measure)
            found += [caption] if caption is not None else []
    return found


def words(area: Area) -> list[tuple[str, float, bool]]:
    """Return the texts that may stand for an area, their size (points) and whether upright."""
    name = f"{area.label} {area.id}"
    sure = "" if area.label == UNKNOWN else f"{100 * area.confidence:.0f} %"
    both = [f"{name}\n{sure}", f"{name}  {sure}"] if sure else [name]
    full = [(text, size, turned) for size in (12.0, 10.0, 8.5)
            for turned in (False, True) for text in both]  # fmt: skip
    short = [(name, size, turned) for size in (10.0, 8.5, 7.0) for turned in (False, True)]
    return [*full, *short, (str(area.id), 8.5, False), (str(area.id), 6.0, False)]


def _fitted(
    area: Area, own: _Cells, corner: NDArray[np.float64], cell: float, measure: Measure
) -> Caption | None:
    for text, size, upright in words(area):
        width, height = measure(text, size)[:: -1 if upright else 1]
        at = own.room_for(round(width / cell + 2), round(height / cell + 2))
        if at is not None:
            x, y = corner + at * cell
            return Caption(area.id, text, size, float(x), float(y), upright)
    return None


def _on_way(area: Area, taken: Sequence[Box], measure: Measure) -> Caption | None:
    way = np.array(area.trajectory)
    nearest = ((way - way.mean(axis=0)) ** 2).sum(axis=1).argsort(kind="stable")
    for text, size, upright in words(area):
        for x, y in way[nearest].tolist():
            caption = Caption(area.id, text, size, x, y, upright)
            if not any(_meet(_box(caption, measure), other) for other in taken):
                return caption
    return None


def _box(caption: Caption, measure: Measure) -> Box:
    width, height = measure(caption.text, caption.size)[:: -1 if caption.upright else 1]
    x, y = caption.x, caption.y
    return x - width / 2, y - height / 2, x + width / 2, y + height / 2


def _meet(one: Box, other: Box) -> bool:
    return bool(one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3])


@dataclass(frozen=True)
class _Cells:
    """The cells of one area, in the rectangle around them.

    Parameters
    ----------
    sums : ndarray of int64, shape (rows + 1, columns + 1)
        How many of them lie below and to the left of each corner.
    first : (int, int)
        Column and row of the rectangle.
    middle : ndarray of float64, shape (2,)
        Mean column and row, within the rectangle.
    """

    sums: NDArray[np.int64]
    first: tuple[int, int]
    middle: NDArray[np.float64]

    @classmethod
    def of(cls, mask: NDArray[np.bool_]) -> _Cells | None:
        rows, columns = np.nonzero(mask)
        if not len(rows):
            return None
        part = mask[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
        sums = np.pad(part.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        first = int(columns.min()), int(rows.min())
        return cls(sums, first, np.array([columns.mean(), rows.mean()]) - first + 0.5)

    def room_for(self, width: int, height: int) -> NDArray[np.float64] | None:
        """Return the middle of a box of so many cells that is all inside, near the middle."""
        sums = self.sums
        if sums.shape[0] <= height or sums.shape[1] <= width:
            return None
        right, left = sums[:, width:], sums[:, :-width]
        held = right[height:] - right[:-height] - left[height:] + left[:-height]
        rows, columns = np.nonzero(held == width * height)
        if not len(rows):
            return None
        middles = np.column_stack([columns + width / 2, rows + height / 2])
        best = int(((middles - self.middle) ** 2).sum(axis=1).argmin())
        return np.asarray(middles[best] + self.first)


def _owners(areas: Sequence[Area], extent: NDArray[np.float64], cell: float) -> NDArray[np.int32]:
    """Return the row of the area in each cell: what it holds, holes included that are nobody's."""
    columns, rows = np.ceil((extent[1] - extent[0]) / cell).astype(int)
    owners = np.full((rows, columns), NOBODY, np.int32)
    by_size = sorted(range(len(areas)), key=lambda row: -areas[row].size)
    for row in by_size:
        for outline, *_ in areas[row].surface:
            _fill(owners, [(outline,)], row, extent[0], cell)
    for row in by_size:
        _fill(owners, areas[row].surface, row, extent[0], cell)
    return owners


def _fill(
    owners: NDArray[np.int32],
    polygons: Sequence[Polygon],
    row: int,
    corner: NDArray[np.float64],
    cell: float,
) -> None:
    import cv2  # here: not every command comes to it

    rings = [(np.array(ring) - corner) / cell - 0.5 for polygon in polygons for ring in polygon]
    if rings:
        fixed = [np.round(ring * 16).astype(np.int32) for ring in rings]
        cv2.fillPoly(owners, fixed, row, shift=4)
