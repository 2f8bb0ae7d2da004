"""A copy of a log with labels: the messages are the same to the byte."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from mcap_logs import SECOND, START
from placecue.errors import UsageError
from placecue.logs import open_log
from placecue.logs.mcap.container import LogFile
from placecue.logs.writing.annotate import annotate, label_events
from placecue.observation import Observation
from ros1_logs import Ros1Log

TOPIC = "/placecue/label"
EVENTS = [(START + SECOND // 2, "office"), (START + SECOND, ""), (START + 5 * SECOND, "late")]


def held(path: Path | str) -> list[tuple[Any, ...]]:
    """Return all of every message, in the order of the file."""
    with Path(path).open("rb") as file:
        return [
            (
                channel.topic,
                channel.message_encoding,
                channel.metadata,
                schema and (schema.name, schema.encoding, schema.data),
                (message.log_time, message.publish_time, message.sequence, message.data),
            )
            for schema, channel, message in make_reader(file).iter_messages(log_time_order=False)
        ]


def check(path: str, out: Path) -> None:
    whole = held(path)
    assert annotate(LogFile(path), EVENTS, out, TOPIC) == len(whole)
    assert [each for each in held(out) if each[0] != TOPIC] == whole
    assert [each[4][0] for each in held(out) if each[0] == TOPIC] == [stamp for stamp, _ in EVENTS]


def test_ros2(small_log: str, tmp_path: Path) -> None:
    out = tmp_path / "copy.mcap"
    check(small_log, out)
    labels = [each.label for each in open_log(out, label_topic=TOPIC)]
    assert labels == [None] * 5 + ["office"] * 5 + [None] * 10
    with out.open("rb") as file:
        # Channels that do not tell their quality of service are not what the profile promises.
        assert make_reader(file).get_header().profile == ""
        assert {m.message_encoding for m in LogFile(out).contents.channels.values()} == {"cdr"}


def test_ros1(tmp_path: Path) -> None:
    log = Ros1Log(tmp_path / "a.mcap")
    for i in range(12):
        log.scan(i * 0.1, [1.0 + i])
    path, out = log.close(), tmp_path / "copy.mcap"
    check(path, out)
    labels = [each.label for each in open_log(out)]
    assert labels == [None] * 5 + ["office"] * 5 + [None] * 2


def test_json(as_json: Any, tmp_path: Path) -> None:
    log = as_json()
    for i in range(12):
        log.scan(i * 0.1, [1.0 + i])
    path, out = log.close(), tmp_path / "copy.mcap"
    check(path, out)
    assert [each.label for each in open_log(out)] == [None] * 5 + ["office"] * 5 + [None] * 2


def test_all_else_is_copied(tmp_path: Path) -> None:
    """Attachments, metadata, channels without a schema, unsorted messages, sequence numbers."""
    path, out = tmp_path / "a.mcap", tmp_path / "copy.mcap"
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.LZ4, chunk_size=100)
        writer.start(profile="mine", library="theirs")
        writer.add_metadata("m", {"a": "b"})
        writer.add_attachment(3, 4, "map", "image/png", b"picture")
        schema = writer.register_schema("S", "", b"")
        channels = [
            writer.register_channel("/a", "raw", 0, {"k": "v"}),
            writer.register_channel("/b", "raw", schema),
            writer.register_channel("/a", "raw", schema),
        ]
        for i in range(40):
            time = START + (i * 7 % 11) * SECOND
            writer.add_message(channels[i % 3], time, bytes([i]), time + 5, i)
        writer.finish()
    check(str(path), out)
    with out.open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "mine"
        assert [(m.name, m.metadata) for m in reader.iter_metadata()] == [("m", {"a": "b"})]
        (attachment,) = reader.iter_attachments()
        assert (attachment.create_time, attachment.log_time) == (3, 4)
        assert (attachment.name, attachment.media_type) == ("map", "image/png")
        assert attachment.data == b"picture"


def test_changes_of_the_label() -> None:
    labels = [None, "a", "a", None, None, "b", "c"]
    moments = (Observation(i, label=label) for i, label in enumerate(labels))
    assert label_events(moments) == [(1, "a"), (3, ""), (5, "b"), (6, "c")]


def test_a_topic_that_is_taken_and_the_log_itself(small_log: str, tmp_path: Path) -> None:
    file = LogFile(small_log)
    with pytest.raises(UsageError, match="has a topic /scan already"):
        annotate(file, EVENTS, tmp_path / "copy.mcap", "/scan")
    with pytest.raises(UsageError, match="is the log itself"):
        annotate(file, EVENTS, small_log, TOPIC)
    assert [path.name for path in tmp_path.iterdir()] == ["small.mcap"]


def test_json_labels_have_the_stamp_inside(as_json: Any, tmp_path: Path) -> None:
    log = as_json()
    log.scan(0.0, [1.0])
    out = tmp_path / "copy.mcap"
    annotate(LogFile(log.close()), EVENTS[:1], out, TOPIC)
    (label,) = [each for each in held(out) if each[0] == TOPIC]
    assert json.loads(label[4][3]) == {"stamp": EVENTS[0][0], "label": "office"}
