"""Rectangles along the axes, which floors are cut into."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

#: A side of a rectangle: west, east, south, north.
Side = Literal["W", "E", "S", "N"]


@dataclass(frozen=True, slots=True)
class Rectangle:
    """From (x0, y0) to (x1, y1), m."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Extent along x, m."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """Extent along y, m."""
        return self.y1 - self.y0

    @property
    def area(self) -> float:
        """Area, m²; 0 where nothing is left of it."""
        return max(self.width, 0.0) * max(self.height, 0.0)

    def inset(self, by: float) -> Rectangle:
        """Return what lies at least so far inside, m."""
        return Rectangle(self.x0 + by, self.y0 + by, self.x1 - by, self.y1 - by)

    def within(self, other: Rectangle) -> Rectangle:
        """Return what lies in both."""
        return Rectangle(
            max(self.x0, other.x0),
            max(self.y0, other.y0),
            min(self.x1, other.x1),
            min(self.y1, other.y1),
        )

    def cut(self, along_x: bool, at: float) -> tuple[Rectangle, Rectangle]:
        """Return the two parts left and right of x = at, or below and above y = at."""
        if along_x:
            return (
                Rectangle(self.x0, self.y0, at, self.y1),
                Rectangle(at, self.y0, self.x1, self.y1),
            )
        return Rectangle(self.x0, self.y0, self.x1, at), Rectangle(self.x0, at, self.x1, self.y1)

    def corners(self) -> NDArray[np.float64]:
        """Return the corners, m, shape (4, 2)."""
        return np.array(
            [(self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1)]
        )


@dataclass(frozen=True, slots=True)
class Border:
    """What two rectangles have in common: a line along which they touch.

    Parameters
    ----------
    upright : bool
        Whether it runs along y.
    at : float
        Its x if upright, else its y, m.
    start, end : float
        Where it begins and ends along the other axis, m.
    """

    upright: bool
    at: float
    start: float
    end: float

    @property
    def length(self) -> float:
        """Length, m."""
        return self.end - self.start

    def across(self, start: float, end: float, before: float, behind: float) -> Rectangle:
        """Return a rectangle from start to end along it, reaching before and behind it, m."""
        if self.upright:
            return Rectangle(self.at - before, start, self.at + behind, end)
        return Rectangle(start, self.at - before, end, self.at + behind)


def border(first: Rectangle, second: Rectangle) -> Border | None:
    """Return where two rectangles touch, ``second`` on the east or north; None if nowhere."""
    if abs(first.x1 - second.x0) < 1e-6:
        start, end = max(first.y0, second.y0), min(first.y1, second.y1)
        return Border(True, first.x1, start, end) if end > start else None
    if abs(first.y1 - second.y0) < 1e-6:
        start, end = max(first.x0, second.x0), min(first.x1, second.x1)
        return Border(False, first.y1, start, end) if end > start else None
    return None
