"""ROS 1 messages in MCAP, serialised by rosbags; expected values worked by hand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mcap_logs import START, jpeg
from placecue.errors import DataError
from placecue.logs import open_log
from placecue.observation import EncodedImage
from ros1_logs import Ros1Log


@pytest.fixture
def ros1(tmp_path: Path) -> Any:
    return lambda **options: Ros1Log(tmp_path / "ros1.mcap", **options)


def test_an_observation(ros1: Any) -> None:
    log, picture = ros1(), jpeg(90)
    log.string(0.0, "kitchen")
    log.odom(0.0, 0.0, 0.0, 0.0)
    log.image(0.05, picture)
    log.scan(0.06, [1.0, 2.0, math.inf])
    log.odom(0.1, 1.0, 2.0, 0.4)
    (observation,) = open_log(log.close())
    assert observation.stamp == START + 50_000_000
    assert observation.label == "kitchen"
    assert isinstance(observation.image_source, EncodedImage)
    assert observation.image_source.data == picture
    assert observation.scan is not None
    assert observation.pose is not None
    np.testing.assert_array_equal(observation.scan.ranges, [1, 2, math.inf])
    np.testing.assert_allclose(observation.scan.angles, [-1, -0.5, 0])
    assert observation.scan.range_max == 10.0
    assert (observation.pose.x, observation.pose.y) == pytest.approx((0.5, 1.0))
    assert observation.pose.theta == pytest.approx(0.2)


def test_a_laser_that_hangs_upside_down_and_is_turned(ros1: Any) -> None:
    log = ros1()
    # Turned over about its x axis and then looking left: a half turn about x = y.
    half = math.sqrt(0.5)
    log.mounting(0.0, 0.3, {"x": half, "y": half, "z": 0.0, "w": 0.0})
    log.scan(0.0, [1.0, 2.0, 4.0], first=0.0)
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    # Its beam straight ahead, of 1 m, points to the robot's left; its left is the robot's ahead.
    np.testing.assert_allclose(observation.scan.points()[-1], [0.3, 1.0], atol=1e-12)
    ahead = [0.3 + 2 * math.sin(0.5), 2 * math.cos(0.5)]
    np.testing.assert_allclose(observation.scan.points()[1], ahead, atol=1e-6)


def test_raw_images(ros1: Any) -> None:
    log, pixels = ros1(), np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    log.raw(0.0, "bgr8", pixels)
    (observation,) = open_log(log.close())
    np.testing.assert_array_equal(observation.image, pixels[:, :, ::-1])


def test_static_transforms_are_read_before_seeking(ros1: Any) -> None:
    log = ros1(chunk_size=200)
    log.mounting(0.0, 0.3, {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0})
    for i in range(40):
        log.scan(i, [1.0, 2.0])
    late = list(open_log(log.close(), start=30.0))
    assert len(late) == 10
    assert {each.scan.mount.x for each in late if each.scan} == {0.3}


def test_a_definition_of_ones_own_is_named_and_nothing_of_it_is_run(ros1: Any) -> None:
    log = ros1()
    schema = log.writer.register_schema("sensor_msgs/LaserScan", "ros1msg", b"float32 x\n")
    channel = log.writer.register_channel("/scan", "ros1", schema)
    log.writer.add_message(channel, 1, b"1234", 1)
    with pytest.raises(DataError, match=r"not the definition that ROS itself has"):
        list(open_log(log.close()))
