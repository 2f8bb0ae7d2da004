"""Poses and mountings by frame, out of logs of which every transform is known."""

from __future__ import annotations

import math
from typing import Any

import pytest

from bags import Recording
from mcap_logs import DEFINITIONS, START, heading, jpeg
from placecue.errors import DataError, UsageError
from placecue.logs import McapLog, open_log
from placecue.logs.info import summarise
from placecue.logs.joining.transforms import TransformBuffer
from placecue.logs.messages.geometry import NO_TURN, Transform
from placecue.logs.rosbag import RosbagLog

HALF_OVER = {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}
NOTHING = dict.fromkeys("xyzw", math.nan)
LEVEL = heading(0.0)


def localised(
    ros2: Any, odom: str = "odom", base: str = "base_link", every: int = 1, space: str = ""
) -> Any:
    """Four seconds at 10 Hz: the robot is at 0.1 i in odom, and odom at 5 + 0.2 i in map."""
    log = ros2()
    for i in range(40):
        t = 0.1 * i
        log.transform(t, odom, base, (0.1 * i, 0.0, 0.0), LEVEL, topic=f"{space}/tf")
        if i % every == 0:
            log.transform(t, "map", odom, (5 + 0.2 * i, 0.0, 0.0), LEVEL, topic=f"{space}/tf")
        log.scan(t, [1.0])
    return log


def xs(path: str, **options: Any) -> list[float | None]:
    return [None if o.pose is None else o.pose.x for o in open_log(path, **options)]


@pytest.mark.parametrize(
    ("odom", "base", "options"),
    [
        ("odom", "base_link", {}),
        ("odom", "base_link", {"pose_frame": "map"}),
        ("/odom", "/base_footprint", {"pose_frame": "/map"}),
        ("robot1/odom", "robot1/base_link", {}),
        ("robot1/odom", "robot1/base_link", {"base_frame": "base_link"}),
        ("odom", "chassis", {"base_frame": "chassis"}),
    ],
)
def test_two_moving_transforms_are_joined_at_each_time(
    ros2: Any, odom: str, base: str, options: dict[str, str]
) -> None:
    path = localised(ros2, odom, base).close()
    assert xs(path, **options) == pytest.approx([5 + 0.3 * i for i in range(40)])
    assert next(iter(open_log(path, **options))).pose.frame == "map"  # type: ignore[union-attr]


def test_another_fixed_frame_may_be_asked_for(ros2: Any) -> None:
    path = localised(ros2).close()
    assert xs(path, pose_frame="odom") == pytest.approx([0.1 * i for i in range(40)])
    with pytest.raises(DataError, match=r"pose_frame=moon .*above it: odom, map"):
        list(open_log(path, pose_frame="moon"))


def test_a_slow_transform_is_interpolated(ros2: Any) -> None:
    path = localised(ros2, every=5).close()  # 2 Hz
    assert xs(path)[:36] == pytest.approx([5 + 0.3 * i for i in range(36)])


def test_a_transform_that_comes_once_holds(ros2: Any, caplog: pytest.LogCaptureFixture) -> None:
    path = localised(ros2, every=100).close()
    assert xs(path) == pytest.approx([5 + 0.1 * i for i in range(40)])
    assert "transforms come seldom of 'map' to 'odom'" in caplog.text


def test_transforms_that_begin_late(ros2: Any, caplog: pytest.LogCaptureFixture) -> None:
    log = ros2()
    log.transform(0.0, "base_link", "laser", (0.2, 0.0, 0.0), LEVEL)
    for i in range(160):
        if i >= 60:
            log.transform(0.2 * i, "odom", "base_link", (i, 0.0, 0.0), LEVEL, topic="/tf")
        log.scan(0.2 * i, [1.0])
    assert xs(log.close()) == [None] * 60 + [float(i) for i in range(60, 160)]
    assert "from 12.0 s after" in caplog.text


