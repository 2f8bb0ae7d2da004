"""Foxglove messages in protobuf and JSON, written by foxglove-sdk and mcap-protobuf-support."""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mcap_logs import START, heading, jpeg
from placecue.errors import UnusableObservation
from placecue.logs import open_log
from placecue.observation import EncodedImage

foxglove = pytest.importorskip("foxglove", reason="needs foxglove-sdk (development dependency)")

from foxglove import messages as fox  # noqa: E402

LATER = 100_000_000


def time(t: int = START) -> Any:
    return fox.Timestamp(t // 10**9, t % 10**9)


def pose(x: float, y: float, theta: float) -> Any:
    return fox.Pose(
        position=fox.Vector3(x=x, y=y, z=0.0), orientation=fox.Quaternion(**heading(theta))
    )


class ProtobufLog:
    """Writes foxglove's protobuf messages; a context manager."""

    def __init__(self, path: Path) -> None:
        self.context = foxglove.Context()
        self.writer = foxglove.open_mcap(path, context=self.context)
        self.channels: dict[str, Any] = {}

    def put(self, topic: str, message: Any, t: int = START) -> None:
        if topic not in self.channels:
            kind = getattr(foxglove.channels, f"{type(message).__name__}Channel")
            self.channels[topic] = kind(topic, context=self.context)
        self.channels[topic].log(message, log_time=t)

    def __enter__(self) -> ProtobufLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.close()


def laser(t: int = START) -> Any:
    return fox.LaserScan(
        timestamp=time(t),
        frame_id="laser",
        pose=pose(0.1, 0.0, 0.0),
        start_angle=-1.0,
        end_angle=1.0,
        ranges=[1.0, math.nan, math.inf, 4.0, 5.0],
        intensities=[],
    )


def test_protobuf(tmp_path: Path) -> None:
    path, picture = tmp_path / "proto.mcap", jpeg(70)
    with ProtobufLog(path) as log:
        image = fox.CompressedImage(timestamp=time(), frame_id="cam", data=picture, format="jpeg")
        mounted = fox.FrameTransform(
            timestamp=time(),
            parent_frame_id="base_link",
            child_frame_id="laser",
            translation=fox.Vector3(x=0.2, y=0.0, z=0.3),
            rotation=fox.Quaternion(**heading(math.pi / 2)),
        )
        log.put("/tf_static", fox.FrameTransforms(transforms=[mounted]))
        log.put("/image", image)
        log.put("/scan", laser(START + 1000))
        place = fox.PoseInFrame(timestamp=time(), frame_id="map", pose=pose(1.0, -2.0, 0.5))
        log.put("/pose", place)
    (observation,) = open_log(path)
    assert observation.stamp == START
    assert isinstance(observation.image_source, EncodedImage)
    assert observation.image_source.data == picture
    assert observation.pose is not None
    assert observation.scan is not None
    assert (observation.pose.x, observation.pose.y, observation.pose.frame) == (1.0, -2.0, "map")
    assert observation.pose.theta == pytest.approx(0.5)
    np.testing.assert_allclose(observation.scan.angles, [-1, -0.5, 0, 0.5, 1])
    np.testing.assert_array_equal(observation.scan.ranges, [1, math.nan, math.inf, 4, 5])
    # The scanner looks left, so 0.1 m ahead of it is 0.1 m to the left of the robot.
    mount = observation.scan.mount
    assert (mount.x, mount.y, mount.theta) == pytest.approx((0.2, 0.1, math.pi / 2))
    assert observation.scan.range_max == 30.0


def test_raw_images_in_protobuf(tmp_path: Path) -> None:
    path, pixels = tmp_path / "raw.mcap", np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    with ProtobufLog(path) as log:
        image = fox.RawImage(
            timestamp=time(),
            frame_id="cam",
            width=4,
            height=2,
            encoding="rgb8",
            step=12,
            data=pixels.tobytes(),
        )
        log.put("/image", image)
    (observation,) = open_log(path)
    np.testing.assert_array_equal(observation.image, pixels)


def test_a_depth_image_is_no_camera_image(tmp_path: Path) -> None:
    """Intrinsics from CameraCalibration; a wall 2 m ahead is 2 m / cos(angle) away."""
    path = tmp_path / "depth.mcap"
    depth = np.full((40, 60), 2000, np.uint16)
    with ProtobufLog(path) as log:
        image = fox.RawImage(
            timestamp=time(),
            frame_id="depth",
            width=60,
            height=40,
            encoding="16UC1",
            step=120,
            data=depth.tobytes(),
        )
        log.put("/depth/image", image)
        camera = fox.CameraCalibration(
            timestamp=time(),
            frame_id="depth",
            width=60,
            height=40,
            distortion_model="",
            D=[],
            K=[30.0, 0, 29.5, 0, 30.0, 19.5, 0, 0, 1],
            R=[],
            P=[],
        )
        log.put("/depth/calibration", camera)
    log = open_log(path)
    assert log.choices["image"].topics == ()
    (observation,) = log
    scan = observation.scan
    assert scan is not None
    assert np.rad2deg(scan.angles[[0, -1]]) == pytest.approx([-44.5, 44.5])
    np.testing.assert_allclose(scan.ranges * np.cos(scan.angles), 2.0, rtol=0.02)
    named = open_log(path, parts=["scan"], scan_topic="/depth/image")
    assert len(list(named)) == 1


def test_json(tmp_path: Path) -> None:
    path, picture = tmp_path / "json.mcap", jpeg(70)
    context = foxglove.Context()
    writer = foxglove.open_mcap(path, context=context)
    stamp = {"sec": START // 10**9, "nsec": 0}

    def put(topic: str, name: str, message: dict[str, Any]) -> None:
        schema = foxglove.Schema(name=name, encoding="jsonschema", data=b'{"type":"object"}')
        channel = foxglove.Channel(topic, message_encoding="json", schema=schema, context=context)
        channel.log(json.dumps({"timestamp": stamp, **message}).encode(), log_time=START)

    data = base64.b64encode(picture).decode()
    put("/image", "foxglove.CompressedImage", {"frame_id": "c", "format": "jpeg", "data": data})
    place = {"position": {"x": 1.0, "y": 2.0, "z": 0.0}, "orientation": heading(0.25)}
    put("/pose", "foxglove.PoseInFrame", {"frame_id": "map", "pose": place})
    writer.close()
    (observation,) = open_log(path)
    assert observation.pose is not None
    assert (observation.pose.x, observation.pose.y) == (1.0, 2.0)
    assert observation.pose.theta == pytest.approx(0.25)
    assert isinstance(observation.image_source, EncodedImage)
    assert observation.image_source.data == picture


def test_several_channels_on_one_topic(tmp_path: Path) -> None:
    """Two publishers of one schema are one topic; of two encodings, the one named is asked for."""
    path = tmp_path / "two.mcap"
    with ProtobufLog(path) as log:
        log.put("/scan", laser())
        other = foxglove.channels.LaserScanChannel(
            "/scan", context=log.context, metadata={"by": "b"}
        )
        other.log(laser(START + LATER), log_time=START + LATER)
    assert [each.stamp for each in open_log(path)] == [START, START + LATER]


def test_a_damaged_message_is_counted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "damaged.mcap"
    with ProtobufLog(path) as log:
        log.put("/scan", laser())
        channel = foxglove.Channel(
            "/scan",
            message_encoding="protobuf",
            schema=fox.LaserScan.get_schema(),
            context=log.context,
        )
        channel.log(b"\xff\xff\xff", log_time=START + 1)
    assert len(list(open_log(path))) == 1
    (record,) = caplog.records
    assert "1 messages could not be used" in record.message


@pytest.mark.parametrize("encoding", ["16UC1", "32FC1"])
def test_depth_asked_for_as_the_camera_is_an_error(tmp_path: Path, encoding: str) -> None:
    from placecue.logs.messages.images import RawImage

    with pytest.raises(UnusableObservation, match="is a depth image and no picture"):
        RawImage(bytes(32), 2, 2, 0, encoding)()
