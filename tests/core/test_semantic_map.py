import json

import pytest

from placecue import Area, DataError, Node, SemanticMap

MAP = SemanticMap(
    areas=(
        Area(
            0,
            "corridor",
            0.7,
            {"corridor": 0.9},
            5,
            9,
            ((0.0, 0.0), (1.0, 0.5)),
            margin=0.6,
            probabilities={"corridor": 0.7, "office": 0.3},
            frame="map",
        ),
        Area(4, "unknown", 0.0),
    ),
    nodes=(Node(0, 0.0, 0.0, 0), Node(1, 1.0, 0.5, 0, gateway=True), Node(2, 2.0, 0.5, 4)),
    edges=((0, 1), (1, 2)),
    classes=("corridor", "kitchen", "office", "printer"),
    frame="map",
)


def test_it_survives_json():
    assert SemanticMap.from_json(json.loads(json.dumps(MAP.to_json()))) == MAP


def test_geojson_has_areas_nodes_and_edges():
    features = json.loads(json.dumps(MAP.to_geojson()))["features"]
    kinds = [(f["properties"]["kind"], f["geometry"]["type"]) for f in features]
    assert kinds == [
        ("area", "LineString"),
        ("area", "MultiPoint"),
        *[("node", "Point")] * 3,
        *[("edge", "LineString")] * 2,
    ]
    assert features[0]["geometry"]["coordinates"] == [[0, 0], [1, 0.5]]
    assert [f["properties"]["label"] for f in features[2:5]] == ["corridor", "corridor", "unknown"]
    assert features[3]["properties"]["gateway"] is True
    assert features[6]["geometry"]["coordinates"] == [[1, 0.5], [2, 0.5]]


def test_areas_are_found_by_number():
    assert MAP.area(4).label == "unknown"
    with pytest.raises(DataError, match="no area 1"):
        MAP.area(1)


@pytest.mark.parametrize("data", [{}, {"type": "placecue/semantic_map", "version": 1}])
def test_other_data_are_refused(data):
    with pytest.raises(DataError, match="not a semantic map"):
        SemanticMap.from_json(data)


@pytest.mark.parametrize("field", ["areas", "nodes", "edges", "classes", "frame"])
def test_data_that_lack_something_are_refused(field):
    data = MAP.to_json()
    del data[field]
    with pytest.raises(DataError, match=f"broken semantic map .*{field}"):
        SemanticMap.from_json(data)


def test_unknown_fields_are_refused():
    data = MAP.to_json()
    data["nodes"][0]["colour"] = "red"
    with pytest.raises(DataError, match="broken semantic map"):
        SemanticMap.from_json(data)
