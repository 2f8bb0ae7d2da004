"""Reading a plan from GeoJSON, whose coordinates are metres."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from placecue import Feature, read_geojson
from placecue.errors import DataError, UsageError, choices
from placecue_office.plan import Furniture, Panel, Plan, Points, Room, Wall

Properties = Mapping[str, Any]

#: First keys of the panels' and the furniture's pictures; walls and doors take those below.
_PANELS, _FURNITURE = 10_000, 20_000


#: Where the plans are that are shipped.
PLANS = Path(__file__).parent


def find_plan(world: str) -> Path:
    """Return the file of a world: a plan that is shipped, by name, or a path.

    Raises
    ------
    UsageError
        If no plan has that name.
    """
    if world.endswith(".geojson"):
        return Path(world)
    plans = {path.stem: path for path in PLANS.glob("*.geojson")}
    if world not in plans:
        raise UsageError(
            f"no world '{world}': {choices(world, plans)}; a plan of your own is given as the path "
            "of its .geojson file"
        )
    return plans[world]


def read_plan(path: str | Path) -> Plan:
    """Read a plan from a GeoJSON file whose coordinates are metres.

    Raises
    ------
    DataError
        If the file cannot be read, or a feature is not of a known kind or lacks a property.
    """
    collection = read_geojson(path, "the plan")
    try:
        height = float(collection.members.get("height", 2.7))
        return _plan(str(collection.members["name"]), height, collection.features)
    except (ValueError, KeyError, TypeError, IndexError) as error:
        raise DataError(f"{path} is not a plan (GeoJSON in metres): {error!r}") from error


def _plan(name: str, height: float, features: Iterable[Feature]) -> Plan:
    kinds: dict[str, list[Any]] = {kind: [] for kind in _READERS}
    for feature in features:
        kind = str(feature.properties.get("kind"))
        if kind not in kinds:
            raise DataError(f"{feature.where} is a '{kind}': {choices(kind, kinds)}")
        points = _points(feature)
        try:
            kinds[kind].extend(_READERS[kind](points, feature.properties, height))
        except KeyError as error:
            raise DataError(f"{feature.where} ({kind}) lacks {error}") from error
    if not kinds["room"] or not kinds["tour"]:
        raise DataError(f"plan '{name}' needs at least one room and a tour")
    return Plan(
        name=name,
        height=height,
        rooms=tuple(kinds["room"]),
        walls=(*kinds["wall"], *kinds["door"]),
        panels=_keyed([*kinds["panel"], *kinds["window"]], _PANELS),
        furniture=_keyed(kinds["furniture"], _FURNITURE),
        lamps=np.array(kinds["lamp"], dtype=float).reshape(-1, 4),
        tour=np.vstack(kinds["tour"]),
    )


def _keyed(items: list[Any], first: int) -> tuple[Any, ...]:
    return tuple(replace(item, key=first + number) for number, item in enumerate(items))


def _points(feature: Feature) -> Points:
    """Return the corners of a polygon, counter-clockwise, or the points of a line, shape (k, 2)."""
    for outline, *_ in feature.polygons():
        return counter_clockwise(outline[:-1])
    for points in (*feature.lines(), *feature.points()):
        return points
    raise DataError(f"{feature.where} is no Polygon, LineString or Point")


def counter_clockwise(outline: Points) -> Points:
    """Return the polygon's corners in counter-clockwise order, shape (k, 2)."""
    x, y = outline.T
    doubled_area = np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    return outline if doubled_area > 0 else outline[::-1].copy()


def _room(outline: Points, given: Properties, height: float) -> list[Room]:
    return [Room(given["label"], outline, given["floor"], given["wall"], given["ceiling"])]


def _walls(line: Points, given: Properties, height: float) -> list[Wall]:
    top = float(given.get("height", height))
    material = given.get("material")
    return [
        Wall(line[i : i + 2], given["thickness"], 0.0, top, material) for i in range(len(line) - 1)
    ]


def _door(line: Points, given: Properties, height: float) -> list[Wall]:
    """Return the lintel, the two posts and, where the door is closed, its leaf."""
    thickness, top, frame = given["thickness"], given.get("height", 2.05), given["frame"]
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    post = along * given.get("post", 0.03)
    proud = thickness + 0.03  # the frame stands out of the wall by 1.5 cm on either side
    parts = [
        Wall(line, thickness, top + 0.06, height),
        Wall(line, proud, top, top + 0.06, frame),
        Wall(np.array([line[0], line[0] + post]), proud, 0.0, top, frame),
        Wall(np.array([line[1] - post, line[1]]), proud, 0.0, top, frame),
    ]
    if not given["open"]:
        parts.append(Wall(line, 0.06, 0.0, top, given["material"]))
    return parts


def _panel(line: Points, given: Properties, height: float) -> list[Panel]:
    bottom, top = given["z"]
    return [Panel(line, bottom, top, given["material"], given["kind"] == "window")]


def _furniture(points: Points, given: Properties, height: float) -> list[Furniture]:
    outline = (
        points if len(points) > 2 else turned_square(points[0], given["size"], given["heading"])
    )
    bottom, top = given["z"]
    material = given["material"]
    return [
        Furniture(
            given["type"],
            outline,
            bottom,
            top,
            material,
            given.get("cover", material),
            given.get("ends", material),
            given.get("moves", 0.0),
        )
    ]


def turned_square(centre: Points, size: float, heading: float) -> Points:
    """Return a square about ``centre`` whose first edge is its front (heading in rad)."""
    ahead = 0.5 * size * np.array([np.cos(heading), np.sin(heading)])
    left = np.array([-ahead[1], ahead[0]])
    return np.asarray(centre + np.array([ahead - left, ahead + left, left - ahead, -ahead - left]))


def _lamp(points: Points, given: Properties, height: float) -> list[list[float]]:
    return [[float(points[0, 0]), float(points[0, 1]), *map(float, given["size"])]]


def _tour(points: Points, given: Properties, height: float) -> list[Points]:
    return [points]


_READERS: dict[str, Callable[[Points, Properties, float], list[Any]]] = {
    "room": _room,
    "wall": _walls,
    "door": _door,
    "panel": _panel,
    "window": _panel,
    "furniture": _furniture,
    "lamp": _lamp,
    "tour": _tour,
}
