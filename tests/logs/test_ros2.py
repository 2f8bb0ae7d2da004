"""Logs of ROS 2 messages, made with mcap_ros2's writer; expected values worked by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mcap_logs import START, heading, jpeg
from placecue.errors import UnusableObservation
from placecue.logs import open_log
from placecue.observation import EncodedImage

TURNED_OVER = {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}


def test_an_image_gets_the_nearest_scan_and_an_interpolated_pose(ros2: Any) -> None:
    log = ros2()
    log.string(0.0, "office")
    log.odom(0.0, 0.0, 0.0, 0.0)
    log.scan(0.02, [1.0, 2.0, 3.0])
    log.image(0.05, jpeg())
    log.scan(0.06, [4.0, 5.0, 6.0])
    log.odom(0.2, 1.0, 2.0, 0.4)
    (observation,) = open_log(log.close())
    assert observation.stamp == START + 50_000_000
    assert observation.label == "office"
    assert observation.scan is not None
    assert observation.pose is not None
    np.testing.assert_allclose(observation.scan.ranges, [4, 5, 6])
    np.testing.assert_allclose(observation.scan.angles, [-1, -0.5, 0])
    assert (observation.scan.range_min, observation.scan.range_max) == pytest.approx((0.1, 10))
    # A quarter of the way from (0, 0, 0) to (1, 2, 0.4).
    assert (observation.pose.x, observation.pose.y) == pytest.approx((0.25, 0.5))
    assert observation.pose.theta == pytest.approx(0.1)
    assert observation.pose.frame == "odom"


def test_an_image_stays_undecoded_until_it_is_used(ros2: Any) -> None:
    log, data = ros2(), jpeg(200)
    log.image(0.0, data)
    (observation,) = open_log(log.close())
    assert isinstance(observation.image_source, EncodedImage)
    assert observation.image_source.data == data
    assert observation.image is not None
    assert observation.image.shape == (12, 16, 3)
    assert abs(int(observation.image.mean()) - 200) < 3


def test_headings_are_interpolated_the_shorter_way(ros2: Any) -> None:
    log = ros2()
    log.odom(0.0, 0.0, 0.0, math.radians(170))
    log.scan(0.1, [1.0, 2.0])
    log.odom(0.2, 0.0, 0.0, math.radians(-170))
    (observation,) = open_log(log.close())
    assert observation.pose is not None
    assert math.cos(observation.pose.theta) == pytest.approx(-1.0)


def test_poses_too_far_apart_are_not_interpolated(ros2: Any) -> None:
    log = ros2()
    log.odom(0.0, 0.0, 0.0, 0.0)
    log.scan(0.05, [1.0])
    log.scan(2.0, [1.0])
    log.odom(4.0, 9.0, 0.0, 0.0)
    near, far = open_log(log.close())
    assert near.pose is not None
    assert near.pose.x == 0.0  # the lone pose within the tolerance
    assert far.pose is None


def test_times_are_those_of_the_headers(ros2: Any) -> None:
    log = ros2()
    # The camera's messages are written 0.3 s late: by log time the image belongs to scan 2.
    log.scan(0.0, [1.0])
    log.image(0.0, jpeg(), lag=0.3)
    log.scan(0.3, [2.0])
    (observation,) = open_log(log.close())
    assert observation.stamp == START
    assert observation.scan is not None
    assert observation.scan.ranges.tolist() == [1.0]


def test_log_time_stands_in_for_a_missing_stamp(ros2: Any) -> None:
    log = ros2()
    log.scan(1.5, [1.0], stamped=False)
    (observation,) = open_log(log.close())
    assert observation.stamp == START + 1_500_000_000


def test_a_clockwise_scan_is_turned_to_increasing_angles(ros2: Any) -> None:
    log = ros2()
    log.scan(0.0, [1.0, 2.0, 3.0], first=1.0, step=-0.5)
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    np.testing.assert_allclose(observation.scan.angles, [0, 0.5, 1])
    assert observation.scan.ranges.tolist() == [3, 2, 1]


def test_invalid_ranges_are_kept(ros2: Any) -> None:
    log = ros2()
    log.scan(0.0, [math.inf, math.nan, 0.0, 2.0])
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    assert observation.scan.valid().tolist() == [False, False, False, True]
    assert math.isinf(observation.scan.ranges[0])
    assert math.isnan(observation.scan.ranges[1])


@pytest.mark.parametrize("scans", [[], [1.0]])
def test_tiny_scans_are_read(ros2: Any, scans: list[float]) -> None:
    log = ros2()
    log.scan(0.0, scans, step=0.0)
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    assert observation.scan.ranges.tolist() == scans


def test_the_laser_sits_where_the_transforms_say(ros2: Any) -> None:
    log = ros2()
    log.transform(0.0, "base_link", "mast", (0.2, 0.0, 0.5), heading(math.pi / 2))
    log.transform(0.0, "mast", "laser", (0.1, 0.0, 0.0), heading(0.0))
    log.scan(0.1, [1.0, 2.0])
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    mount = observation.scan.mount
    # The mast looks left, so 0.1 m ahead of it is 0.1 m to the left of the robot.
    assert (mount.x, mount.y, mount.theta) == pytest.approx((0.2, 0.1, math.pi / 2))
    assert mount.frame == "base_link"


def test_the_robots_frame_may_be_beside_the_laser_in_the_tree(ros2: Any) -> None:
    log = ros2()
    log.transform(0.0, "base_footprint", "base_link", (0.0, 0.0, 0.1), heading(0.0))
    log.transform(0.0, "base_footprint", "laser", (0.3, 0.0, 0.2), heading(0.0))
    log.scan(0.1, [1.0, 2.0])
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    assert observation.scan.mount.x == pytest.approx(0.3)


def test_a_laser_that_hangs_upside_down_is_turned_over(ros2: Any) -> None:
    log = ros2()
    log.transform(0.0, "base_link", "laser", (0.2, 0.0, 0.5), TURNED_OVER)
    log.scan(0.1, [1.0, 2.0, 3.0], first=-0.5, step=0.5)
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    # Its beam at -0.5 rad, of 1 m, points to the robot's left: +0.5 rad.
    np.testing.assert_allclose(observation.scan.angles, [-0.5, 0, 0.5])
    assert observation.scan.ranges.tolist() == [3, 2, 1]
    left = observation.scan.points()[-1]
    np.testing.assert_allclose(left, [0.2 + math.cos(0.5), math.sin(0.5)])


def test_a_missing_mounting_is_said_once(ros2: Any, caplog: pytest.LogCaptureFixture) -> None:
    log = ros2()
    log.transform(0.0, "base_link", "camera", (0.0, 0.0, 0.0), heading(0.0))
    log.scan(0.1, [1.0], frame="lidar")
    opened = open_log(log.close())
    (observation,) = opened
    list(opened)
    assert observation.scan is not None
    assert observation.scan.mount.x == 0.0
    assert len(caplog.records) == 1
    assert "no transform from 'base_link' to the laser's frame 'lidar'" in caplog.text
    assert "source.laser_frame" in caplog.text


def test_the_pose_may_come_from_transforms(ros2: Any) -> None:
    log = ros2()
    log.transform(0.0, "base_footprint", "base_link", (0.1, 0.0, 0.1), heading(0.0))
    quarter = heading(math.pi / 2)
    log.transform(0.0, "odom", "base_footprint", (1.0, 1.0, 0.0), quarter, topic="/tf")
    log.scan(0.1, [1.0])
    log.transform(0.2, "odom", "base_footprint", (3.0, 1.0, 0.0), quarter, topic="/tf")
    (observation,) = open_log(log.close())
    assert observation.pose is not None
    # base_link is 0.1 m ahead of base_footprint, which looks along y.
    assert (observation.pose.x, observation.pose.y) == pytest.approx((2.0, 1.1))
    assert observation.pose.theta == pytest.approx(math.pi / 2)
    assert observation.pose.frame == "odom"


@pytest.mark.parametrize("covariance", [False, True])
def test_stamped_poses(ros2: Any, covariance: bool) -> None:
    log = ros2()
    log.scan(0.0, [1.0])
    log.pose(0.0, 1.0, -2.0, 0.5, covariance=covariance)
    (observation,) = open_log(log.close())
    assert observation.pose is not None
    assert observation.pose.theta == pytest.approx(0.5)
    assert (observation.pose.x, observation.pose.y, observation.pose.frame) == (1.0, -2.0, "map")


RED, GREEN, BLUE = 10, 20, 30


@pytest.mark.parametrize(
    ("encoding", "pixel", "expected"),
    [
        ("rgb8", [RED, GREEN, BLUE], [RED, GREEN, BLUE]),
        ("bgr8", [BLUE, GREEN, RED], [RED, GREEN, BLUE]),
        ("8UC3", [BLUE, GREEN, RED], [RED, GREEN, BLUE]),
        ("rgba8", [RED, GREEN, BLUE, 255], [RED, GREEN, BLUE]),
        ("bgra8", [BLUE, GREEN, RED, 255], [RED, GREEN, BLUE]),
        ("mono8", [77], 77),
    ],
)
def test_raw_pixels(ros2: Any, encoding: str, pixel: list[int], expected: Any) -> None:
    row = bytes(pixel * 2) + b"\0\0\0"  # two pixels and padding
    log = ros2()
    log.raw(0.0, encoding, 3, 2, len(row), row * 3)
    (observation,) = open_log(log.close())
    assert observation.image is not None
    assert observation.image.shape[:2] == (3, 2)
    assert (observation.image == expected).all()


@pytest.mark.parametrize(("encoding", "size"), [("nv21", 12), ("rgb8", 5)])
def test_raw_pixels_that_make_no_sense(ros2: Any, encoding: str, size: int) -> None:
    log = ros2()
    log.raw(0.0, encoding, 2, 2, 6, bytes(size))
    (observation,) = open_log(log.close())
    with pytest.raises(UnusableObservation, match=encoding):
        _ = observation.image


def test_labels_hold_until_the_next_and_an_empty_one_ends_them(ros2: Any) -> None:
    log = ros2()
    log.scan(0.0, [1.0])
    log.string(0.5, "office")
    log.scan(1.0, [1.0])
    log.scan(2.0, [1.0])
    log.string(2.5, "")
    log.scan(3.0, [1.0])
    assert [each.label for each in open_log(log.close())] == [None, "office", "office", None]


def test_a_part_of_the_log(small_log: str) -> None:
    some = list(open_log(small_log, start=0.5, end=1.2))
    assert [each.stamp - START for each in some] == [i * 100_000_000 for i in range(5, 12)]
    # The label that was given before the part begins still holds.
    assert some[0].label == "corridor"
    assert some[-1].label == "office"


def test_only_the_wanted_parts_are_read(small_log: str) -> None:
    for observation in open_log(small_log, parts=["scan", "label"]):
        assert observation.pose is None
        assert observation.label is not None


def test_the_same_file_gives_the_same_digest_and_other_options_another(small_log: str) -> None:
    import hashlib
    from pathlib import Path

    plain = open_log(small_log).digest()
    assert plain == hashlib.sha256(Path(small_log).read_bytes()).hexdigest()
    assert plain == open_log(small_log, tolerance=0.1).digest()
    assert plain != open_log(small_log, tolerance=0.2).digest()
    assert plain == open_log(small_log, parts=["scan"]).digest()


def test_a_log_can_be_read_again_and_knows_its_length(small_log: str) -> None:
    log = open_log(small_log)
    assert log.count() == 20
    assert [each.stamp for each in log] == [each.stamp for each in log]
    assert log.name == "small.mcap"


def test_a_message_that_does_not_decode_is_counted(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    log.scan(0.0, [1.0])
    schema = log.schemas["sensor_msgs/msg/LaserScan"]
    log.writer._encoders[schema.id] = lambda message: message
    log.writer.write_message("/scan", schema, b"\x00\x01\x00\x00" + bytes(10), START + 5, START + 5)
    log.writer.write_message("/scan", schema, b"", START + 6, START + 6)
    opened = open_log(log.close())
    assert len(list(opened)) == 1
    assert len(list(opened)) == 1
    assert len(caplog.records) == 1
    assert "2 messages could not be used (the first: a message of /scan at" in caplog.text
