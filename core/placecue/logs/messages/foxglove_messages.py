"""Foxglove messages in JSON, and placecue's own."""

from __future__ import annotations

import json
from base64 import b64encode
from functools import cache, partial
from math import isfinite
from typing import Any

from placecue.camera import PinholeCamera
from placecue.logs.messages.foxglove_schemas import SCHEMAS
from placecue.logs.messages.geometry import quaternion
from placecue.logs.messages.kinds import (
    CAMERA_FRAME,
    LASER_FRAME,
    NO_ROTATION,
    Dialect,
    MessageType,
    Written,
    seconds,
)
from placecue.observation import LaserScan, Pose2D


def _serialise(name: str, message: Any) -> bytes:
    try:
        return json.dumps(message, separators=(",", ":"), allow_nan=False).encode()
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


@cache
def message_type(name: str) -> MessageType:
    """Return the type of a message by the name of its schema, such as ``foxglove.LaserScan``."""
    schema = json.dumps(SCHEMAS[name], separators=(",", ":")).encode()
    return MessageType(name, "json", "jsonschema", schema, partial(_serialise, name))


def time(stamp: int) -> dict[str, int]:
    """Return a Foxglove time from ns."""
    sec, nsec = seconds(stamp)
    return {"sec": sec, "nsec": nsec}


def point(x: float, y: float, z: float = 0.0) -> dict[str, float]:
    """Return a Foxglove point or vector, m."""
    return {"x": x, "y": y, "z": z}


def rotation(theta: float) -> dict[str, float]:
    """Return a Foxglove quaternion from a heading, rad."""
    return dict(zip("xyzw", quaternion(theta), strict=True))


def pose(x: float, y: float, theta: float = 0.0, z: float = 0.0) -> dict[str, Any]:
    """Return a Foxglove pose from metres and radians."""
    return {"position": point(x, y, z), "orientation": rotation(theta)}


def number(value: float) -> float | str:
    """Return a number, or the word that protobuf's JSON uses where JSON has no number."""
    if isfinite(value):
        return value
    return "NaN" if value != value else "Infinity" if value > 0 else "-Infinity"


class FoxgloveDialect(Dialect):
    """foxglove.* and placecue.Label. Ranges, poses and stamps keep every bit."""

    def image(self, stamp: int, data: bytes, format: str) -> Written:
        """Return a foxglove.CompressedImage."""
        fields = {
            "timestamp": time(stamp),
            "frame_id": CAMERA_FRAME,
            "data": b64encode(data).decode("ascii"),
            "format": format,
        }
        return _written("/camera/image/compressed", "foxglove.CompressedImage", fields)

    def camera(self, stamp: int, camera: PinholeCamera) -> Written:
        """Return a foxglove.CameraCalibration without distortion."""
        fields = {
            "timestamp": time(stamp),
            "frame_id": CAMERA_FRAME,
            "width": camera.width,
            "height": camera.height,
            "distortion_model": "plumb_bob",
            "D": [0.0] * 5,
            "K": list(camera.k),
            "R": list(NO_ROTATION),
            "P": list(camera.p),
        }
        return _written("/camera/camera_info", "foxglove.CameraCalibration", fields)

    def scan(self, stamp: int, scan: LaserScan) -> Written:
        """Return a foxglove.LaserScan, with the limits of range as fields of its own."""
        some = len(scan.angles) > 0
        fields = {
            "timestamp": time(stamp),
            "frame_id": LASER_FRAME,
            "pose": pose(0.0, 0.0),
            "start_angle": float(scan.angles[0]) if some else 0.0,
            "end_angle": float(scan.angles[-1]) if some else 0.0,
            "ranges": [number(each) for each in scan.ranges.tolist()],
            "intensities": [],
            "range_min": number(scan.range_min),
            "range_max": number(scan.range_max),
        }
        return _written("/scan", "foxglove.LaserScan", fields)

    def pose(self, stamp: int, pose: Pose2D) -> Written:
        """Return a foxglove.PoseInFrame."""
        fields = {"timestamp": time(stamp), "frame_id": pose.frame, "pose": _pose(pose)}
        return _written("/pose", "foxglove.PoseInFrame", fields)

    def transform(self, stamp: int, parent: str, child: str, pose: Pose2D, static: bool) -> Written:
        """Return a foxglove.FrameTransform."""
        fields = {
            "timestamp": time(stamp),
            "parent_frame_id": parent,
            "child_frame_id": child,
            "translation": point(pose.x, pose.y),
            "rotation": rotation(pose.theta),
        }
        topic = "/tf_static" if static else "/tf"
        return _written(topic, "foxglove.FrameTransform", fields)

    def label(self, stamp: int, label: str) -> Written:
        """Return a placecue.Label."""
        return _written("/label", "placecue.Label", {"stamp": stamp, "label": label})


def _written(topic: str, name: str, fields: dict[str, Any]) -> Written:
    return Written(topic, message_type(name), fields)


def _pose(planar: Pose2D) -> dict[str, Any]:
    return pose(planar.x, planar.y, planar.theta)
