"""Logs with beliefs, areas and the map."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mcap_logs import START, told_messages, walk
from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.logs import open_log
from placecue.logs.writing.annotated import AnnotatedLog, write_layout
from placecue.observation import EncodedImage, Observation
from placecue.scores import OneAgainstAll, Scores
from placecue.semantic_map import Area, Node, SemanticMap

CLASSES = ("corridor", "kitchen", "lab", "office")
MAP = SemanticMap(
    areas=(
        Area(1, "office", 0.75, {"office": 0.5}, START, START + 1, ((0, 0), (1, 0), (1, 1))),
        Area(2, "unknown", 0.0),
    ),
    nodes=(Node(1, 0.0, 0.0, 1), Node(2, 1.0, 1.0, 1), Node(3, 2.0, 1.0, 2, gateway=True)),
    edges=((1, 2), (2, 3)),
    classes=CLASSES,
)


def belief(stamp: int) -> Belief:
    scores = Scores(np.array([[-1.0, -0.5, np.inf, 0.25]]), OneAgainstAll(CLASSES))
    return Belief(stamp, scores, "office", 0.75, ("laser",))


@pytest.fixture(params=["cdr", "json"])
def path(tmp_path: Path, request: pytest.FixtureRequest) -> str:
    path = tmp_path / "annotated.mcap"
    with AnnotatedLog(path, CLASSES, encoding=request.param) as log:
        for i, observation in enumerate(walk()):
            update = AreaUpdate(1, "office", 0.5, finished=i == 5) if i > 2 else None
            log.observe(observation, belief(observation.stamp) if i else None, update)
        log.close_with(MAP)
    return str(path)


def test_everything_fits_its_schema_and_is_there(path: str) -> None:
    messages = told_messages(path)
    of = {
        topic: [value for at, _, value in messages if at == topic]
        for topic in ("/placecue/belief", "/placecue/area", "/placecue/map", "/placecue/map_scene")
    }
    assert len(of["/placecue/belief"]) == 5
    first = of["/placecue/belief"][0]
    assert first["stamp"] == walk()[1].stamp
    scores = {name: float(value) for name, value in first["scores"].items()}
    assert scores == dict(zip(CLASSES, [-1.0, -0.5, np.inf, 0.25], strict=True))
    assert (first["label"], first["confidence"], first["cues_used"]) == ("office", 0.75, ["laser"])
    assert [each["finished"] for each in of["/placecue/area"]] == [False, False, True]
    assert SemanticMap.from_json(of["/placecue/map"][0]) == MAP


def test_the_scene_shows_areas_nodes_and_edges(path: str) -> None:
    (scene,) = [value for topic, _, value in told_messages(path) if topic.endswith("map_scene")]
    entities = {entity["id"]: entity for entity in scene["entities"]}
    assert list(entities) == ["area 1", "area 2", "nodes", "edges"]
    (line,) = entities["area 1"]["lines"]
    assert [(point["x"], point["y"]) for point in line["points"]] == [(0, 0), (1, 0), (1, 1)]
    assert entities["area 1"]["texts"][0]["text"] == "office 0.75"
    assert entities["area 1"]["frame_id"] == "odom"
    spheres = entities["nodes"]["spheres"]
    assert spheres[0]["color"] == line["color"]
    assert spheres[2]["color"] != line["color"]
    assert len(entities["edges"]["lines"][0]["points"]) == 4


def test_the_observations_are_still_in_it(path: str) -> None:
    assert [each.label for each in open_log(path)] == [each.label for each in walk()]


def test_a_belief_is_kept_where_the_observation_cannot_be(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with AnnotatedLog(tmp_path / "a.mcap", CLASSES) as log:
        log.observe(walk()[0], None)
        log.observe(Observation(5, image=EncodedImage(b"").__call__), belief(5))
        log.observe(Observation(2**40 * 10**9), belief(2**40 * 10**9))
    assert "2 observations could not be written (the first: image does not decode" in caplog.text
    [message] = told_messages(str(tmp_path / "a.mcap"))
    assert message[0] == "/placecue/belief"
    assert message[2]["stamp"] == 5


def test_the_layout_shows_topics_that_are_written(path: str, tmp_path: Path) -> None:
    layout = json.loads(write_layout(tmp_path, "map").read_text())
    assert layout["configById"]["3D!placecue"]["followTf"] == "map"
    panels = layout["configById"]

    def leaves(tree: object) -> list[str]:
        return (
            [*leaves(tree["first"]), *leaves(tree["second"])]
            if isinstance(tree, dict)
            else [str(tree)]
        )

    assert sorted(leaves(layout["layout"])) == sorted(panels)
    written = {topic for topic, _, _ in told_messages(path)} | {"/camera/image/compressed"}
    assert panels["RawMessages!belief"]["topicPath"] in written
    assert panels["RawMessages!area"]["topicPath"] in written
    assert panels["Image!placecue"]["imageMode"]["imageTopic"] in written
    assert {"/placecue/map_scene", "/placecue/belief_scene"} <= set(panels["3D!placecue"]["topics"])
