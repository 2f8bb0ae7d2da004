"""``placecue label``: areas on a map, with each boundary."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import cv2
import pytest

from command_line import succeeds
from placecue.semantic_map import SemanticMap
from placecue_accumulators.neighbours import Neighbours
from results import check_metrics, messages, rows
from rooms import ROOMS

FILES = {
    *("annotated.mcap", "beliefs.csv", "metrics.json", "placecue_layout.json"),
    *(
        "report.html",
        "semantic_map.geojson",
        "semantic_map.json",
        "semantic_map.png",
        "semantic_map.svg",
    ),
    *("map.pgm", "map.yaml", "nodes.csv", "route_graph.geojson"),
}


def room_at(x: float) -> str:
    """Return the room whose middle is nearest, as :mod:`rooms` puts them in a row."""
    return list(ROOMS)[round(x / 30.0)]


@pytest.mark.parametrize("boundary", ["door", "door_noisy", "none", "node", "[door,evidence]"])
def test_every_boundary(tmp_path: Path, model: Path, log_b: Path, boundary: str) -> None:
    out, chosen = tmp_path / "out", f"boundaries@accumulator.boundary={boundary}"
    words = ["accumulator=spatiotemporal", chosen]
    told = succeeds("label", f"model={model}", f"log={log_b}", *words, f"out={out}")
    assert {path.name for path in out.iterdir()} == FILES
    data = json.loads((out / "semantic_map.json").read_text())
    semantic_map = SemanticMap.from_json(data)
    assert semantic_map.classes == tuple(ROOMS)
    assert json.loads(json.dumps(semantic_map.to_json())) == data
    named = [area for area in semantic_map.areas if area.label != "unknown"]
    assert f"{len(semantic_map.areas)} areas, {len(named)} of them labelled" in told.out
    assert named
    if boundary == "node":
        # No area is larger than a node, so each lies in one room.
        assert len(named) > len(ROOMS)
        for area in named:
            assert {room_at(x) for x, _ in area.trajectory} == {area.label}
    picture = cv2.imread(str(out / "semantic_map.png"))
    assert picture is not None
    assert picture.std() > 1
    assert f"its picture                            {out / 'semantic_map.png'}" in told.out


def test_what_is_written(labelled: Path) -> None:
    out = labelled
    table = rows(out / "beliefs.csv")
    beliefs = messages(out / "annotated.mcap", "/placecue/belief")
    assert [(b["stamp"], b["label"]) for b in beliefs] == [
        (int(row["stamp"]), row["label"]) for row in table
    ]
    [drawn] = messages(out / "annotated.mcap", "/placecue/map")
    assert drawn == json.loads((out / "semantic_map.json").read_text())
    scenes = messages(out / "annotated.mcap", "/placecue/map_scene")
    assert len(scenes) == 1
    assert len(messages(out / "annotated.mcap", "/placecue/area")) >= 1
    check_metrics(out)
    geojson = json.loads((out / "semantic_map.geojson").read_text())
    kinds = [feature["properties"]["kind"] for feature in geojson["features"]]
    assert kinds.count("area") == len(drawn["areas"])
    assert kinds.count("node") == len(drawn["nodes"])
    assert kinds.count("edge") == len(drawn["edges"])
    assert json.loads((out / "placecue_layout.json").read_text())


def test_neighbours_learned_from_a_labelled_log(
    tmp_path: Path, laser_model: Path, log_b: Path
) -> None:
    """Each room is seen in twelve places 2 m apart or closer, before the next."""
    example = Path(__file__).parents[2] / "examples" / "learn_neighbours.py"
    runpy.run_path(str(example))["main"](str(laser_model), [str(log_b)], str(tmp_path))
    steps = Neighbours.read(tmp_path / "transitions.json", tuple(ROOMS)).weights
    assert steps.sum(axis=1) == pytest.approx(1)
    assert steps.argmax(axis=1).tolist()[0] == 0  # the corridor is the longest
    weights = Neighbours.read(tmp_path / "weights.json", tuple(ROOMS)).weights
    assert weights[0].argmax() == 0


def test_accumulator_options_reach_it(tmp_path: Path, laser_model: Path, log_b: Path) -> None:
    """No belief is as sure as this, so no area gets a name."""
    out = tmp_path / "out"
    words = ["accumulator.accept_confidence=1000", "accumulator.node_spacing=3"]
    told = succeeds("label", f"model={laser_model}", f"log={log_b}", *words, f"out={out}")
    data = json.loads((out / "semantic_map.json").read_text())
    assert {area["label"] for area in data["areas"]} == {"unknown"}
    assert "0 of them labelled" in told.out
