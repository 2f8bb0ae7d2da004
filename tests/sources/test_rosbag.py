"""Bags written by rosbags' own writers, and recorded ones; the same messages as in MCAP."""

from __future__ import annotations

import inspect
import logging
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from bags import Recording, drive
from mcap_logs import SECOND, START
from placecue.errors import DataError, UsageError
from placecue.logs import McapLog, open_log
from placecue.logs.rosbag import RosbagLog
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage, Observation

DATA = os.environ.get("PLACECUE_DATA")
needs_data = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")
both = pytest.mark.parametrize("ros", [1, 2])


def same(one: Observation, other: Observation) -> None:
    assert (one.stamp, one.label, one.pose) == (other.stamp, other.label, other.pose)
    assert one.image_source == other.image_source or (
        isinstance(one.image_source, EncodedImage)
        and isinstance(other.image_source, EncodedImage)
        and one.image_source.data == other.image_source.data
    )
    assert (one.scan is None) == (other.scan is None)
    if one.scan is not None and other.scan is not None:
        np.testing.assert_array_equal(one.scan.angles, other.scan.angles)
        np.testing.assert_array_equal(one.scan.ranges, other.scan.ranges)
        limits = (one.scan.range_min, one.scan.range_max, one.scan.mount)
        assert limits == (other.scan.range_min, other.scan.range_max, other.scan.mount)


@both
def test_a_bag_holds_what_was_written(ros: int, tmp_path: Path) -> None:
    log = RosbagLog(drive(ros).as_bag(tmp_path / "run.bag"))
    seen = list(log)
    assert log.count() == len(seen) == 12
    assert log.metadata == {"format": f"ROS {ros} bag"}
    third = seen[3]
    assert third.stamp == START + 330_000_000
    assert [each.label for each in seen] == ["office"] * 6 + ["office"] + ["corridor"] * 5
    assert third.pose is not None
    # 0.03 s after the odometry at 0.3 s, at 1 m/s and 1 rad/s.
    assert (third.pose.x, third.pose.y, third.pose.theta) == pytest.approx((0.33, 0.0, 0.33))
    assert third.pose.frame == "odom"
    assert third.image is not None
    assert abs(float(third.image.mean()) - 30) < 3
    assert third.scan is not None
    # The laser hangs upside down: its first beam, of 4 m, points to the robot's left.
    assert third.scan.ranges.tolist() == [3.0, math.inf, 4.0]
    np.testing.assert_allclose(third.scan.angles, [-0.5, 0.0, 0.5])
    left = third.scan.points()[-1]
    np.testing.assert_allclose(left, [0.2 + 4 * math.cos(0.5), 0.1 + 4 * math.sin(0.5)])


@both
def test_a_bag_gives_what_mcap_gives(ros: int, tmp_path: Path) -> None:
    made = drive(ros)
    bag = RosbagLog(made.as_bag(tmp_path / "run.bag"))
    mcap = open_log(made.as_mcap(tmp_path / "run.mcap"))
    for one, other in zip(bag, mcap, strict=True):
        same(one, other)
    options: dict[str, Any] = {"parts": ["scan", "pose"], "start": 0.3, "end": 0.9}
    cut = RosbagLog(str(tmp_path / "run.bag"), **options)
    again = open_log(tmp_path / "run.mcap", **options)
    assert len(list(cut)) == 6
    for one, other in zip(cut, again, strict=True):
        same(one, other)


@pytest.mark.parametrize(
    ("ros", "options"),
    [
        (1, {"compression": "BZ2", "chunk": 600}),
        (1, {"compression": "LZ4", "chunk": 600}),
        (2, {"storage": "MCAP"}),
        (2, {"compression": "FILE"}),
        (2, {"compression": "MESSAGE"}),
    ],
)
def test_kinds_of_bags(ros: int, options: dict[str, Any], tmp_path: Path) -> None:
    made = drive(ros)
    plain = RosbagLog(made.as_bag(tmp_path / "plain.bag"))
    for one, other in zip(
        RosbagLog(made.as_bag(tmp_path / "other.bag", **options)), plain, strict=True
    ):
        same(one, other)


