"""A semantic map and beliefs as a 3D scene for Foxglove and Lichtblick."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from placecue.belief import Belief
from placecue.logs.messages.foxglove_messages import point, pose, time
from placecue.observation import Pose2D
from placecue.semantic_map import UNKNOWN, Area, Node, SemanticMap

Color = tuple[float, float, float]
Entity = dict[str, Any]

#: Red, green and blue from 0 to 1, told apart by people who see colours differently
#: (Okabe & Ito, Color universal design, 2008).
PALETTE: tuple[Color, ...] = (
    (0.90, 0.62, 0.00),
    (0.34, 0.71, 0.91),
    (0.00, 0.62, 0.45),
    (0.94, 0.89, 0.26),
    (0.00, 0.45, 0.70),
    (0.84, 0.37, 0.00),
    (0.80, 0.47, 0.65),
)
GREY: Color = (0.6, 0.6, 0.6)

LINE_STRIP, LINE_LIST = 0, 2
DELETE_ALL = 1


def palette(classes: Sequence[str]) -> dict[str, Color]:
    """Return a colour for each class, by its place in the list, and grey for unknown."""
    colours = {name: PALETTE[i % len(PALETTE)] for i, name in enumerate(classes)}
    return {**colours, UNKNOWN: GREY}


def map_update(
    stamp: int, semantic_map: SemanticMap, colours: Mapping[str, Color], size: float = 0.3
) -> dict[str, Any]:
    """Return the message that shows a whole map in place of what was shown before.

    Parameters
    ----------
    stamp : int
        Time, ns.
    semantic_map : SemanticMap
        The map.
    colours : mapping of str to (r, g, b)
        Colour by class, 0 to 1; grey where one is missing.
    size : float
        Diameter of a node, m; lines and texts are scaled to it.

    Returns
    -------
    dict
        A foxglove.SceneUpdate: an entity an area (trajectory and name), one of the nodes, one of
        the edges.
    """
    shades = {area.id: colours.get(area.label, GREY) for area in semantic_map.areas}
    frame = semantic_map.frame
    entities = [
        _area(stamp, frame, area, shades[area.id], size, _of_area(semantic_map, area))
        for area in semantic_map.areas
    ]
    entities.append(
        _entity(
            stamp,
            frame,
            "nodes",
            spheres=[_node(node, shades.get(node.area, GREY), size) for node in semantic_map.nodes],
        )
    )
    at = {node.id: (node.x, node.y) for node in semantic_map.nodes}
    ends = [at[node] for edge in semantic_map.edges for node in edge]
    entities.append(_entity(stamp, frame, "edges", lines=[_line(LINE_LIST, ends, GREY, size / 6)]))
    deletion = {"timestamp": time(stamp), "type": DELETE_ALL, "id": ""}
    return {"deletions": [deletion], "entities": entities}


def belief_update(
    belief: Belief, where: Pose2D, colours: Mapping[str, Color], size: float = 0.3
) -> dict[str, Any]:
    """Return the message that shows what the robot believes, above the robot.

    Parameters
    ----------
    belief : Belief
        What it believes.
    where : Pose2D
        Where it is.
    colours : mapping of str to (r, g, b)
        Colour by class.
    size : float
        Height of the text, m.
    """
    colour = colours.get(belief.label, GREY)
    entity = _entity(
        belief.stamp,
        where.frame,
        "belief",
        spheres=[_sphere(where.x, where.y, colour, size)],
        texts=[_text(belief.label, where.x, where.y, 3 * size, colour, size)],
    )
    return {"deletions": [], "entities": [entity]}


def _of_area(semantic_map: SemanticMap, area: Area) -> tuple[float, float] | None:
    """Return where the name of an area goes: the middle of its way, or of its nodes."""
    nodes = [(node.x, node.y) for node in semantic_map.nodes if node.area == area.id]
    points = area.trajectory or tuple(nodes)
    return points[len(points) // 2] if points else None


def _area(
    stamp: int,
    frame: str,
    area: Area,
    colour: Color,
    size: float,
    at: tuple[float, float] | None,
) -> Entity:
    text = f"{area.label} {area.confidence:.2f}"
    return _entity(
        stamp,
        frame,
        f"area {area.id}",
        metadata=[{"key": "label", "value": area.label}],
        lines=[_line(LINE_STRIP, area.trajectory, colour, size / 2)],
        texts=[] if at is None else [_text(text, *at, 2 * size, colour, size)],
    )


def _entity(stamp: int, frame: str, name: str, **primitives: list[dict[str, Any]]) -> Entity:
    kinds = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
    return {
        "timestamp": time(stamp),
        "frame_id": frame,
        "id": name,
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": False,
        "metadata": [],
        **{kind: [] for kind in kinds},
        **primitives,
    }


def _line(
    kind: int, points: Sequence[tuple[float, float]], colour: Color, thickness: float
) -> dict[str, Any]:
    return {
        "type": kind,
        "pose": pose(0.0, 0.0),
        "thickness": thickness,
        "scale_invariant": False,
        "points": [point(x, y) for x, y in points],
        "color": _rgba(colour),
        "colors": [],
        "indices": [],
    }


def _node(node: Node, colour: Color, size: float) -> dict[str, Any]:
    return _sphere(node.x, node.y, GREY if node.gateway else colour, size)


def _sphere(x: float, y: float, colour: Color, size: float) -> dict[str, Any]:
    return {"pose": pose(x, y), "size": point(size, size, size), "color": _rgba(colour)}


def _text(text: str, x: float, y: float, z: float, colour: Color, size: float) -> dict[str, Any]:
    return {
        "pose": pose(x, y, z=z),
        "billboard": True,
        "font_size": size,
        "scale_invariant": False,
        "color": _rgba(colour),
        "text": text,
    }


def _rgba(colour: Color) -> dict[str, float]:
    return {**dict(zip("rgb", colour, strict=True)), "a": 1.0}
