"""``placecue convert`` and ``placecue info``, over every source."""

from __future__ import annotations

import gzip
import json
from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import IndexType, Writer

from command_line import placecue, succeeds
from mcap_logs import Ros2Log, json_messages
from placecue.logs import open_log
from rooms import ANGLES, Rooms


def counts(path: Path) -> Counter[str]:
    """Return the number of messages by schema, by the plain MCAP reader."""
    with path.open("rb") as file:
        return Counter(
            schema.name for schema, _, _ in make_reader(file).iter_messages() if schema is not None
        )


def test_office(tmp_path: Path) -> None:
    size = ["source.width=64", "source.height=48", "source.beams=37"]
    out = tmp_path / "made" / "office.mcap"
    told = succeeds("convert", "source=office", "source.samples=4", *size, f"out={out}")
    assert told.out.splitlines()[0].startswith("4 observations of ")
    assert f"placecue info {out}" in told.out
    found = counts(out)
    for name in ("CompressedImage", "LaserScan"):
        assert found[f"sensor_msgs/msg/{name}"] == 4
    for observation in open_log(out):
        assert observation.image is not None
        assert observation.scan is not None
        assert observation.image.shape == (48, 64, 3)
        assert observation.scan.ranges.shape == (37,)
        assert observation.label
        assert observation.pose is not None


@pytest.mark.parametrize("packed", [False, True])
def test_carmen(tmp_path: Path, packed: bool) -> None:
    ranges = [[1.5, 2.25, 3.0, 4.5], [1.0, 2.0, 3.5, 80.0]]
    lines = [
        f"FLASER 4 {' '.join(map(str, of))} {i}.5 2 0.25 3 4 0.5 {10 + i}.25 host {i}"
        for i, of in enumerate(ranges)
    ]
    path, out = tmp_path / ("run.log.gz" if packed else "run.log"), tmp_path / "run.mcap"
    data = ("# from a test\n" + "\n".join(lines) + "\n").encode()
    path.write_bytes(gzip.compress(data) if packed else data)
    told = succeeds("convert", "source=carmen", f"source.path={path}", f"out={out}")
    assert told.out.startswith("2 observations of run.log")
    seen = list(open_log(out))
    assert [each.stamp for each in seen] == [10_250_000_000, 11_250_000_000]
    for i, each in enumerate(seen):
        assert each.scan is not None
        assert each.pose is not None
        assert each.scan.ranges.tolist() == ranges[i]
        assert (each.pose.x, each.pose.y) == (i + 0.5, 2.0)
        assert each.pose.theta == pytest.approx(0.25, abs=1e-12)