def test_a_message_at_log_time_zero_changes_nothing(ros2: Any) -> None:
    log = ros2()
    schema = log.writer.register_msgdef("std_msgs/msg/String", "string data")
    log.writer.write_message("/status", schema, {"data": "up"}, 0, 0)
    for i in range(9):
        log.transform(0.2 * i, "odom", "base_link", (float(i), 0.0, 0.0), LEVEL, topic="/tf")
        log.transform(0.2 * i, "base_link", "laser", (0.2, 0.0, 0.0), HALF_OVER, topic="/tf")
        log.scan(0.2 * i, [1.0, 2.0, 3.0])
    path = log.close()
    fifth = list(open_log(path))[4]
    assert fifth.pose is not None
    assert fifth.scan is not None
    assert (fifth.pose.x, fifth.scan.mount.x) == pytest.approx((4.0, 0.2))
    assert fifth.scan.ranges.tolist() == [3.0, 2.0, 1.0]
    assert summarise(McapLog(path)).duration == pytest.approx(1.6)
    assert len(list(open_log(path, start=1.0))) == 4


def test_a_laser_on_a_turning_head(ros2: Any) -> None:
    log = ros2()
    log.transform(0.0, "head", "laser", (0.1, 0.0, 0.0), LEVEL)
    for i in range(20):
        log.transform(0.1 * i, "base_link", "head", (0.0, 0.0, 1.0), heading(0.1 * i), topic="/tf")
        log.scan(0.1 * i + 0.05, [1.0])
    found = [each.scan.mount for each in open_log(log.close(), parts=["scan"]) if each.scan]
    assert [each.theta for each in found[:19]] == pytest.approx([0.1 * i + 0.05 for i in range(19)])
    assert found[4].y == pytest.approx(0.1 * math.sin(0.45))


