"""GeoJSON files: their features, with the points of the shapes as arrays, in metres."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, described, told
from placecue.nesting import check_depth

#: Points of a line or of the outline of a polygon, shape (n, 2), m.
Line = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Feature:
    """A shape with properties.

    Parameters
    ----------
    where : str
        Which one it is of which file, for messages.
    properties : mapping
        What is said of it.
    shape : str
        The type of its geometry, such as ``Polygon``; empty where it has none.
    coordinates : object
        As they are in the file.
    """

    where: str
    properties: Mapping[str, Any]
    shape: str
    coordinates: Any

    def polygons(self) -> list[tuple[Line, ...]]:
        """Return the polygons of a Polygon or MultiPolygon: each an outline, and holes in it.

        Empty ones are none.

        Outlines end where they began, as in the file. Other shapes give none.

        Raises
        ------
        DataError
            If one is of fewer than three points, or not of numbers.
        """
        many = [rings for rings in self._parts("Polygon") if rings != []]
        return [tuple(self._line(ring, 3) for ring in self._several(rings)) for rings in many]

    def lines(self) -> list[Line]:
        """Return the lines of a LineString or MultiLineString; other shapes give none.

        Raises
        ------
        DataError
            If one is of fewer than two points, or not of numbers.
        """
        return [self._line(points, 2) for points in self._parts("LineString") if points != []]

    def points(self) -> list[Line]:
        """Return the points of a Point or MultiPoint, each of shape (1, 2); others give none.

        Raises
        ------
        DataError
            If one is not of numbers.
        """
        return [self._line([point], 1) for point in self._parts("Point") if point != []]

    def _parts(self, shape: str) -> Sequence[Any]:
        if self.shape == shape:
            return [self.coordinates]
        # Empty coordinates are legal, and no shape (RFC 7946, section 3.1).
        return self.coordinates if self.shape == f"Multi{shape}" else []

    def _several(self, items: Any) -> Sequence[Any]:
        if not isinstance(items, list) or not items:
            raise DataError(f"{self.where} is malformed: a {self.shape} without coordinates")
        return items

    def _line(self, points: Any, least: int) -> Line:
        """Return points as an array; what follows x and y is left out."""
        try:
            line = np.array([[float(x) for x in point[:2]] for point in points], np.float64)
        except (TypeError, ValueError, OverflowError) as error:
            raise DataError(f"{self.where} is malformed: {told(error)}") from error
        if len(line) < least or line.shape[1:] != (2,) or not np.isfinite(line).all():
            number = {1: "one point", 2: "two points", 3: "three points"}[least]
            raise DataError(
                f"{self.where} is malformed: a {self.shape} of fewer than {number}, or not of "
                "finite numbers"
            )
        return line


@dataclass(frozen=True, slots=True)
class FeatureCollection:
    """What a GeoJSON file holds.

    Parameters
    ----------
    features : tuple of Feature
        In the order of the file.
    members : mapping
        What else stands beside the features, such as a name.
    """

    features: tuple[Feature, ...]
    members: Mapping[str, Any]


def read_geojson(path: str | Path, what: str = "the file") -> FeatureCollection:
    """Read a FeatureCollection whose coordinates are metres.

    Parameters
    ----------
    path : str or Path
        The file.
    what : str
        What it is to the one who reads it, for messages.

    Raises
    ------
    DataError
        If the file cannot be read, is not a FeatureCollection, or a shape has no coordinates.
    """
    try:
        text = Path(path).read_text("utf-8-sig")
        check_depth(text, f"{what} {path}")
        members = _mapping(json.loads(text), "it")
        found = members.pop("features")
        features = [_feature(each, n, path) for n, each in enumerate(found)]
    except OSError as error:
        raise DataError(f"cannot read {what} {path}: {error.strerror}") from error
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise DataError(
            f"{what} {path} is not a GeoJSON FeatureCollection ({told(error)})"
        ) from error
    return FeatureCollection(tuple(features), members)


def _feature(given: Any, number: int, path: str | Path) -> Feature:
    name = f"feature {number}"
    feature = _mapping(given, name)
    properties = _mapping(feature.get("properties") or {}, f"'properties' of {name}")
    geometry = _mapping(feature.get("geometry") or {}, f"'geometry' of {name}")
    shape, coordinates = str(geometry.get("type", "")), geometry.get("coordinates")
    if shape not in ("", "GeometryCollection") and not isinstance(coordinates, list):
        raise DataError(f"{name} of {path} is malformed: a {shape} without coordinates")
    return Feature(f"{name} of {path}", properties, shape, coordinates)


def _mapping(given: Any, what: str) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise TypeError(f"{what} is {described(given)}")
    return given
