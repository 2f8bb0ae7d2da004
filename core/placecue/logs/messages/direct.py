"""ROS messages read without a schema at hand: the few that placecue uses, fast.

Fields have the names and the nesting of the ROS definitions; what placecue does not use
(intensities, covariances, twists) is passed over.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from mcap.records import Schema
from numpy.typing import NDArray

from placecue.logs.messages.ros_definitions import is_standard
from placecue.logs.messages.wire import CdrCursor, Cursor, Ros1Cursor


class Time(NamedTuple):
    """builtin_interfaces/Time."""

    sec: int
    nanosec: int


class Header(NamedTuple):
    """std_msgs/Header."""

    stamp: Time
    frame_id: str


class LaserScan(NamedTuple):
    """sensor_msgs/LaserScan."""

    header: Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]


class CompressedImage(NamedTuple):
    """sensor_msgs/CompressedImage."""

    header: Header
    format: str
    data: bytes


class Image(NamedTuple):
    """sensor_msgs/Image."""

    header: Header
    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: bytes


class Region(NamedTuple):
    """sensor_msgs/RegionOfInterest, without its flag."""

    x_offset: int
    y_offset: int
    height: int
    width: int


class CameraInfo(NamedTuple):
    """sensor_msgs/CameraInfo, as far as a pinhole camera goes."""

    header: Header
    height: int
    width: int
    k: tuple[float, ...]
    binning_x: int
    binning_y: int
    roi: Region


class Vector(NamedTuple):
    """geometry_msgs/Point or Vector3."""

    x: float
    y: float
    z: float


class Quaternion(NamedTuple):
    """geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


class Pose(NamedTuple):
    """geometry_msgs/Pose."""

    position: Vector
    orientation: Quaternion


class PoseStamped(NamedTuple):
    """geometry_msgs/PoseStamped."""

    header: Header
    pose: Pose


class UncertainPose(NamedTuple):
    """geometry_msgs/PoseWithCovariance."""

    pose: Pose


class Odometry(NamedTuple):
    """nav_msgs/Odometry, or geometry_msgs/PoseWithCovarianceStamped, which has no child frame."""

    header: Header
    child_frame_id: str
    pose: UncertainPose


class Transform(NamedTuple):
    """geometry_msgs/Transform."""

    translation: Vector
    rotation: Quaternion


class TransformStamped(NamedTuple):
    """geometry_msgs/TransformStamped."""

    header: Header
    child_frame_id: str
    transform: Transform


class Transforms(NamedTuple):
    """tf2_msgs/TFMessage."""

    transforms: list[TransformStamped]


class String(NamedTuple):
    """std_msgs/String."""

    data: str


def _header(cursor: Cursor) -> Header:
    sec, nanosec, frame = cursor.header()
    return Header(Time(sec, nanosec), frame)


def _laser_scan(cursor: Cursor) -> LaserScan:
    header, (first, last, step, pause, period, near, far) = _header(cursor), cursor.numbers("f", 7)
    scan = LaserScan(header, first, last, step, pause, period, near, far, cursor.array("f"))
    cursor.skip_array("f")  # intensities
    return scan


def _compressed_image(cursor: Cursor) -> CompressedImage:
    return CompressedImage(_header(cursor), cursor.text(), cursor.content())


def _image(cursor: Cursor) -> Image:
    header, (height, width) = _header(cursor), cursor.numbers("I", 2)
    encoding, (big_endian,), (step,) = cursor.text(), cursor.numbers("B", 1), cursor.numbers("I", 1)
    return Image(header, height, width, encoding, big_endian, step, cursor.content())


def _camera_info(cursor: Cursor) -> CameraInfo:
    header, (height, width) = _header(cursor), cursor.numbers("I", 2)
    cursor.text()  # model of the distortion
    cursor.skip_array("d")
    matrix = cursor.numbers("d", 9)
    cursor.skip("d", 9 + 12)  # rectification, projection
    across, down, *region = cursor.numbers("I", 6)
    return CameraInfo(header, height, width, matrix, across, down, Region(*region))


def _pose(cursor: Cursor) -> Pose:
    numbers = cursor.numbers("d", 7)
    return Pose(Vector(*numbers[:3]), Quaternion(*numbers[3:]))


def _pose_stamped(cursor: Cursor) -> PoseStamped:
    return PoseStamped(_header(cursor), _pose(cursor))


def _odometry(cursor: Cursor) -> Odometry:
    odometry = Odometry(_header(cursor), cursor.text(), UncertainPose(_pose(cursor)))
    cursor.skip("d", 36 + 6 + 36)  # covariance, twist, its covariance
    return odometry


def _uncertain_pose_stamped(cursor: Cursor) -> Odometry:
    pose = Odometry(_header(cursor), "", UncertainPose(_pose(cursor)))
    cursor.skip("d", 36)
    return pose


def _transform(cursor: Cursor) -> TransformStamped:
    header, child, numbers = _header(cursor), cursor.text(), cursor.numbers("d", 7)
    return TransformStamped(
        header, child, Transform(Vector(*numbers[:3]), Quaternion(*numbers[3:]))
    )


def _transforms(cursor: Cursor) -> Transforms:
    (count,) = cursor.numbers("I", 1)
    return Transforms([_transform(cursor) for _ in range(count)])


def _string(cursor: Cursor) -> String:
    return String(cursor.text())


READERS: dict[str, Callable[[Cursor], Any]] = {
    "geometry_msgs/PoseStamped": _pose_stamped,
    "geometry_msgs/PoseWithCovarianceStamped": _uncertain_pose_stamped,
    "nav_msgs/Odometry": _odometry,
    "sensor_msgs/CameraInfo": _camera_info,
    "sensor_msgs/CompressedImage": _compressed_image,
    "sensor_msgs/Image": _image,
    "sensor_msgs/LaserScan": _laser_scan,
    "std_msgs/String": _string,
    "tf/tfMessage": _transforms,
    "tf2_msgs/TFMessage": _transforms,
}
#: By the language of the schema.
CURSORS: dict[str, type[Cursor]] = {"ros2msg": CdrCursor, "ros1msg": Ros1Cursor}
ENCODINGS = {"ros2msg": "cdr", "ros1msg": "ros1"}


def direct_decoder(message_encoding: str, schema: Schema | None) -> Callable[[bytes], Any] | None:
    """Return what reads the messages of a schema directly.

    None where it is not one of :data:`READERS`, or its text is not the standard one.
    """
    if schema is None or ENCODINGS.get(schema.encoding) != message_encoding:
        return None
    name = schema.name.replace("/msg/", "/")
    if name not in READERS or not is_standard(name, schema.data, schema.encoding):
        return None
    return partial(_read, READERS[name], CURSORS[schema.encoding])


def _read(reader: Callable[[Cursor], Any], cursor: type[Cursor], data: bytes) -> Any:
    return reader(cursor(data))
