"""Rooms drawn as polygons: which one a position lies in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ring = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Room:
    """A polygon with a class.

    Parameters
    ----------
    label : str
        The class.
    rings : tuple of ndarray of float64, shape (n, 2)
        Corners, m: of the outer boundary, and of holes.
    """

    label: str
    rings: tuple[Ring, ...]

    def holds(self, x: float, y: float) -> bool:
        """Tell whether a point, m, lies inside, by the even-odd rule."""
        return sum(_crossings(ring, x, y) for ring in self.rings) % 2 == 1

    def area(self) -> float:
        """Return the area within the outer boundary, m²."""
        x, y = self.rings[0].T
        return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def _crossings(ring: Ring, x: float, y: float) -> int:
    """Count the sides that a ray from a point along x crosses."""
    (x0, y0), (x1, y1) = ring.T, np.roll(ring, -1, axis=0).T
    spans = (y0 > y) != (y1 > y)
    along = x0[spans] + (y - y0[spans]) / (y1[spans] - y0[spans]) * (x1[spans] - x0[spans])
    return int(np.count_nonzero(along > x))


class Rooms:
    """Rooms of one plan.

    Parameters
    ----------
    rooms : sequence of Room
        Where they overlap, the smaller one counts: a niche within a room, a doorway over a wall.
    """

    def __init__(self, rooms: Sequence[Room]) -> None:
        self.rooms = tuple(rooms)
        self._by_size = sorted(self.rooms, key=Room.area)

    @property
    def classes(self) -> tuple[str, ...]:
        """The classes, in order of name."""
        return tuple(sorted({room.label for room in self.rooms}))

    def at(self, x: float, y: float) -> str | None:
        """Return the class of the room that a position, m, lies in, or None."""
        return next((room.label for room in self._by_size if room.holds(x, y)), None)
