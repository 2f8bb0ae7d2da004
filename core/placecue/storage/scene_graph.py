"""A semantic map as a scene graph that spark_dsg (Hydra's library) loads: places in named rooms."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from placecue.atomic import replacing
from placecue.errors import UsageError
from placecue.semantic_map import UNKNOWN, Area, Node, SemanticMap

SCENE_GRAPH = "scene_graph.json"
#: Boxes around rooms are so high, m: a flat one is none to the library.
HEIGHT = 2.5
INSTALL = "pip install 'placecue[dsg]'"


def check_scene_graphs() -> None:
    """Raise UsageError, with the line to type, unless spark_dsg is installed."""
    if find_spec("spark_dsg") is None:
        raise UsageError(
            f"scene_graph=true needs spark_dsg, which is not installed: {INSTALL}, or leave it out"
        )


def write_scene_graph(semantic_map: SemanticMap, path: Path) -> Path:
    """Write a map as JSON that ``spark_dsg.DynamicSceneGraph.load`` reads.

    Parameters
    ----------
    semantic_map : SemanticMap
        Each area becomes a room, named as in the picture, and each node a place in it; areas of
        another frame than the map's are left out. Label, confidence, frame and whether a place
        is a door stand in the metadata.
    path : Path
        The file, ``.json``.

    Returns
    -------
    Path

    Raises
    ------
    UsageError
        If spark_dsg is not installed.

    References
    ----------
    Hughes, Chang and Carlone, Hydra, RSS 2022. https://github.com/MIT-SPARK/Spark-DSG
    """
    check_scene_graphs()
    dsg = import_module("spark_dsg")
    graph = dsg.DynamicSceneGraph()
    rooms, places = dsg.DsgLayers.ROOMS, dsg.DsgLayers.PLACES
    areas = [area for area in semantic_map.areas if area.frame == semantic_map.frame]
    numbers = {name: row for row, name in enumerate(semantic_map.classes)}
    for area in areas:
        nodes = [node for node in semantic_map.nodes if node.area == area.id]
        room = dsg.NodeSymbol("R", area.id)
        graph.add_node(rooms, room, _room(dsg, area, nodes, numbers))
        for node in nodes:
            graph.add_node(places, dsg.NodeSymbol("p", node.id), _place(dsg, node))
            graph.insert_edge(room, dsg.NodeSymbol("p", node.id))
    for pair in _between(semantic_map):
        graph.insert_edge(*(dsg.NodeSymbol("R", area) for area in pair))
    for a, b in semantic_map.edges:
        graph.insert_edge(dsg.NodeSymbol("p", a), dsg.NodeSymbol("p", b))
    names = dict(enumerate(semantic_map.classes))
    graph.set_labelspace(dsg.Labelspace(names), graph.get_layer(rooms).key.layer)
    with replacing(path) as part:
        named = part.with_name(f"{part.name}.json")  # the library goes by the suffix
        graph.save(str(named))
        named.replace(part)
    return path


def _room(dsg: Any, area: Area, nodes: list[Node], numbers: dict[str, int]) -> Any:
    made = dsg.RoomNodeAttributes()
    points = [c for outline, *_ in area.surface for c in outline] or area.trajectory
    points = points or [(node.x, node.y) for node in nodes]
    if points:
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        middle = (low + high) / 2
        made.position = np.array([*middle, 0.0])
        sides = np.array([*(high - low), HEIGHT])
        made.bounding_box = dsg.BoundingBox(sides, np.array([*middle, HEIGHT / 2]))
    made.name = f"{area.label} {area.id}"
    if area.label != UNKNOWN:
        made.semantic_label = numbers[area.label]
    made.semantic_class_probabilities = dict(area.probabilities)
    about = {"label": area.label, "confidence": area.confidence, "frame": area.frame}
    made.metadata.set(about)
    return made


def _place(dsg: Any, node: Node) -> Any:
    made = dsg.PlaceNodeAttributes()
    made.position = np.array([node.x, node.y, 0.0])
    made.metadata.set({"door": node.gateway})
    return made


def _between(semantic_map: SemanticMap) -> list[tuple[int, int]]:
    """Return the pairs of areas that the robot went between."""
    home = {node.id: node.area for node in semantic_map.nodes}
    pairs = {tuple(sorted((home[a], home[b]))) for a, b in semantic_map.edges}
    return sorted((a, b) for a, b in pairs if a != b)
