"""What Nav2 and spreadsheets read of a map, and the schema of the map itself."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import cv2
import jsonschema
import numpy as np
import pytest
import yaml

from placecue import Area, Node, SemanticMap
from placecue.free_space import FREE, OCCUPIED, UNSEEN, Grid
from placecue.storage.map_files import node_table, route_graph, write_map_files

SCHEMA = json.loads((files("placecue") / "schemas/semantic_map.schema.json").read_text())
SQUARE = (((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)),)
SURE = {"kitchen": 0.1, "office": 0.9}
MAP = SemanticMap(
    areas=(
        Area(
            0,
            "office",
            0.9,
            {"kitchen|office": -1.2},
            5,
            9,
            margin=1.2,
            probabilities=SURE,
            surface=(SQUARE,),
        ),
        Area(3, "unknown", 0.0, trajectory=((3.0, 4.0),)),
        Area(4, "kitchen", 0.7, frame="map"),
    ),
    nodes=(
        Node(0, 0.5, 0.5, 0, probabilities=SURE),
        Node(1, 1.5, 0.5, 0, gateway=True, heading=0.1),
        Node(2, 3.5, 4.5, 3),
        Node(3, 0.0, 0.0, 4),
    ),
    edges=((0, 1), (1, 2)),
    classes=("kitchen", "office"),
)


def test_the_map_is_as_its_schema_says() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(json.loads(json.dumps(MAP.to_json())), SCHEMA)


@pytest.mark.parametrize(
    ("where", "value"),
    [
        (["version"], 1),
        (["areas", 0, "confidence"], 1.5),
        (["areas", 0, "surface"], [[[[0, 0], [1, 0]]]]),
        (["nodes", 0, "colour"], "red"),
        (["edges", 0], [1]),
        (["classes"], ["kitchen", "kitchen"]),
    ],
)
def test_the_schema_refuses_what_is_none(where: list[str | int], value: object) -> None:
    data = json.loads(json.dumps(MAP.to_json()))
    place = data
    for key in where[:-1]:
        place = place[key]
    place[where[-1]] = value
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, SCHEMA)


def test_nav2_finds_classes_in_the_metadata_and_edges_both_ways() -> None:
    features = route_graph(MAP)["features"]
    nodes = {f["properties"]["id"]: f for f in features if f["geometry"]["type"] == "Point"}
    edges = [f for f in features if f["geometry"]["type"] == "MultiLineString"]
    assert {n: f["properties"]["metadata"]["class"] for n, f in nodes.items()} == {
        0: "office",
        1: "office",
        2: "unknown",
    }  # node 3 is in another frame
    assert all(f["properties"]["frame"] == "odom" for f in nodes.values())
    ends = [(f["properties"]["startid"], f["properties"]["endid"]) for f in edges]
    assert sorted(ends) == [(0, 1), (1, 0), (1, 2), (2, 1)]
    ids = [f["properties"]["id"] for f in features]
    assert len(set(ids)) == len(ids)
    [there] = [
        f for f in edges if f["properties"]["startid"] == 1 and f["properties"]["endid"] == 2
    ]
    assert there["geometry"]["coordinates"] == [[[1.5, 0.5], [3.5, 4.5]]]
    assert there["properties"]["cost"] == pytest.approx(np.sqrt(20))


def test_a_graph_without_edges_which_nav2_refuses_is_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    write_map_files(replace(MAP, edges=()), None, tmp_path)
    assert "no edges" in caplog.text
    caplog.clear()
    write_map_files(MAP, None, tmp_path)
    assert not caplog.text


def test_the_picture_is_read_as_the_grid(tmp_path: Path) -> None:
    states = np.array([[FREE, OCCUPIED, UNSEEN], [FREE, FREE, UNSEEN]])
    written = write_map_files(MAP, Grid(states, 0.1, -1.5, 2.0, "odom"), tmp_path)
    assert {path.name for path in written} == {path.name for path in tmp_path.iterdir()}
    picture = cv2.imread(str(tmp_path / "map.pgm"), cv2.IMREAD_GRAYSCALE)
    about = yaml.safe_load((tmp_path / "map.yaml").read_text())
    # As map_server does it, the last line of the picture being the lowest y.
    occupied = (255 - picture[::-1].astype(float)) / 255
    read = np.where(occupied > about["occupied_thresh"], OCCUPIED, UNSEEN)
    read = np.where(occupied < about["free_thresh"], FREE, read)
    np.testing.assert_array_equal(read, states)
    assert about["origin"] == [-1.5, 2.0, 0.0]
    assert (about["resolution"], about["image"], about["negate"]) == (0.1, "map.pgm", 0)


def test_without_free_space_there_is_no_picture(tmp_path: Path) -> None:
    write_map_files(MAP, None, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"route_graph.geojson", "nodes.csv"}


def test_the_table_has_a_line_a_node() -> None:
    rows = list(csv.DictReader(io.StringIO(node_table(MAP))))
    assert [row["label"] for row in rows] == ["office", "office", "unknown", "kitchen"]
    assert rows[0]["p(office)"] == "0.9000"
    assert rows[1]["p(office)"] == ""
    assert [row["gateway"] for row in rows] == ["0", "1", "0", "0"]
    assert rows[3]["frame"] == "map"
