"""A floor plan as data: rooms, walls, doors, windows, furniture and lamps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Points: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Room:
    """A labelled part of the floor.

    Parameters
    ----------
    label : str
        The class of place.
    outline : ndarray, shape (k, 2)
        Corners, m. Rooms meet in the middle of the doors between them.
    floor, wall, ceiling : str
        Materials.
    """

    label: str
    outline: Points
    floor: str
    wall: str
    ceiling: str


@dataclass(frozen=True, slots=True)
class Wall:
    """A straight wall, or the door in one.

    Parameters
    ----------
    line : ndarray, shape (2, 2)
        Ends of the centre line, m.
    thickness : float
        Thickness, m.
    bottom, top : float
        Height range, m.
    material : str or None
        None takes the wall material of the room that each side faces.
    """

    line: Points
    thickness: float
    bottom: float
    top: float
    material: str | None = None


@dataclass(frozen=True, slots=True)
class Panel:
    """A flat rectangle in front of a wall: a window, a poster, a notice board.

    Parameters
    ----------
    line : ndarray, shape (2, 2)
        Its edge in the plan, m.
    bottom, top : float
        Height range, m.
    material : str
        What is on it.
    window : bool
        Whether daylight comes through.
    key : int
        Decides how its picture is drawn.
    """

    line: Points
    bottom: float
    top: float
    material: str
    window: bool = False
    key: int = 0


@dataclass(frozen=True, slots=True)
class Furniture:
    """A thing that stands in a room.

    Parameters
    ----------
    type : str
        One of ``box``, ``table``, ``chair``, ``plant``.
    outline : ndarray, shape (k, 2)
        Footprint, m.
    bottom, top : float
        Height range, m.
    material, cover, ends : str
        Materials of the long sides, of the top and of the short sides.
    moves : float
        How far it may stand from its place in another run, m; 0 stays.
    key : int
        Decides how its pictures are drawn.
    """

    type: str
    outline: Points
    bottom: float
    top: float
    material: str
    cover: str
    ends: str
    moves: float = 0.0
    key: int = 0


@dataclass(frozen=True, slots=True)
class Plan:
    """One floor of a building, in metres.

    Parameters
    ----------
    name : str
        Name of the world.
    height : float
        Height of the ceiling, m.
    rooms, walls, panels, furniture : tuple
        What it is made of; doors are among the walls.
    lamps : ndarray, shape (k, 4)
        Centre x and y, length and width of each lamp on the ceiling, m.
    tour : ndarray, shape (k, 2)
        The places that a drive goes through, in order, m.
    """

    name: str
    height: float
    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    panels: tuple[Panel, ...]
    furniture: tuple[Furniture, ...]
    lamps: Points
    tour: Points

    def room_at(self, points: Points) -> NDArray[np.int64]:
        """Return the index of the room that holds each point, -1 outside, shape (n,)."""
        found = np.full(len(points), -1)
        for index, room in reversed(list(enumerate(self.rooms))):
            found[inside(room.outline, points)] = index
        return found

    def bounds(self) -> tuple[float, float, float, float]:
        """Return the smallest and largest x and y of the rooms: x0, y0, x1, y1 in m."""
        corners = np.vstack([room.outline for room in self.rooms])
        (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
        return float(x0), float(y0), float(x1), float(y1)


def inside(outline: Points, points: Points) -> NDArray[np.bool_]:
    """Tell which points (n, 2) lie in the polygon (k, 2), by the even-odd rule."""
    x, y = points[:, 0], points[:, 1]
    odd = np.zeros(len(points), dtype=bool)
    for (xa, ya), (xb, yb) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if ya != yb:
            odd ^= ((ya <= y) != (yb <= y)) & (x < xa + (y - ya) / (yb - ya) * (xb - xa))
    return odd


def turned(points: Points, angle: float) -> Points:
    """Return points (n, 2) turned about the origin by an angle in rad."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))