def test_floorplan(tmp_path: Path, plan: Path) -> None:
    out = tmp_path / "plan.mcap"
    where = [f"source.path={plan}", "source.samples=40", "source.beams=31", "source.balance=class"]
    succeeds("convert", "source=floorplan", *where, f"out={out}")
    picture = cv2.imread(str(plan), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    names = {77: "room", 115: "hallway", 179: "doorway"}
    seen = list(open_log(out))
    assert Counter(each.label for each in seen).keys() == set(names.values())
    for each in seen:
        assert each.pose is not None
        column, row = int(each.pose.x / 0.05), int(each.pose.y / 0.05)
        assert names[int(picture[picture.shape[0] - 1 - row, column])] == each.label


def test_mcap_to_json(tmp_path: Path, log_a: Path) -> None:
    out = tmp_path / "a.json.mcap"
    succeeds("convert", "source=mcap", f"log={log_a}", "encoding=json", f"out={out}")
    messages = json_messages(str(out))
    assert {name for _, name, _ in messages} >= {"foxglove.LaserScan", "foxglove.CompressedImage"}
    scans = [message for _, name, message in messages if name == "foxglove.LaserScan"]
    expected = list(Rooms(seed=0))
    assert len(scans) == len(expected) == 96
    for message, observation in zip(scans, expected, strict=True):
        assert observation.scan is not None
        stamp = message["timestamp"]["sec"] * 10**9 + message["timestamp"]["nsec"]
        assert stamp == observation.stamp
        assert message["start_angle"] == pytest.approx(ANGLES[0], abs=1e-6)
        np.testing.assert_allclose(message["ranges"], observation.scan.ranges, rtol=1e-6)
    assert [each.label for each in open_log(out)] == [each.label for each in expected]


def test_part_of_a_log_and_a_list_of_logs(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    out = tmp_path / "part.mcap"
    part = ["source.start=2", "source.end=4", "source.parts=[scan,label]"]
    succeeds("convert", "source=mcap", f"log={log_a}", *part, f"out={out}")
    seen = list(open_log(out))
    assert len(seen) == 10  # two seconds at 5 Hz
    assert not any(each.has("image") or each.has("pose") for each in seen)
    both = tmp_path / "both.mcap"
    told = succeeds("convert", "source=mcap", f"log=[{log_a},{log_b}]", f"out={both}")
    assert "192 observations of a.mcap + b.mcap" in told.out


def test_info(log_a: Path, log_b: Path) -> None:
    told = succeeds("info", f"log=[{log_a},{log_b}]")
    assert told.out.count("96 observations") == 2
    for label in ("corridor", "kitchen", "lab", "office"):
        assert told.out.count(f"  {label}: 24") == 2
    assert "scan   /scan: the only scan topic" in told.out
    [row] = [line for line in told.out.splitlines() if line.startswith("/scan")][:1]
    assert row.split()[1:4] == ["sensor_msgs/msg/LaserScan", "cdr", "96"]


def test_info_of_a_log_that_needs_a_choice(two_lasers: Path) -> None:
    told = succeeds("info", f"log={two_lasers}")
    assert "choose one, such as source.scan_topic=" in told.out
    assert json.dumps(str(two_lasers)).strip('"') in told.out


def everything(path: Path) -> Path:
    """Write a log of ROS 2 with scans, and an IMU, a second scan, metadata and an attachment."""
    log = Ros2Log(path)
    for i in range(5):
        log.scan(float(i), [1.0 + i, 2.0, 3.0], topic="/front")
        log.string(float(i), f"said {i}", topic="/chatter")
        log.string(float(i), f"other {i}", topic="/label_of_nothing")
    log.writer.add_metadata("site", {"building": "A"})
    log.writer.add_attachment(1, 1, "notes.txt", "text/plain", b"hello")
    log.close()
    return path


def test_what_is_left_out_is_told(tmp_path: Path) -> None:
    source = everything(tmp_path / "in.mcap")
    words = [str(source), str(tmp_path / "out.mcap"), "source.label_topic=/label_of_nothing"]
    told = succeeds("convert", *words).out
    assert "left out: /chatter (std_msgs/msg/String, 5 messages), metadata site, " in told
    assert "attachment notes.txt; keep=all copies them" in told
    assert "std_msgs/msg/String" in counts(tmp_path / "out.mcap")  # the labels alone


def test_all_is_kept(tmp_path: Path) -> None:
    source, out = everything(tmp_path / "in.mcap"), tmp_path / "out.mcap"
    words = [str(source), str(out), "source.label_topic=/label_of_nothing", "keep=all"]
    assert "5 other messages copied as they are" in succeeds("convert", *words).out
    before, after = [], []
    for path, found in ((source, before), (out, after)):
        with path.open("rb") as file:
            for _, _, message in make_reader(file).iter_messages(topics=["/chatter"]):
                found.append((message.log_time, message.publish_time, message.data))
    assert after == before
    assert len(after) == 5
    with out.open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == ""  # the copied channel says nothing of its QoS
        assert {m.name: m.metadata for m in reader.iter_metadata()}["site"] == {"building": "A"}
        assert [a.data for a in reader.iter_attachments()] == [b"hello"]
    assert [len(each.scan.ranges) for each in open_log(out) if each.scan] == [3] * 5


def without_index(path: Path, out: Path) -> Path:
    """Write the messages and attachments of a log anew, as a recorder that keeps no index does."""
    with path.open("rb") as file, out.open("wb") as made:
        reader = make_reader(file)
        writer = Writer(made, index_types=IndexType.NONE, use_statistics=False)
        writer.start()
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            number = writer.register_schema(schema.name, schema.encoding, schema.data)
            topic = writer.register_channel(channel.topic, channel.message_encoding, number)
            writer.add_message(topic, message.log_time, message.data, message.publish_time)
        for each in reader.iter_attachments():
            writer.add_attachment(1, 1, each.name, each.media_type, each.data)
        writer.finish()
    return out


def test_attachments_of_a_file_without_an_index(tmp_path: Path) -> None:
    source = without_index(everything(tmp_path / "whole.mcap"), tmp_path / "in.mcap")
    words = [str(source), "keep=all", "source.label_topic=/label_of_nothing"]
    succeeds("convert", *words, str(tmp_path / "out.mcap"))
    with (tmp_path / "out.mcap").open("rb") as file:
        assert [a.data for a in make_reader(file).iter_attachments()] == [b"hello"]


def test_an_attachment_larger_than_the_limit_is_told(tmp_path: Path) -> None:
    source = everything(tmp_path / "in.mcap")
    words = [str(source), "keep=all", "source.label_topic=/label_of_nothing", "limits.file=20"]
    told = placecue("convert", *words, str(tmp_path / "out.mcap"))
    assert told.status == 0
    assert "1 of 1 attachments are left out" in told.err
    with (tmp_path / "out.mcap").open("rb") as file:
        assert list(make_reader(file).iter_attachments()) == []


def test_topics_that_are_written_give_way(tmp_path: Path, two_lasers: Path) -> None:
    out = tmp_path / "out.mcap"
    succeeds("convert", str(two_lasers), str(out), "source.scan_topic=/front", "keep=all")
    again = tmp_path / "again.mcap"
    succeeds("convert", str(out), str(again), "source.scan_topic=/rear", "keep=all")
    with again.open("rb") as file:
        topics = {c.topic for c in make_reader(file).get_summary().channels.values()}
    assert {"/scan", "/source/scan"} <= topics
