"""ROS 2 messages in CDR, so that ROS 2 tools play what placecue writes."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import numpy as np

from placecue.camera import PinholeCamera
from placecue.logs.messages.cdr import serialise
from placecue.logs.messages.geometry import quaternion
from placecue.logs.messages.kinds import (
    BASE_FRAME,
    CAMERA_FRAME,
    LASER_FRAME,
    NO_ROTATION,
    Dialect,
    MessageType,
    Written,
    seconds,
    spacing,
)
from placecue.logs.messages.ros_definitions import definition
from placecue.observation import LaserScan, Pose2D


@cache
def message_type(name: str) -> MessageType:
    """Return the type of a message by its short name, such as ``sensor_msgs/LaserScan``."""
    full, text = name.replace("/", "/msg/"), definition(name)
    return MessageType(full, "cdr", "ros2msg", text.encode(), partial(serialise, name))


class Ros2Dialect(Dialect):
    """sensor_msgs, nav_msgs, tf2_msgs and std_msgs.

    Labels are strings and not JSON, because a bag with two serialisations is refused by
    ``ros2 bag play``.
    """

    profile = "ros2"

    def image(self, stamp: int, data: bytes, format: str) -> Written:
        """Return a sensor_msgs/CompressedImage."""
        return _written(
            "/camera/image/compressed",
            "sensor_msgs/CompressedImage",
            {"header": _header(stamp, CAMERA_FRAME), "format": format, "data": data},
        )

    def camera(self, stamp: int, camera: PinholeCamera) -> Written:
        """Return a sensor_msgs/CameraInfo without distortion."""
        fields = {
            "header": _header(stamp, CAMERA_FRAME),
            "height": camera.height,
            "width": camera.width,
            "distortion_model": "plumb_bob",
            "d": [0.0] * 5,
            "k": camera.k,
            "r": NO_ROTATION,
            "p": camera.p,
        }
        return _written("/camera/camera_info", "sensor_msgs/CameraInfo", fields)

    def scan(self, stamp: int, scan: LaserScan) -> Written:
        """Return a sensor_msgs/LaserScan; ranges are rounded to float32."""
        some = len(scan.angles) > 0
        with np.errstate(over="ignore"):
            ranges = scan.ranges.astype(np.float32)
        fields = {
            "header": _header(stamp, LASER_FRAME),
            "angle_min": float(scan.angles[0]) if some else 0.0,
            "angle_max": float(scan.angles[-1]) if some else 0.0,
            "angle_increment": spacing(scan),
            "range_min": scan.range_min,
            "range_max": scan.range_max,
            "ranges": ranges,
        }
        return _written("/scan", "sensor_msgs/LaserScan", fields)

    def pose(self, stamp: int, pose: Pose2D) -> Written:
        """Return a nav_msgs/Odometry."""
        fields = {
            "header": _header(stamp, pose.frame),
            "child_frame_id": BASE_FRAME,
            "pose": {
                "pose": {"position": {"x": pose.x, "y": pose.y}, "orientation": _rotation(pose)}
            },
        }
        return _written("/odom", "nav_msgs/Odometry", fields)

    def transform(self, stamp: int, parent: str, child: str, pose: Pose2D, static: bool) -> Written:
        """Return a tf2_msgs/TFMessage with one transform."""
        one = {
            "header": _header(stamp, parent),
            "child_frame_id": child,
            "transform": {"translation": {"x": pose.x, "y": pose.y}, "rotation": _rotation(pose)},
        }
        topic = "/tf_static" if static else "/tf"
        return _written(topic, "tf2_msgs/TFMessage", {"transforms": [one]})

    def label(self, stamp: int, label: str) -> Written:
        """Return a std_msgs/String; its log time is the time of the label."""
        return _written("/label", "std_msgs/String", {"data": label})


def _written(topic: str, name: str, fields: dict[str, Any]) -> Written:
    return Written(topic, message_type(name), fields)


def _header(stamp: int, frame: str) -> dict[str, Any]:
    sec, nanosec = seconds(stamp)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame}


def _rotation(pose: Pose2D) -> dict[str, float]:
    return dict(zip("xyzw", quaternion(pose.theta), strict=True))
