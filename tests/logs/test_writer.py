"""What placecue writes: read back by placecue, and by the plain mcap and mcap_ros2 readers."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2._dynamic import generate_dynamic

from mcap_logs import DEFINITIONS, START, jpeg, json_messages, scan_of, walk
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.logs import open_log
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage, LaserScan, Observation, Pose2D
from placecue.source import Source

ENCODINGS = ("cdr", "json")


def written(path: Path, observations: list[Observation], **options: Any) -> str:
    with McapWriter(path, **options) as writer:
        for observation in observations:
            writer.write(observation)
    return str(path)


class Given(Source):
    """Observations from a list."""

    name = "given"

    def __init__(self, observations: list[Observation]) -> None:
        self.observations = observations

    def __iter__(self) -> Any:
        return iter(self.observations)

    def digest(self) -> str:
        return "given"


class Faulty(Observation):
    """Fails where nobody expects it."""

    def __init__(self) -> None:
        super().__init__(1)

    @property
    def image_source(self) -> Any:  # type: ignore[override]
        return 1 / 0

    @image_source.setter
    def image_source(self, value: Any) -> None:
        pass


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_what_is_written_is_read(tmp_path: Path, encoding: str, compression: str) -> None:
    before = walk()
    path = written(tmp_path / "a.mcap", before, encoding=encoding, compression=compression)
    after = list(open_log(path))
    assert [each.stamp for each in after] == [each.stamp for each in before]
    assert [each.label for each in after] == [each.label for each in before]
    for old, new in zip(before, after, strict=True):
        assert isinstance(old.image_source, EncodedImage)
        assert isinstance(new.image_source, EncodedImage)
        assert new.image_source.data == old.image_source.data
        assert old.pose is not None
        assert new.pose is not None
        assert (new.pose.x, new.pose.y, new.pose.frame) == (old.pose.x, old.pose.y, "odom")
        assert new.pose.theta == pytest.approx(old.pose.theta, abs=1e-14)
        assert old.scan is not None
        assert new.scan is not None
        np.testing.assert_array_equal(new.scan.ranges, old.scan.ranges)
        np.testing.assert_allclose(new.scan.angles, old.scan.angles, atol=1e-6)
        assert new.scan.mount.x == old.scan.mount.x
        assert new.scan.mount.theta == pytest.approx(old.scan.mount.theta, abs=1e-14)


@settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    ranges=st.lists(st.floats(allow_nan=True, allow_infinity=True, width=64), max_size=8),
    x=st.floats(-1e6, 1e6),
    theta=st.floats(-20, 20),
    stamp=st.integers(0, 2**31 * 10**9 - 1),
    encoding=st.sampled_from(ENCODINGS),
)
def test_any_scan_and_pose_come_back(
    tmp_path: Path, ranges: list[float], x: float, theta: float, stamp: int, encoding: str
) -> None:
    observation = Observation(stamp, scan=scan_of(ranges), pose=Pose2D(x, 0.0, theta))
    path = written(tmp_path / "a.mcap", [observation], encoding=encoding)
    (back,) = open_log(path)
    with np.errstate(over="ignore"):
        exact = np.array(ranges, dtype=np.float32 if encoding == "cdr" else np.float64)
    assert back.stamp == stamp
    assert back.scan is not None
    assert back.pose is not None
    np.testing.assert_array_equal(back.scan.ranges, exact)
    assert back.pose.x == x
    assert math.remainder(back.pose.theta - theta, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_ros2_tools_can_read_it(tmp_path: Path) -> None:
    """Each message decodes by ROS 2's own definitions, typed out in the tests."""
    path = written(tmp_path / "a.mcap", walk(1) + walk(2)[1:], metadata={"run": "1"})
    found: dict[str, Any] = {}
    with Path(path).open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "ros2"
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            assert (channel.message_encoding, schema.encoding) == ("cdr", "ros2msg")
            decode = generate_dynamic(schema.name, DEFINITIONS[schema.name])[schema.name]
            found[channel.topic] = decode(message.data)
        assert [(each.name, each.metadata) for each in reader.iter_metadata()] == [
            ("placecue", {"run": "1"})
        ]
    scan, odometry, image = found["/scan"], found["/odom"], found["/camera/image/compressed"]
    assert scan.header.frame_id == "laser"
    assert (scan.header.stamp.sec, scan.header.stamp.nanosec) == (1_700_000_000, 200_000_001)
    assert scan.angle_min == pytest.approx(-1.5)
    assert scan.angle_max == pytest.approx(1.5)
    assert scan.angle_increment == pytest.approx(0.75)
    assert scan.range_max == 32.0
    assert scan.ranges[:2] == [2.0, 2.0]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    assert odometry.pose.pose.position.x == 0.1
    assert odometry.pose.pose.orientation.w == pytest.approx(math.cos(-0.35))
    assert (image.format, image.data) == ("jpeg", jpeg(20))
    moved, mounted = found["/tf"].transforms[0], found["/tf_static"].transforms[0]
    assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")
    assert (mounted.header.frame_id, mounted.child_frame_id) == ("base_link", "laser")
    assert mounted.transform.translation.y == -0.5
    assert found["/label"].data == "office"


