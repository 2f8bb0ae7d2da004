"""A map for spark_dsg, loaded by its own library."""

import json
import sys

import numpy as np
import pytest

from placecue import Area, Node, SemanticMap, UsageError
from placecue.storage.scene_graph import write_scene_graph

KITCHEN = (((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)),)
CLASSES = ("kitchen", "office")


def two_rooms():
    areas = (
        Area(3, "kitchen", 0.9, probabilities={"kitchen": 0.9, "office": 0.1}, surface=(KITCHEN,)),
        Area(4, "unknown", 0.0, trajectory=((5.0, 1.0), (7.0, 2.0))),
        Area(5, "office", 0.8, frame="map", trajectory=((9.0, 9.0),)),
    )
    nodes = (Node(0, 1, 1, 3), Node(1, 4.1, 1.5, 3, True), Node(2, 6, 2, 4), Node(3, 9, 9, 5))
    return SemanticMap(areas, nodes, ((0, 1), (1, 2)), CLASSES)


def test_rooms_places_and_what_lies_between_are_read_by_spark_dsg(tmp_path):
    spark_dsg = pytest.importorskip("spark_dsg", reason="placecue[dsg] is not installed")
    path = write_scene_graph(two_rooms(), tmp_path / "scene_graph.json")
    assert json.loads(path.read_text())["SPARK_DSG_header"]["version"]["major"] == 1
    graph = spark_dsg.DynamicSceneGraph.load(str(path))
    rooms_layer = spark_dsg.DsgLayers.ROOMS
    rooms = {str(n.id): n for n in graph.get_layer(rooms_layer).nodes}
    assert [node.attributes.name for node in rooms.values()] == ["kitchen 3", "unknown 4"]
    kitchen, unknown = rooms.values()
    assert kitchen.attributes.semantic_class_probabilities == {"kitchen": 0.9, "office": 0.1}
    assert graph.get_labelspace(graph.get_layer(rooms_layer).key.layer).labels_to_names == dict(
        enumerate(CLASSES)
    )
    assert kitchen.attributes.semantic_label == 0
    assert unknown.attributes.semantic_label == spark_dsg.SemanticNodeAttributes.NO_SEMANTIC_LABEL
    np.testing.assert_allclose(kitchen.attributes.position, [2, 1.5, 0])
    np.testing.assert_allclose(kitchen.attributes.bounding_box.dimensions, [4, 3, 2.5])
    assert kitchen.attributes.bounding_box.is_valid()
    assert list(kitchen.siblings()) == [unknown.id.value]
    places = [graph.get_node(number) for number in sorted(kitchen.children())]
    assert [p.attributes.metadata.get() for p in places] == [{"door": False}, {"door": True}]
    assert [path.name for path in tmp_path.iterdir()] == ["scene_graph.json"]


def test_without_the_library_the_line_to_type_is_said(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "spark_dsg", None)
    with pytest.raises(UsageError, match=r"pip install 'placecue\[dsg\]'"):
        write_scene_graph(two_rooms(), tmp_path / "scene_graph.json")
