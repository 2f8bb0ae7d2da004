"""Room polygons in a GeoJSON file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from placecue.errors import DataError
from placecue.labels.rooms import Ring, Room, Rooms

#: Properties that name the class of a polygon; the first that it has is taken.
PROPERTIES = ("class", "label")


def read_rooms(path: str | Path, properties: Sequence[str] = PROPERTIES) -> Rooms:
    """Read the rooms of a FeatureCollection.

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
    try:
        features = json.loads(Path(path).read_text("utf-8"))["features"]
        rooms = [room for feature in features for room in _rooms(feature, properties)]
    except OSError as error:
        raise DataError(f"cannot read the rooms {path}: {error.strerror}") from error
    except (AttributeError, KeyError, IndexError, TypeError, ValueError) as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise DataError(f"{path} is not a GeoJSON FeatureCollection ({reason})") from error
    if not rooms:
        raise DataError(
            f"{path} has no polygon with the property {' or '.join(properties)}: nothing to label "
            "positions with"
        )
    return Rooms(rooms)


def _rooms(feature: Mapping[str, Any], properties: Sequence[str]) -> Iterator[Room]:
    given = feature.get("properties") or {}
    label = next((str(given[key]) for key in properties if given.get(key) is not None), "")
    geometry = feature.get("geometry") or {"type": ""}
    if geometry["type"] not in ("Polygon", "MultiPolygon") or not label.strip():
        return
    coordinates = geometry["coordinates"]
    for polygon in [coordinates] if geometry["type"] == "Polygon" else coordinates:
        yield Room(label.strip(), tuple(_ring(points) for points in polygon))


def _ring(points: Sequence[Sequence[float]]) -> Ring:
    """Return corners, shape (n, 2); a third coordinate is left out."""
    ring = np.asarray([point[:2] for point in points], dtype=np.float64)
    if ring.ndim != 2 or len(ring) < 3 or not np.isfinite(ring).all():
        raise ValueError("a polygon of fewer than three points, or not of numbers")
    return ring