def test_json_messages_fit_their_schemas(tmp_path: Path) -> None:
    messages = json_messages(written(tmp_path / "a.mcap", walk(), encoding="json"))
    assert {name for _, name, _ in messages} == {
        "foxglove.CompressedImage",
        "foxglove.LaserScan",
        "foxglove.PoseInFrame",
        "foxglove.FrameTransform",
        "placecue.Label",
    }
    labels = [value["label"] for _, name, value in messages if name == "placecue.Label"]
    assert labels == ["office", "corridor", "", "lab"]  # only where the label changes


@pytest.mark.parametrize(("format", "worst"), [("png", 0), ("jpeg", 12)])
@pytest.mark.parametrize("shape", [(20, 30, 3), (20, 30)])
def test_decoded_images_are_encoded(
    tmp_path: Path, format: str, worst: int, shape: tuple[int, ...]
) -> None:
    image = np.zeros(shape, np.uint8)
    image[...] = [200, 100, 50] if len(shape) == 3 else 120
    path = written(tmp_path / "a.mcap", [Observation(1, image=image)], image_format=format)
    (back,) = open_log(path)
    assert back.image is not None
    assert back.image.shape == shape
    assert np.abs(back.image.astype(int) - image).max() <= worst


def test_a_failed_run_leaves_nothing_behind(tmp_path: Path) -> None:
    old = tmp_path / "a.mcap"
    old.write_bytes(b"what was there before")
    with pytest.raises(ZeroDivisionError), McapWriter(old) as writer:
        copy(Given([walk()[0], Faulty()]), writer)
    assert old.read_bytes() == b"what was there before"
    assert list(tmp_path.iterdir()) == [old]


def test_the_file_is_not_there_before_it_is_whole(tmp_path: Path) -> None:
    with McapWriter(tmp_path / "new" / "a.mcap") as writer:
        writer.write(walk()[0])
        assert not (tmp_path / "new" / "a.mcap").exists()
    assert [each.name for each in (tmp_path / "new").iterdir()] == ["a.mcap"]


def test_a_place_that_cannot_be_written_to(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match=r"cannot write .*; choose another place with out="):
        McapWriter(tmp_path / "file" / "a.mcap")
    with pytest.raises(UsageError, match="it is a folder"):
        McapWriter(tmp_path)


@pytest.mark.parametrize(
    "option", [{"encoding": "xml"}, {"compression": "zip"}, {"image_format": "bmp"}]
)
def test_an_unknown_option(tmp_path: Path, option: dict[str, str]) -> None:
    with pytest.raises(UsageError, match="unknown"):
        McapWriter(tmp_path / "a.mcap", **option)  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []


uneven = LaserScan(np.array([0.0, 0.1, 0.5]), np.ones(3), 0.0, 9.0)


@pytest.mark.parametrize(
    ("observation", "said"),
    [
        (Observation(-1, scan=scan_of([1.0])), "1970"),
        (Observation(1, scan=uneven), "not evenly spaced"),
        (Observation(1, scan=scan_of([1.0]), pose=Pose2D(math.nan, 0, 0)), "not finite"),
        (Observation(1, image=EncodedImage(b"").__call__), "does not decode"),
    ],
)
def test_what_cannot_be_written_leaves_no_part(
    tmp_path: Path, observation: Observation, said: str
) -> None:
    with McapWriter(tmp_path / "a.mcap") as writer:
        with pytest.raises(UnusableObservation, match=said):
            writer.write(observation)
        writer.write(Observation(2, scan=scan_of([1.0])))
    with (tmp_path / "a.mcap").open("rb") as file:
        times = {message.log_time for _, _, message in make_reader(file).iter_messages()}
    assert times == {2}


def test_copy_counts_what_it_leaves_out(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    source = Given([*walk(), Observation(START + 10**10, scan=uneven)])
    with McapWriter(tmp_path / "a.mcap") as writer:
        assert copy(source, writer) == 6
    assert "1 of 7 observations passed over" in caplog.text
    assert len(list(open_log(tmp_path / "a.mcap"))) == 6


def test_copy_of_nothing(tmp_path: Path) -> None:
    with (
        pytest.raises(DataError, match="given holds no observation"),
        McapWriter(tmp_path / "a.mcap") as writer,
    ):
        copy(Given([]), writer)
    assert list(tmp_path.iterdir()) == []


def test_conditions_of_the_recording_come_along(tmp_path: Path) -> None:
    first = written(tmp_path / "a.mcap", walk(), metadata={"illumination": "night"})
    log = open_log(first)
    assert dict(log.metadata) == {"illumination": "night"}
    with McapWriter(tmp_path / "b.mcap", metadata=log.metadata) as writer:
        copy(log, writer)
    assert dict(open_log(tmp_path / "b.mcap").metadata) == {"illumination": "night"}
