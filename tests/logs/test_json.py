"""Logs of Foxglove JSON messages, made with mcap's writer."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import numpy as np
import pytest

from mcap_logs import START, heading, jpeg
from placecue.logs import open_log


def put_pose(log: Any, t: float, x: float) -> None:
    pose = {"position": {"x": x, "y": 0, "z": 0}, "orientation": heading(0.5)}
    message = {"timestamp": log.time(t), "frame_id": "map", "pose": pose}
    log.put("/pose", "foxglove.PoseInFrame", message, t)


def test_image_scan_pose_and_label(as_json: Any) -> None:
    log, data = as_json(), jpeg(90)
    log.put("/label", "placecue.Label", {"stamp": START, "label": "kitchen"}, 0.0)
    put_pose(log, 0.0, 0.0)
    image = {
        "timestamp": log.time(0.1),
        "frame_id": "cam",
        "format": "jpeg",
        "data": b64encode(data).decode(),
    }
    log.put("/image", "foxglove.CompressedImage", image, 0.1)
    log.scan(0.15, [1.0, None, "Infinity", "NaN", 0.1 + 0.2], range_min=0.05, range_max=8.0)
    put_pose(log, 0.4, 4.0)
    (observation,) = open_log(log.close())
    assert observation.stamp == START + 100_000_000
    assert observation.label == "kitchen"
    assert observation.image_source.data == data  # type: ignore[union-attr]
    assert observation.pose is not None
    assert observation.pose.x == pytest.approx(1.0)
    assert observation.pose.theta == pytest.approx(0.5)
    assert observation.scan is not None
    np.testing.assert_array_equal(observation.scan.ranges, [1.0, np.nan, np.inf, np.nan, 0.1 + 0.2])
    np.testing.assert_allclose(observation.scan.angles, [-1, -0.5, 0, 0.5, 1])
    assert (observation.scan.range_min, observation.scan.range_max) == (0.05, 8.0)


def test_a_scan_that_does_not_say_its_limit_gets_the_given_one(as_json: Any) -> None:
    log = as_json()
    log.scan(0.0, [1.0, 9.0])
    path = log.close()
    (observation,) = open_log(path, range_max=5.0)
    assert observation.scan is not None
    assert observation.scan.range_max == 5.0
    assert observation.scan.valid().tolist() == [True, False]


def test_the_scans_own_pose_and_the_transforms_are_joined(as_json: Any) -> None:
    log = as_json()
    transform = {
        "timestamp": log.time(0.0),
        "parent_frame_id": "base_link",
        "child_frame_id": "laser",
        "translation": {"x": 0.5, "y": 0.0, "z": 0.0},
        "rotation": heading(np.pi / 2),
    }
    log.put("/tf", "foxglove.FrameTransforms", {"transforms": [transform]}, 0.0)
    own = {"position": {"x": 0.1, "y": 0.0, "z": 0.0}, "orientation": heading(0.25)}
    log.scan(0.0, [1.0, 2.0], pose=own)
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    mount = observation.scan.mount
    assert (mount.x, mount.y, mount.theta) == pytest.approx((0.5, 0.1, np.pi / 2 + 0.25))


def test_raw_pixels(as_json: Any) -> None:
    log = as_json()
    image = {
        "timestamp": log.time(0.0),
        "frame_id": "cam",
        "width": 2,
        "height": 1,
        "encoding": "rgb8",
        "step": 6,
        "data": b64encode(bytes([1, 2, 3, 4, 5, 6])).decode(),
    }
    log.put("/image", "foxglove.RawImage", image, 0.0)
    (observation,) = open_log(log.close())
    assert observation.image is not None
    assert observation.image.tolist() == [[[1, 2, 3], [4, 5, 6]]]


@pytest.mark.parametrize("broken", [b"{", b"[]", b'{"timestamp":{"sec":1}}', b"\xff\xfe"])
def test_broken_messages_are_counted(
    as_json: Any, broken: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json()
    log.scan(0.0, [1.0])
    log.put("/scan", "foxglove.LaserScan", broken, 0.1)
    log.scan(0.2, [1.0])
    assert len(list(open_log(log.close()))) == 2
    assert "1 messages could not be used" in caplog.text


def test_a_time_in_words_is_told(as_json: Any, caplog: pytest.LogCaptureFixture) -> None:
    log = as_json()
    log.scan(0.0, [1.0])
    log.scan(0.1, [1.0], timestamp="2023-11-14T22:13:20Z")
    assert len(list(open_log(log.close()))) == 1
    assert "the text '2023-11-14T22:13:20Z', where sec and nsec are due" in caplog.text
