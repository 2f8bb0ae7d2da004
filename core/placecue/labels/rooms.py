"""Rooms drawn as polygons: which one a position lies in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.labels.geojson import Feature, read_geojson
from placecue.polygons import crossings

Ring = NDArray[np.float64]

#: Properties that name the class of a polygon; the first that it has is taken.
PROPERTIES = ("class", "label")


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
        return sum(crossings(ring, x, y) for ring in self.rings) % 2 == 1

    def area(self) -> float:
        """Return the area within the outer boundary, m²."""
        x, y = self.rings[0].T
        return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


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


def read_rooms(path: str | Path, properties: Sequence[str] = PROPERTIES) -> Rooms:
    """Read the rooms of a GeoJSON FeatureCollection.

    Each Polygon or MultiPolygon with a class is a room; other features are left out.

    Parameters
    ----------
    path : str or Path
        The file; coordinates are x, y in m, in the frame of the poses.
    properties : sequence of str
        Names of the property with the class.

    Raises
    ------
    DataError
        If the file cannot be read, is not GeoJSON, or has no polygon with a class.
    """
    features = read_geojson(path, "the rooms").features
    rooms = [
        Room(label, polygon)
        for feature in features
        if (label := _class(feature, properties))
        for polygon in feature.polygons()
    ]
    if not rooms:
        raise DataError(
            f"{path} has no polygon with the property {' or '.join(properties)}: nothing to label "
            "positions with"
        )
    return Rooms(rooms)


def _class(feature: Feature, properties: Sequence[str]) -> str:
    given = (feature.properties.get(name) for name in properties)
    return next((str(each) for each in given if each is not None), "").strip()
