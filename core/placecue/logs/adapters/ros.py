"""ROS messages. The same classes serve every version of ROS, whose fields have the same names."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from placecue.logs.adapters.base import Adapter, Role, increasing, stated
from placecue.logs.messages.geometry import Transform, yaw
from placecue.logs.messages.images import RawImage, ReorderedImage, compressed
from placecue.observation import EncodedImage, LaserScan, Pose2D

#: ROS 2 and ROS 1.
ENCODINGS = ("cdr", "ros1")


def stamp_of(header: Any) -> int:
    """Return the stamp of a header, ns."""
    return int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)


def frame_of(header: Any) -> str:
    """Return the frame of a header, without the leading slash of old systems."""
    return str(header.frame_id).lstrip("/")


class RosAdapter(Adapter):
    """A message that begins with a header."""

    encodings: ClassVar[tuple[str, ...]] = ENCODINGS
    header_first = True

    def stamp(self, message: Any) -> int:
        """Return the header's stamp, ns."""
        return stamp_of(message.header)

    def frame(self, message: Any) -> str:
        """Return the header's frame."""
        return frame_of(message.header)


class RosCompressedImage(RosAdapter):
    """sensor_msgs/CompressedImage."""

    schemas: ClassVar[tuple[str, ...]] = ("sensor_msgs/CompressedImage",)
    role: ClassVar[Role] = "image"

    def value(self, message: Any, origin: str) -> EncodedImage | ReorderedImage:
        """Return the image, undecoded."""
        return compressed(bytes(message.data), message.format, origin)

    def pixels(self, message: Any) -> str:
        """Return the format, such as ``rgb8; jpeg compressed bgr8``."""
        return str(message.format)


class RosImage(RosAdapter):
    """sensor_msgs/Image."""

    schemas: ClassVar[tuple[str, ...]] = ("sensor_msgs/Image",)
    role: ClassVar[Role] = "image"

    def value(self, message: Any, origin: str) -> RawImage:
        """Return the image, unconverted."""
        return RawImage(
            bytes(message.data),
            message.height,
            message.width,
            message.step,
            message.encoding,
            origin,
            bool(message.is_bigendian),
        )

    def pixels(self, message: Any) -> str:
        """Return the pixel format."""
        return str(message.encoding)


class RosLaserScan(RosAdapter):
    """sensor_msgs/LaserScan. Ranges are float32 in the message."""

    schemas: ClassVar[tuple[str, ...]] = ("sensor_msgs/LaserScan",)
    role: ClassVar[Role] = "scan"

    def value(self, message: Any, origin: str) -> LaserScan:
        """Return the scan in its own frame, with its angles increasing."""
        angles, ranges = increasing(
            message.angle_min, message.angle_increment, message.ranges, origin
        )
        return LaserScan(
            angles,
            ranges,
            message.range_min if np.isfinite(message.range_min) else 0.0,
            stated(message.range_max),
            Pose2D(0.0, 0.0, 0.0, self.frame(message)),
        )


class RosOdometry(RosAdapter):
    """nav_msgs/Odometry."""

    schemas: ClassVar[tuple[str, ...]] = ("nav_msgs/Odometry",)
    role: ClassVar[Role] = "pose"

    def value(self, message: Any, origin: str) -> Pose2D:
        """Return the pose in the plane."""
        return _planar(message.pose.pose, self.frame(message))

    def is_turned(self, message: Any) -> bool:
        """Tell whether the quaternion is not zero."""
        return any(_xyzw(message.pose.pose.orientation))

    def moved(self, message: Any) -> Transform | None:
        """Return where it puts its child frame; a PoseWithCovarianceStamped names none."""
        child = str(getattr(message, "child_frame_id", "")).lstrip("/")
        return _moved(message.pose.pose, self.frame(message), child) if child else None


class RosPoseStamped(RosAdapter):
    """geometry_msgs/PoseStamped."""

    schemas: ClassVar[tuple[str, ...]] = ("geometry_msgs/PoseStamped",)
    role: ClassVar[Role] = "pose"

    def value(self, message: Any, origin: str) -> Pose2D:
        """Return the pose in the plane."""
        return _planar(message.pose, self.frame(message))

    def is_turned(self, message: Any) -> bool:
        """Tell whether the quaternion is not zero."""
        return any(_xyzw(message.pose.orientation))


class RosPoseWithCovarianceStamped(RosOdometry):
    """geometry_msgs/PoseWithCovarianceStamped, such as the pose that amcl publishes."""

    schemas: ClassVar[tuple[str, ...]] = ("geometry_msgs/PoseWithCovarianceStamped",)


class RosTransforms(Adapter):
    """tf2_msgs/TFMessage."""

    encodings: ClassVar[tuple[str, ...]] = ENCODINGS
    schemas: ClassVar[tuple[str, ...]] = ("tf2_msgs/TFMessage", "tf/tfMessage")
    role: ClassVar[Role] = "transform"

    def stamp(self, message: Any) -> int:
        """Return the stamp of the first transform, ns."""
        return stamp_of(message.transforms[0].header) if message.transforms else 0

    def value(self, message: Any, origin: str) -> list[Transform]:
        """Return the transforms."""
        return [
            Transform(
                parent=frame_of(each.header),
                child=str(each.child_frame_id).lstrip("/"),
                translation=_xyz(each.transform.translation),
                rotation=_xyzw(each.transform.rotation),
                stamp=stamp_of(each.header),
            )
            for each in message.transforms
        ]


class RosString(Adapter):
    """std_msgs/String, taken as the label from its log time on."""

    encodings: ClassVar[tuple[str, ...]] = ENCODINGS
    schemas: ClassVar[tuple[str, ...]] = ("std_msgs/String",)
    role: ClassVar[Role] = "label"

    def stamp(self, message: Any) -> int:
        """Return 0: the message has no stamp."""
        return 0

    def value(self, message: Any, origin: str) -> str:
        """Return the label; empty where a label ends."""
        return str(message.data).strip()


def _planar(pose: Any, frame: str) -> Pose2D:
    return Pose2D(pose.position.x, pose.position.y, yaw(*_xyzw(pose.orientation)), frame)


def _moved(pose: Any, parent: str, child: str) -> Transform:
    return Transform(parent, child, _xyz(pose.position), _xyzw(pose.orientation))


def _xyz(vector: Any) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z


def _xyzw(rotation: Any) -> tuple[float, float, float, float]:
    return rotation.x, rotation.y, rotation.z, rotation.w