def test_sqlite_without_definitions_or_metadata(tmp_path: Path) -> None:
    made = drive(2)
    plain = list(RosbagLog(made.as_bag(tmp_path / "plain")))
    folder = tmp_path / "killed"
    folder.mkdir()
    file = made.as_bare_sqlite(folder / "killed_0.db3")
    for path in (file, str(folder)):
        for distribution in ("foxy", "humble", "jazzy"):
            log = RosbagLog(path, distribution=distribution)
            assert log.count() == 12
            for one, other in zip(log, plain, strict=True):
                same(one, other)


@both
def test_a_topic_must_be_chosen(ros: int, tmp_path: Path) -> None:
    made = drive(ros, images=False)
    made.scan(0.5, [9.0, 9.0, 9.0], topic="/rear/scan")
    path = made.as_bag(tmp_path / "run.bag")
    with pytest.raises(UsageError, match=r"2 topics with a laser scan: /rear/scan .*, /scan ") as e:
        list(RosbagLog(path))
    assert "source.scan_topic=/scan" in str(e.value)
    (one,) = RosbagLog(path, scan_topic="/rear/scan")
    assert one.scan is not None
    assert one.scan.ranges.tolist() == [9.0, 9.0, 9.0]


@both
def test_the_digest_is_that_of_the_content(ros: int, tmp_path: Path) -> None:
    made = drive(ros)
    log = RosbagLog(made.as_bag(tmp_path / "a.bag"))
    path = tmp_path / "a.bag"
    if ros == 1:
        (tmp_path / "b.bag").write_bytes(path.read_bytes())
        assert RosbagLog(str(tmp_path / "b.bag")).digest() == log.digest()
    made.label(1.1, "kitchen")
    assert RosbagLog(made.as_bag(tmp_path / "c.bag")).digest() != log.digest()
    assert RosbagLog(str(path), tolerance=0.5).digest() != log.digest()
    assert RosbagLog(str(path), distribution="foxy").digest() != log.digest()
    assert RosbagLog(str(path), parts=["image"]).digest() == log.digest()


def test_convert_and_read_again(tmp_path: Path) -> None:
    bag = RosbagLog(drive(1).as_bag(tmp_path / "run.bag"))
    out = tmp_path / "out.mcap"
    with McapWriter(out, metadata=bag.metadata) as writer:
        assert copy(bag, writer) == 12
    log = open_log(out)
    assert log.metadata == {"format": "ROS 1 bag"}
    for read, made in zip(log, bag, strict=True):
        assert (read.stamp, read.label) == (made.stamp, made.label)
        assert read.scan is not None
        assert made.scan is not None
        np.testing.assert_allclose(read.scan.points(), made.scan.points(), atol=1e-5)


def test_an_empty_bag(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"holds no image and no scan that can be read; its topics"):
        list(RosbagLog(Recording(1).as_bag(tmp_path / "empty.bag")))


def test_other_messages_are_not_in_the_way(tmp_path: Path) -> None:
    made = drive(1, images=False)
    name = "diagnostic_msgs/msg/KeyValue"
    made.add("/status", name, 0.2, made.make(name, "battery", "low"))
    log = RosbagLog(made.as_bag(tmp_path / "run.bag"))
    assert len(list(log)) == 12
    assert ("/status", "diagnostic_msgs/KeyValue") in [
        (t.name, t.schema) for t in log.file.topics()
    ]


