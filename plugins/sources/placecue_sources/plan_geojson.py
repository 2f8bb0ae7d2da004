"""Floor plans as GeoJSON: labelled polygons, and lines that are walls, in metres."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue import Feature, read_geojson
from placecue.errors import DataError
from placecue_sources.plan import WALL, Plan

MOST_CELLS = 50_000_000
SHIFT = 8

Rings = list[NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Shape:
    """Polygons of one class, or lines that are walls.

    Parameters
    ----------
    rings : list of ndarray of float64, shape (n, 2)
        Points, m: the outer boundary of a polygon and its holes, or one line.
    label : str or None
        Class of a polygon; None for a wall.
    """

    rings: Rings
    label: str | None


def read_floor(path: Path, class_property: str, resolution: float, wall_thickness: float) -> Plan:
    """Read a plan from a FeatureCollection.

    A Polygon or MultiPolygon is free space of the class that its property names; holes in it are
    not. What no polygon covers is wall, so rooms whose polygons do not touch are joined by a
    polygon (a doorway, say) that reaches over the gap. Where polygons overlap the later one in
    the file gives the class. A LineString or MultiLineString with the property ``wall`` true is
    drawn as a wall over the polygons.

    Parameters
    ----------
    path : Path
        The file; coordinates are x, y in m.
    class_property : str
        Property that names the class of a polygon.
    resolution : float
        Side of the cells that the shapes are drawn into, m.
    wall_thickness : float
        Thickness of lines that are walls, m.

    Raises
    ------
    DataError
        If the file is not GeoJSON, has no labelled polygon, or is too large to be in metres.
    """
    features = read_geojson(path, "the plan").features
    shapes = [shape for feature in features for shape in _shapes(feature, class_property)]
    rooms = [shape for shape in shapes if shape.label is not None]
    if not rooms:
        raise DataError(f"{path} has no polygon with the property {class_property!r}")
    classes = sorted({str(shape.label) for shape in rooms})
    origin, size = _extent(path, rooms, resolution)
    labels = np.full(size, WALL, dtype=np.int16)
    for room in rooms:
        labels[_filled(room, origin, size, resolution)] = classes.index(str(room.label))
    thickness = max(1, round(wall_thickness / resolution))
    for wall in (shape for shape in shapes if shape.label is None):
        labels[_drawn(wall, origin, size, resolution, thickness)] = WALL
    return Plan.of(path.stem, labels, classes, resolution, origin)


def _shapes(feature: Feature, class_property: str) -> Iterator[Shape]:
    """Yield the shapes of one feature; what is neither room nor wall gives none."""
    label = feature.properties.get(class_property)
    if label is not None:
        for polygon in feature.polygons():
            yield Shape(list(polygon), str(label))
    if feature.properties.get("wall"):
        for line in feature.lines():
            yield Shape([line], None)


def _extent(
    path: Path, rooms: Sequence[Shape], resolution: float
) -> tuple[tuple[float, float], tuple[int, int]]:
    """Return the lower left corner of the rooms, m, and the number of rows and columns."""
    points = np.concatenate([ring for room in rooms for ring in room.rings])
    low = points.min(axis=0)
    columns, rows = np.ceil((points.max(axis=0) - low) / resolution) + 1
    if rows * columns > MOST_CELLS:
        raise DataError(
            f"{path} covers {columns * resolution:.0f} by {rows * resolution:.0f} m, too much for "
            f"cells of {resolution:g} m; are the coordinates metres?"
        )
    return (float(low[0]), float(low[1])), (int(rows), int(columns))


def _pixels(
    ring: NDArray[np.float64], origin: tuple[float, float], resolution: float
) -> NDArray[np.int32]:
    """Return points in OpenCV's fixed-point pixels, whose centres are whole numbers."""
    cells = (ring - np.array(origin)) / resolution - 0.5
    return np.asarray(np.round(cells * (1 << SHIFT)), dtype=np.int32)


def _filled(
    room: Shape, origin: tuple[float, float], size: tuple[int, int], resolution: float
) -> NDArray[np.bool_]:
    """Return the cells inside a polygon (holes by the even-odd rule), shape ``size``."""
    mask = np.zeros(size, dtype=np.uint8)
    rings = [_pixels(ring, origin, resolution) for ring in room.rings]
    cv2.fillPoly(mask, rings, 1, lineType=cv2.LINE_8, shift=SHIFT)
    return mask.astype(np.bool_)


def _drawn(
    wall: Shape,
    origin: tuple[float, float],
    size: tuple[int, int],
    resolution: float,
    thickness: int,
) -> NDArray[np.bool_]:
    """Return the cells under lines, shape ``size``."""
    mask = np.zeros(size, dtype=np.uint8)
    lines = [_pixels(line, origin, resolution) for line in wall.rings]
    cv2.polylines(mask, lines, False, 1, thickness, cv2.LINE_8, SHIFT)
    return mask.astype(np.bool_)
