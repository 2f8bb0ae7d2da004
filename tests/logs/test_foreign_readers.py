"""Other people's readers read what placecue writes: every message of every file."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader

from mcap_logs import Ros2Log, walk
from placecue.belief import Belief
from placecue.logs import open_log
from placecue.logs.writing.annotate import annotate
from placecue.logs.writing.annotated import AnnotatedLog
from placecue.logs.writing.writer import McapWriter
from placecue.scores import OneAgainstAll, Scores
from placecue.semantic_map import Area, Node, SemanticMap

CLASSES = ("corridor", "kitchen", "lab", "office")
MAP = SemanticMap(
    (Area(1, "office", 0.75, {"office": 0.5}, 1, 2, ((0, 0), (1, 1))),), (Node(1, 0, 0, 1),), (),
    CLASSES,
)  # fmt: skip


def copied(folder: Path) -> Path:
    path = folder / "copy.mcap"
    with McapWriter(path) as writer:
        for each in walk():
            writer.write(each)
    return path


def annotated(folder: Path) -> Path:
    path = folder / "annotated.mcap"
    with AnnotatedLog(path, CLASSES) as log:
        for each in walk():
            scores = Scores(np.array([[-1.0, 0.5, 0.1, 0.25]]), OneAgainstAll(CLASSES))
            log.observe(each, Belief(each.stamp, scores, "kitchen", 0.5, ("laser",)))
        log.close_with(MAP)
    return path


def labelled(folder: Path) -> Path:
    path = folder / "labelled.mcap"
    annotate(open_log(copied(folder)).file, [(walk()[0].stamp, "lab")], path, "/place")
    return path


FILES = [copied, annotated, labelled]


def counts(path: Path) -> Counter[str]:
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        return Counter(channel.topic for _, channel, _ in reader.iter_messages())


def profile(path: Path) -> str:
    with path.open("rb") as file:
        return make_reader(file).get_header().profile


@pytest.mark.parametrize("made", FILES)
def test_ros_readers(made, tmp_path: Path) -> None:
    path = made(tmp_path)
    assert profile(path) == "ros2"
    expected = counts(path)
    decoded = Counter(each.channel.topic for each in read_ros2_messages(path))
    assert decoded == expected
    with AnyReader([path]) as reader:
        found: Counter[str] = Counter()
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
            found[connection.topic] += 1
    assert found == expected
    assert all(connection.ext.offered_qos_profiles for connection in reader.connections)


def test_a_belief_comes_through_whole(tmp_path: Path) -> None:
    path = annotated(tmp_path)
    beliefs = [e.ros_msg for e in read_ros2_messages(path, topics=["/placecue/belief"])]
    assert [each.stamp for each in beliefs] == [each.stamp for each in walk()]
    assert beliefs[0].columns == list(CLASSES)
    assert beliefs[0].scores == [-1.0, 0.5, 0.1, 0.25]
    assert (beliefs[0].label, beliefs[0].confidence) == ("kitchen", 0.5)
    [scene] = [e.ros_msg for e in read_ros2_messages(path, topics=["/placecue/map_scene"])]
    assert [each.id for each in scene.entities] == ["area 1", "nodes", "edges"]
    [line] = scene.entities[0].lines
    assert [(point.x, point.y) for point in line.points] == [(0, 0), (1, 1)]
    assert scene.entities[0].texts[0].text == "office 0.75"


def test_a_log_in_json_claims_no_ros(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with AnnotatedLog(path, CLASSES, encoding="json") as log:
        for each in walk():
            log.observe(each, None)
        log.close_with(MAP)
    assert profile(path) == ""


def test_a_copy_of_a_log_without_qos_claims_no_ros(tmp_path: Path) -> None:
    source = tmp_path / "bare.mcap"
    log = Ros2Log(source)
    log.scan(0.0, [1.0, 2.0])
    log.scan(1.0, [1.0, 2.0])
    log.close()
    annotate(open_log(source).file, [(1, "lab")], tmp_path / "out.mcap", "/place")
    assert profile(tmp_path / "out.mcap") == ""


#: Prints the profile of a file, and how many messages of each topic its index leads to.
READS = """
const {McapIndexedReader} = require("@mcap/core");
const {decompress} = require("fzstd");
const file = require("fs").readFileSync(process.argv[1]);
const readable = {
  size: async () => BigInt(file.length),
  read: async (at, size) => new Uint8Array(file.subarray(Number(at), Number(at + size))),
};
const zstd = (data, size) => decompress(data, new Uint8Array(Number(size)));
(async () => {
  const reader = await McapIndexedReader.Initialize({readable, decompressHandlers: {zstd}});
  const counts = {};
  for await (const message of reader.readMessages({validateCrcs: true})) {
    const {topic} = reader.channelsById.get(message.channelId);
    counts[topic] = (counts[topic] ?? 0) + 1;
  }
  console.log(JSON.stringify([reader.header.profile, counts]));
})();
"""


@pytest.mark.parametrize("made", FILES)
def test_the_javascript_reader(made, tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node")
    probe = [node, "-e", "require('@mcap/core'); require('fzstd')"]
    if subprocess.run(probe, capture_output=True, check=False).returncode:
        pytest.skip("needs @mcap/core and fzstd where node finds them (NODE_PATH)")
    path = made(tmp_path)
    told = subprocess.run(
        [node, "-e", READS, str(path)], capture_output=True, text=True, check=True
    )
    assert json.loads(told.stdout) == ["ros2", dict(counts(path))]
