"""Choosing topics, and what is said where that is not clear."""

from __future__ import annotations

from typing import Any

import pytest

from mcap_logs import jpeg
from placecue.errors import DataError, UsageError
from placecue.logs import McapLog, open_log
from placecue.logs.info import summarise


@pytest.fixture
def two_scanners(ros2: Any) -> str:
    log = ros2("two.mcap")
    for i in range(3):
        log.scan(i * 0.1, [1.0], topic="/front/scan")
        log.odom(i * 0.1, 0.0, 0.0, 0.0)
    log.scan(0.0, [2.0], topic="/rear/scan")
    return log.close()


def test_several_candidates_are_listed_with_the_override(two_scanners: str) -> None:
    with pytest.raises(UsageError) as caught:
        open_log(two_scanners)
    text = str(caught.value)
    assert "2 topics with a laser scan" in text
    assert "/front/scan (sensor_msgs/msg/LaserScan, 3 messages)" in text
    assert "/rear/scan (sensor_msgs/msg/LaserScan, 1 messages)" in text
    assert "source.scan_topic=/front/scan" in text
    assert "\n" not in text


def test_a_named_topic_is_taken(two_scanners: str) -> None:
    (observation,) = open_log(two_scanners, scan_topic="/rear/scan")
    assert observation.scan is not None
    assert observation.scan.ranges.tolist() == [2.0]


def test_a_part_that_is_not_wanted_is_not_asked_about(ros2: Any) -> None:
    log = ros2()
    log.image(0.0, jpeg(), topic="/left")
    log.image(0.0, jpeg(), topic="/right")
    log.scan(0.0, [1.0])
    path = log.close()
    assert len(list(open_log(path, parts=["scan"]))) == 1
    with pytest.raises(UsageError, match=r"source\.image_topic=/left"):
        open_log(path)


def test_a_topic_that_is_not_there(two_scanners: str) -> None:
    with pytest.raises(UsageError, match=r"no such topic .* did you mean '/rear/scan'"):
        open_log(two_scanners, scan_topic="/rear/scans")


def test_a_topic_of_another_kind(two_scanners: str) -> None:
    with pytest.raises(UsageError, match=r"nav_msgs/msg/Odometry\) cannot give a laser scan"):
        open_log(two_scanners, scan_topic="/odom")


def test_odometry_and_another_pose_must_be_chosen_between(ros2: Any) -> None:
    log = ros2()
    log.scan(0.0, [1.0])
    log.odom(0.0, 1.0, 0.0, 0.0)
    log.pose(0.0, 2.0, 0.0, 0.0, covariance=True)
    path = log.close()
    with pytest.raises(UsageError, match=r"source\.pose_topic="):
        open_log(path)
    (observation,) = open_log(path, pose_topic="/where")
    assert observation.pose is not None
    assert observation.pose.x == 2.0


def test_a_pose_in_the_cameras_frame_does_not_rival_odometry(ros2: Any) -> None:
    log = ros2()
    log.scan(0.0, [1.0])
    log.odom(0.0, 1.0, 0.0, 0.0)
    log.pose(0.0, 2.0, 0.0, 0.0, covariance=True, frame="camera_link")
    (observation,) = open_log(log.close())
    assert observation.pose is not None
    assert observation.pose.x == 1.0


def test_strings_are_labels_only_where_the_name_says_so(ros2: Any) -> None:
    log = ros2()
    log.string(0.0, "<robot/>", topic="/robot_description")
    log.scan(0.1, [1.0])
    path = log.close()
    assert next(iter(open_log(path))).label is None
    assert next(iter(open_log(path, label_topic="/robot_description"))).label == "<robot/>"


def test_a_log_with_nothing_to_see(ros2: Any) -> None:
    log = ros2()
    log.odom(0.0, 0.0, 0.0, 0.0)
    with pytest.raises(DataError, match=r"no image and no scan .*/odom \(cdr nav_msgs"):
        open_log(log.close())


def test_an_unreadable_encoding_is_named(as_json: Any) -> None:
    log = as_json()
    schema = log.writer.register_schema("sensor_msgs/msg/LaserScan", "ros2idl", b"struct A {};")
    channel = log.writer.register_channel("/scan", "cdr", schema)
    log.writer.add_message(channel, 1, b"1234", 1)
    with pytest.raises(DataError, match="ros2idl"):
        list(open_log(log.close()))


@pytest.mark.parametrize("parts", [["scans"], ["pose", "label"]])
def test_parts_that_make_no_observation(small_log: str, parts: list[str]) -> None:
    with pytest.raises(UsageError, match=r"source\.parts"):
        open_log(small_log, parts=parts)


def test_an_option_that_is_not_known(small_log: str) -> None:
    with pytest.raises(UsageError, match="no option topic; it has: image_topic"):
        open_log(small_log, topic="/scan")


def test_summary_of_a_log(small_log: str) -> None:
    summary = summarise(McapLog(small_log))
    assert summary.duration == pytest.approx(1.9)
    assert (summary.whole, summary.indexed, summary.observations) == (True, True, 20)
    assert dict(summary.labels) == {"corridor": 10, "office": 10}
    by_name = {topic.name: topic for topic in summary.topics}
    assert by_name["/scan"].count == 20
    assert by_name["/scan"].rate == pytest.approx(20 / 1.9)
    assert by_name["/scan"].used
    assert by_name["/scan"].gap is not None
    assert by_name["/scan"].gap.seconds == pytest.approx(0.1)
    assert summary.coverage == 1.0
    assert [x for x, _, _ in summary.trail] == list(range(20))
    assert {part.part: part.topics for part in summary.parts} == {
        "image": (),
        "scan": ("/scan",),
        "pose": ("/odom",),
        "label": ("/label",),
    }
    assert summary.problem is None


def test_summary_of_a_log_that_needs_a_choice(two_scanners: str) -> None:
    summary = summarise(McapLog(two_scanners))
    scan = next(part for part in summary.parts if part.part == "scan")
    assert not scan.clear
    assert "source.scan_topic=/front/scan" in scan.reason
    assert summary.problem is not None


def test_the_log_is_not_opened_before_it_is_used() -> None:
    assert McapLog("/nowhere/at/all.mcap").path == "/nowhere/at/all.mcap"