def test_it_has_the_parameters_of_an_mcap_log() -> None:
    mcap = inspect.signature(McapLog).parameters
    bag = dict(inspect.signature(RosbagLog).parameters)
    assert bag.pop("distribution").default == "humble"
    assert {name: each.default for name, each in bag.items()} == {
        name: each.default for name, each in mcap.items()
    }
    values = {name: f"value of {name}" for name in mcap}
    log = RosbagLog(**values)  # type: ignore[arg-type]
    assert {name: getattr(log, name) for name in mcap} == values


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.bag", None, "no such bag: .*gone.bag"),
        ("text.bag", b"nothing of the kind", "neither a ROS 1 bag nor a storage file"),
        ("empty.bag", b"", "neither a ROS 1 bag nor a storage file"),
        (
            "log.bag",
            b"\x89MCAP0\r\n" + bytes(20),
            "is an MCAP log and no bag; read it with source=",
        ),
        ("base.sqlite", b"SQLite format 3\0" + bytes(90), "give it the ending .db3"),
        ("base.db3", b"SQLite format 3\0" + bytes(90), "cannot be read as a bag: "),
        ("old.bag", b"#ROSBAG V1.2\n" + bytes(90), "cannot be read as a bag: Bag version 102"),
        ("short.bag", b"#ROSBAG V2.0\n", "cannot be read as a bag: "),
    ],
)
def test_what_is_no_bag(name: str, content: bytes | None, message: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(DataError, match=message) as raised:
        list(RosbagLog(str(tmp_path / name)))
    assert "\n" not in str(raised.value)


def test_folders_that_are_no_bag(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no metadata.yaml and no .db3 file; name the folder"):
        list(RosbagLog(str(tmp_path)))
    (tmp_path / "one.bag").touch()
    with pytest.raises(DataError, match=r"name one of one\.bag"):
        list(RosbagLog(str(tmp_path)))
    for name in ("a_0.db3", "a_1.db3"):
        (tmp_path / name).touch()
    with pytest.raises(DataError, match=r"2 storage files .* name one of a_0.db3, a_1.db3, or run"):
        list(RosbagLog(str(tmp_path)))
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: 7\n")
    with pytest.raises(DataError, match="cannot be read as a bag: Invalid bag metadata"):
        list(RosbagLog(str(tmp_path)))


def test_a_distribution_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"humbel is not known; did you mean 'humble'\? a"):
        list(RosbagLog(str(tmp_path / "x"), distribution="humbel"))


REAL = [
    ("expt04.bag", 726, 255.0, 0.0),
    ("feb13_col.bag", 726, 255.0, 0.0),
    ("comprobo22/macfirst_floor_take_2", 720, 360.0, math.pi / 2),
]


@needs_data
@pytest.mark.parametrize(("name", "beams", "view", "turned"), REAL)
def test_recorded_bags(
    name: str, beams: int, view: float, turned: float, caplog: pytest.LogCaptureFixture
) -> None:
    path = Path(str(DATA), "bags", name)
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        scans = [each for each in reader.connections if each.topic == "/scan"]
        headers = []
        for connection, _, raw in reader.messages(scans):
            message: Any = reader.deserialize(raw, connection.msgtype)
            headers.append(message.header.stamp.sec * SECOND + message.header.stamp.nanosec)
    # Some messages came many seconds late over the radio.
    log = RosbagLog(str(path), window=20.0)
    with caplog.at_level(logging.WARNING):
        seen = list(log)
    assert log.count() == len(seen) == len(headers)
    assert [each.stamp for each in seen] == sorted(headers)
    for each in seen:
        assert each.scan is not None
        assert len(each.scan.ranges) == beams
        span = math.degrees(each.scan.angles[-1] - each.scan.angles[0])
        assert span == pytest.approx(view, abs=1.1)
        assert each.scan.mount.theta == pytest.approx(turned)
    told = [each.message for each in caplog.records]
    assert len([each for each in told if "recorder's clock" not in each]) <= 1
    posed = sum(each.pose is not None for each in seen)
    assert posed > 0.8 * len(seen)  # the clocks of some of them are 80 s apart from the recorder's


@needs_data
def test_recorded_walls_are_thin() -> None:
    """Laid at the poses, end points fall on each other: turned or mirrored they would not."""
    log = RosbagLog(f"{DATA}/bags/comprobo22/macfirst_floor_take_2", start=8.0, end=14.0)
    seen = [each for each in log if each.pose is not None and each.scan is not None]

    def cells(turn: float, mirror: int) -> int:
        found = set()
        for each in seen:
            assert each.scan is not None
            assert each.pose is not None
            near = each.scan.valid() & (each.scan.ranges < 6.0)
            bearing = mirror * (each.scan.angles[near] + each.scan.mount.theta) + turn
            x = each.scan.mount.x + each.scan.ranges[near] * np.cos(bearing)
            y = each.scan.mount.y + each.scan.ranges[near] * np.sin(bearing)
            c, s = math.cos(each.pose.theta), math.sin(each.pose.theta)
            at = np.column_stack([each.pose.x + c * x - s * y, each.pose.y + s * x + c * y])
            found |= set(map(tuple, np.floor(at / 0.1).astype(int)))
        return len(found)

    right = cells(0.0, 1)
    assert len(seen) > 40
    assert right < 0.8 * min(cells(math.pi / 2, 1), cells(math.pi, 1), cells(-math.pi / 2, 1))
    assert right < 0.8 * cells(0.0, -1)