def test_a_transform_of_nan_is_left_out_and_told(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = localised(ros2)
    log.transform(0.0, "base_link", "laser", (0.2, 0.0, 0.0), NOTHING)
    assert len(xs(log.close())) == 40
    assert "1 transforms were left out (the first: base_link to laser" in caplog.text


def test_two_robots_do_not_mix(ros2: Any) -> None:
    log = ros2()
    for i in range(10):
        for robot in (1, 2):
            x = (10.0 * robot + 0.1 * i, 0.0, 0.0)
            log.transform(0.1 * i, "odom", "base_link", x, LEVEL, topic=f"/robot{robot}/tf")
        log.scan(0.1 * i, [1.0], topic="/robot2/scan")
    assert xs(log.close()) == pytest.approx([20 + 0.1 * i for i in range(10)])


def test_of_two_robots_one_is_asked_for(ros2: Any) -> None:
    log = ros2()
    for i in range(10):
        for robot in (1, 2):
            x = (10.0 * robot + 0.1 * i, 0.0, 0.0)
            log.transform(0.1 * i, "odom", "base_link", x, LEVEL, topic=f"/robot{robot}/tf")
        log.scan(0.1 * i, [1.0])
    path = log.close()
    with pytest.raises(UsageError, match=r"2 robots: /robot1/tf, /robot2/tf; .*pose_topic=/robot1"):
        list(open_log(path))
    assert xs(path, pose_topic="/robot1/tf") == pytest.approx([10 + 0.1 * i for i in range(10)])


def odometry(log: Any, t: float, x: float, theta: float, child: str, **pose: Any) -> None:
    turned = pose.get("turned", heading(theta))
    message = {
        "header": log.header(t, "odom"),
        "child_frame_id": child,
        "pose": {"pose": {"position": {"x": x, "y": 0.0, "z": 0.0}, "orientation": turned}},
    }
    log.put("/odom", "nav_msgs/msg/Odometry", message, t)


def test_odometry_of_another_frame_is_carried_to_the_robot(ros2: Any) -> None:
    log = ros2()
    log.transform(0.0, "base_link", "camera", (0.5, 0.0, 0.0), heading(math.pi / 2))
    log.transform(0.0, "base_link", "laser", (0.0, 0.0, 0.0), LEVEL)
    for i in range(5):
        odometry(log, 0.1 * i, float(i), math.pi / 2, "camera")
        log.scan(0.1 * i, [1.0])
    found = [each.pose for each in open_log(log.close())]
    # The camera looks to the left, 0.5 m before the robot: where it looks along y, the robot
    # looks along x, 0.5 m behind.
    assert [(p.x, p.y, p.theta) for p in found if p] == [
        pytest.approx((i - 0.5, 0.0, 0.0), abs=1e-9) for i in range(5)
    ]


def test_odometry_is_carried_to_the_frame_that_is_asked_for(ros2: Any) -> None:
    log = localised(ros2)
    for i in range(40):
        odometry(log, 0.1 * i, 0.1 * i, 0.0, "base_link")
    path = log.close()
    assert xs(path) == pytest.approx([0.1 * i for i in range(40)])
    assert xs(path, pose_frame="map") == pytest.approx([5 + 0.3 * i for i in range(40)])


def test_poses_that_say_nothing_are_left_out_and_their_neighbours_joined(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i, x in enumerate([0.0, 1.0, math.nan, 3.0, 1e12, 5.0]):
        odometry(log, 0.1 * i, x, 0.0, "base_link")
        log.scan(0.1 * i, [1.0])
    assert xs(log.close()) == pytest.approx([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    assert "2 messages could not be used" in caplog.text


def test_a_quaternion_of_another_length(ros2: Any) -> None:
    log = ros2()
    odometry(log, 0.0, 0.0, 0.0, "base_link", turned={"x": 0.0, "y": 0.0, "z": 1.0, "w": 1.0})
    log.scan(0.0, [1.0])
    (found,) = open_log(log.close())
    assert found.pose is not None
    assert found.pose.theta == pytest.approx(math.pi / 2)


def stamped(log: Any, t: float, topic: str, frame: str, x: float = 1.0) -> None:
    pose = {"position": {"x": x, "y": 0.2, "z": 0.0}, "orientation": LEVEL}
    message = {"header": log.header(t, frame), "pose": pose}
    log.put(topic, "geometry_msgs/msg/PoseStamped", message, t)


@pytest.mark.parametrize(
    ("topic", "frame"), [("/detected_object/pose", "camera"), ("/goal_pose", "map"), ("/p", "map")]
)
def test_transforms_beat_the_pose_of_something_else(ros2: Any, topic: str, frame: str) -> None:
    log = localised(ros2)
    for i in range(40):
        stamped(log, 0.1 * i, topic, frame)
    path = log.close()
    assert xs(path)[-1] == pytest.approx(5 + 0.3 * 39)
    summary = summarise(McapLog(path))
    told = next(part for part in summary.parts if part.part == "pose")
    assert told.topics == ("/tf",)
    assert "map to base_link" in told.reason
    assert f"not taken: {topic}" in told.reason


@pytest.mark.parametrize(
    ("topic", "frame", "every"),
    [("/goal_pose", "map", 1), ("/pose", "camera_optical", 1), ("/pose", "map", 20)],
)
def test_a_pose_that_may_not_be_the_robots_is_not_taken_by_itself(
    ros2: Any, topic: str, frame: str, every: int
) -> None:
    log = ros2()
    for i in range(40):
        if i % every == 0:
            stamped(log, 0.1 * i, topic, frame)
        log.scan(0.1 * i, [1.0])
    path = log.close()
    assert xs(path) == [None] * 40
    told = next(p for p in summarise(McapLog(path)).parts if p.part == "pose")
    assert f"source.pose_topic={topic}" in told.reason
    assert xs(path, pose_topic=topic)[0] == 1.0


def test_odometry_beats_a_rare_localisation(ros2: Any) -> None:
    log = ros2()
    for i in range(40):
        log.odom(0.1 * i, 0.1 * i, 0.0, 0.0)
        log.scan(0.1 * i, [1.0])
    log.pose(0.0, 7.0, 0.0, 0.0, covariance=True)
    assert xs(log.close()) == pytest.approx([0.1 * i for i in range(40)])


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("/label", True), ("/room", True), ("/robot/roomLabel", True), ("/room/name", True),
        ("/semantic/current_place", True), ("/pick_and_place/status", False),
        ("/pick_and_place", False), ("/marketplace", False), ("/bedrooms_light", False),
        ("/place_object/feedback", False), ("/room/temperature", False),
    ],
)  # fmt: skip
def test_labels_by_whole_words_of_the_name(ros2: Any, name: str, taken: bool) -> None:
    log = ros2()
    log.string(0.0, "office", topic=name)
    log.scan(0.1, [1.0])
    assert [each.label for each in open_log(log.close())] == ["office" if taken else None]


@pytest.mark.parametrize("lag", [4.0, -4.0, 1e9])
def test_labels_without_a_stamp_go_by_the_recorders_clock(
    ros2: Any, lag: float, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i in range(160):
        if i % 40 == 0:
            log.string(0.2 * i, ("office", "corridor")[i // 40 % 2])
        log.scan(0.2 * i - lag, [1.0], lag=lag)
    found = [each.label for each in open_log(log.close())]
    assert found == [("office", "corridor")[i // 40 % 2] for i in range(160)]
    assert f"/scan {abs(lag):.1f} s {'behind' if lag > 0 else 'ahead'}" in caplog.text


@pytest.mark.parametrize("poses", [False, True])
def test_a_label_recorded_at_the_time_of_a_scan_holds_for_it_wherever_it_stands(
    ros2: Any, poses: bool
) -> None:
    log = ros2()
    for i in range(6):
        log.scan(float(i), [1.0])
        if poses:
            log.odom(float(i), 0.1 * i, 0.0, 0.0)
        log.string(float(i), ("office", "corridor")[i // 3])
    found = [each.label for each in open_log(log.close())]
    assert found == ["office"] * 3 + ["corridor"] * 3


def test_topics_of_different_clocks_are_joined_by_the_recorders(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i in range(40):
        log.odom(0.1 * i, float(i), 0.0, 0.0)
        log.transform(0.1 * i, "base_link", "laser", (0.1 * i, 0.0, 0.0), LEVEL, topic="/tf")
        log.scan(0.1 * i - 1e9, [1.0], lag=1e9)  # simulated time
    found = list(open_log(log.close()))
    assert [o.pose.x for o in found if o.pose] == pytest.approx(list(range(40)))
    assert [o.scan.mount.x for o in found if o.scan] == pytest.approx([0.1 * i for i in range(40)])
    assert "/odom, /tf brought to the clock of /scan" in caplog.text


def test_simulated_time_that_begins_at_zero(ros2: Any) -> None:
    log = ros2()
    begin = START * 1e-9
    for i in range(10):
        log.scan(0.1 * i - begin, [1.0], lag=begin)
    stamps = [each.stamp for each in open_log(log.close())]
    assert stamps[0] == 0
    assert stamps == sorted(stamps)


def test_intervals_on_the_recorders_clock(
    ros2: Any, tmp_path: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i in range(40):
        log.scan(0.1 * i - 1e9, [1.0], lag=1e9)
    labels = tmp_path / "labels.csv"
    begin = START // 1_000_000_000
    labels.write_text(f"start,end,label\n{begin},{begin + 2},office\n{begin + 2},{begin + 9},lab\n")
    found = [each.label for each in open_log(log.close(), labels=str(labels))]
    assert found == ["office"] * 20 + ["lab"] * 20
    assert "are read on the recorder's clock" in caplog.text


@pytest.mark.parametrize("several", [False, True])
def test_transforms_of_foxglove(as_json: Any, several: bool) -> None:
    log = as_json()
    for i in range(10):
        moves = [
            {
                "timestamp": log.time(0.1 * i),
                "parent_frame_id": parent,
                "child_frame_id": child,
                "translation": {"x": x, "y": 0.0, "z": 0.0},
                "rotation": LEVEL,
            }
            for parent, child, x in [("map", "odom", 0.2 * i), ("odom", "base_link", 0.1 * i)]
        ]
        if several:
            log.put("/tf", "foxglove.FrameTransforms", {"transforms": moves}, 0.1 * i)
        else:
            for each in moves:
                log.put("/tf", "foxglove.FrameTransform", each, 0.1 * i)
        log.scan(0.1 * i, [1.0])
    assert xs(log.close()) == pytest.approx([0.3 * i for i in range(10)])


def test_a_scan_that_says_where_in_the_map_it_was_taken(as_json: Any) -> None:
    log = as_json()
    for i in range(5):  # northwards; the laser is a quarter of a metre ahead
        at = {"x": 3.0, "y": 0.5 * i, "z": 0.0}
        robot = {"position": at, "orientation": heading(math.pi / 2)}
        laser = {**robot, "position": {**at, "y": 0.5 * i + 0.25}}
        message = {"timestamp": log.time(0.1 * i), "frame_id": "map", "pose": robot}
        log.put("/pose", "foxglove.PoseInFrame", message, 0.1 * i)
        log.scan(0.1 * i, [1.0, 1.0], frame_id="map", pose=laser)
    for each in open_log(log.close()):
        assert each.scan is not None
        mount = each.scan.mount
        assert (mount.x, mount.y, mount.theta) == pytest.approx((0.25, 0.0, 0.0))
        assert mount.frame == "base_link"


@pytest.mark.parametrize(("ros", "name"), [(1, "run.bag"), (2, "run")])
def test_transforms_in_bags(tmp_path: Any, ros: int, name: str) -> None:
    made = Recording(ros)
    for i in range(10):
        for parent, child, x in (("/map", "/odom", 0.2 * i), ("/odom", "/base_link", 0.1 * i)):
            moved = made.make(
                "geometry_msgs/msg/Transform",
                made.make("geometry_msgs/msg/Vector3", x, 0.0, 0.0),
                made.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0),
            )
            header = made.header(0.1 * i, parent)
            one = made.make("geometry_msgs/msg/TransformStamped", header, child, moved)
            message = made.make("tf2_msgs/msg/TFMessage", [one])
            made.add("/tf", "tf2_msgs/msg/TFMessage", 0.1 * i, message)
        made.scan(0.1 * i, [1.0, 2.0, 3.0])
    found = [each.pose for each in RosbagLog(made.as_bag(tmp_path / name))]
    assert [p.x for p in found if p] == pytest.approx([0.3 * i for i in range(10)])
    assert {p.frame for p in found if p} == {"map"}


def test_transforms_follow_a_clock_that_jumps_back(ros2: Any) -> None:
    log = ros2()
    for turn in range(2):
        for i in range(40):
            t, at = 0.1 * i, 0.1 * i + 4.0 * turn
            one = {
                "header": log.header(t, "odom"),
                "child_frame_id": "base_link",
                "transform": {
                    "translation": {"x": 100.0 * turn + i, "y": 0.0, "z": 0.0},
                    "rotation": LEVEL,
                },
            }
            log.put("/tf", "tf2_msgs/msg/TFMessage", {"transforms": [one]}, at)
            log.scan(t, [1.0], lag=at - t)
    found = xs(log.close())
    assert found[:38] == pytest.approx([float(i) for i in range(38)])
    assert found[-25:] == pytest.approx([100.0 + i for i in range(15, 40)])


@pytest.mark.parametrize("moves", [False, True])
def test_a_static_transform_that_is_said_anew_holds_from_then_on(ros2: Any, moves: bool) -> None:
    log = ros2()
    log.transform(0.0, "base_link", "laser", (0.2, 0.0, 0.0), LEVEL)
    for i in range(40):
        if moves:
            log.transform(0.1 * i, "odom", "base_link", (0.1 * i, 0.0, 0.0), LEVEL, topic="/tf")
        if i in (10, 20):  # the first of them says nothing new
            log.transform(0.1 * i, "base_link", "laser", (i // 20 + 0.2, 0.0, 0.0), LEVEL)
        log.scan(0.1 * i, [1.0])
    path = log.close()
    due = [0.2] * 20 + [1.2] * 20
    for skipped in (0, 25):  # what came before the part that is read holds too
        found = [each.scan.mount.x for each in open_log(path, start=0.1 * skipped) if each.scan]
        assert found == pytest.approx(due[skipped:])


def test_a_static_transform_that_is_said_again_takes_no_memory() -> None:
    buffer = TransformBuffer()
    for stamp in range(1000):
        buffer.add(Transform("base_link", "laser", (0.2, 0.0, 0.0), NO_TURN, stamp), static=True)
    assert len(buffer.edges["laser"].history) == 1


def test_a_pose_that_no_transform_carries_is_left_out(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    """The camera turns on the robot; nobody knows how from the third second on."""
    log = ros2()
    for i in range(40):
        if i < 20:
            log.transform(0.1 * i, "base_link", "camera", (1, 0, 0), heading(0.1 * i), topic="/tf")
        odometry(log, 0.1 * i, float(i), 0.0, "camera")
        log.scan(0.1 * i, [1.0], frame="base_link")
    found = xs(log.close())
    # Seen from the camera the robot lies at (-cos, sin) of its turn.
    assert found[:20] == pytest.approx([i - math.cos(0.1 * i) for i in range(20)])
    assert found[22:] == [None] * 18
    assert "cannot be carried to 'base_link': no transform is near in time" in caplog.text


@pytest.mark.parametrize(("child", "told"), [("camera_link", True), ("chassis", False)])
def test_whose_pose_it_is_without_transforms(
    ros2: Any, caplog: pytest.LogCaptureFixture, child: str, told: bool
) -> None:
    log = ros2()
    odometry(log, 0.0, 3.0, 0.0, child)
    log.scan(0.0, [1.0])
    assert xs(log.close()) == [3.0]
    assert ("poses are of 'camera_link', which transforms do not connect" in caplog.text) is told


def test_a_pose_without_a_heading_is_told(ros2: Any, caplog: pytest.LogCaptureFixture) -> None:
    log = ros2()
    for i in range(3):
        odometry(log, 0.1 * i, 3.0, 0.0, "base_link", turned=dict.fromkeys("xyzw", 0.0))
        log.scan(0.1 * i, [1.0])
    assert xs(log.close()) == [3.0] * 3
    assert "3 poses say no heading, and are taken to look along x" in caplog.text


@pytest.mark.parametrize("ahead", [3600, -3600])
def test_labels_with_stamps_of_another_clock(
    as_json: Any, ahead: int, caplog: pytest.LogCaptureFixture
) -> None:
    """Those of the labels are on the recorder's."""
    log = as_json()
    for i in range(20):
        if i % 10 == 0:
            label = {"stamp": START + i * 10**8, "label": "ab"[i // 10]}
            log.put("/label", "placecue.Label", label, 0.1 * i)
        log.scan(0.1 * i, [1.0], timestamp=log.time(0.1 * i + ahead))
    assert [each.label for each in open_log(log.close())] == list("a" * 10 + "b" * 10)
    assert "/label brought to the clock of /scan" in caplog.text


def test_steps_in_degrees_are_no_scan(ros2: Any, caplog: pytest.LogCaptureFixture) -> None:
    log = ros2()
    log.scan(0.0, [1.0] * 361, first=-180.0, step=1.0)
    log.scan(0.1, [1.0] * 361, first=-math.pi, step=math.radians(1.0))
    assert len(list(open_log(log.close()))) == 1
    assert "361 beams in steps of 1 rad turn 57 times" in caplog.text


def test_transforms_that_do_not_place_the_robot_are_told(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i in range(10):
        log.transform(0.1 * i, "map", "camera_link", (float(i), 0.0, 0.0), LEVEL, topic="/tf")
        log.image(0.1 * i, jpeg())
    path = log.close()
    assert xs(path) == [None] * 10
    assert "no pose: the transforms do not place 'base_link' in any of map, world" in caplog.text
    assert "frames: camera_link, map; set source.base_frame" in caplog.text
    assert xs(path, base_frame="camera_link") == pytest.approx(list(range(10)))
    [told] = [each for each in summarise(McapLog(path)).parts if each.part == "pose"]
    assert "do not place 'base_link'" in told.reason


def test_odometry_of_something_else_is_not_taken_by_itself(ros2: Any) -> None:
    log = localised(ros2)
    for i in range(40):
        log.odom(0.1 * i, 50.0, 0.0, 0.0, topic="/target/odom")
    path = log.close()
    assert xs(path) == pytest.approx([5 + 0.3 * i for i in range(40)])
    assert xs(path, pose_topic="/target/odom") == [50.0] * 40


def test_poses_that_change_their_frame_are_not_joined(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i in range(10):
        frame, x = ("odom", 0.1 * i) if i < 5 else ("map", 100.0 + i)
        stamped(log, 0.1 * i, "/pose", frame, x)
        log.scan(0.1 * i + 0.04, [1.0])
    found = [(o.pose.x, o.pose.frame) for o in open_log(log.close()) if o.pose]
    assert found[3] == (pytest.approx(0.34), "odom")
    assert found[4] == (0.4, "odom")
    assert found[5] == (pytest.approx(105.4), "map")
    assert "1 times poses change their frame" in caplog.text


def test_a_header_that_does_not_stand_first(ros2: Any) -> None:
    """Of a definition of one's own."""
    log, name = ros2(), "sensor_msgs/msg/LaserScan"
    schema = log.writer.register_msgdef(name, f"uint32 extra\n{DEFINITIONS[name]}")
    message = {"extra": 7, "header": log.header(1.0, "laser"), "angle_min": -1.0}
    message |= {"angle_increment": 0.5, "range_max": 10.0, "ranges": [1.0, 2.0]}
    log.writer.write_message("/scan", schema, message, START, START)
    (found,) = open_log(log.close())
    assert found.stamp == START + 1_000_000_000
    assert found.scan is not None
    assert found.scan.ranges.tolist() == [1.0, 2.0]
