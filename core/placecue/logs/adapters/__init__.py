"""Adapters: from a decoded message to a part of an observation, one small class a schema."""

from __future__ import annotations

from placecue.logs.adapters.base import Adapter
from placecue.logs.adapters.foxglove import (
    FoxgloveCompressedImage,
    FoxgloveFrameTransform,
    FoxgloveFrameTransforms,
    FoxgloveLaserScan,
    FoxglovePoseInFrame,
    FoxgloveRawImage,
    PlacecueLabel,
)
from placecue.logs.adapters.ros import (
    RosCompressedImage,
    RosImage,
    RosLaserScan,
    RosOdometry,
    RosPoseStamped,
    RosPoseWithCovarianceStamped,
    RosString,
    RosTransforms,
)

__all__ = ["ADAPTERS", "Adapter", "adapter_for"]

#: By message encoding and schema name (without the ``/msg`` of ROS 2).
ADAPTERS: dict[tuple[str, str], Adapter] = {
    ("cdr", "sensor_msgs/CompressedImage"): RosCompressedImage(),
    ("cdr", "sensor_msgs/Image"): RosImage(),
    ("cdr", "sensor_msgs/LaserScan"): RosLaserScan(),
    ("cdr", "nav_msgs/Odometry"): RosOdometry(),
    ("cdr", "geometry_msgs/PoseStamped"): RosPoseStamped(),
    ("cdr", "geometry_msgs/PoseWithCovarianceStamped"): RosPoseWithCovarianceStamped(),
    ("cdr", "tf2_msgs/TFMessage"): RosTransforms(),
    ("cdr", "std_msgs/String"): RosString(),
    ("json", "foxglove.CompressedImage"): FoxgloveCompressedImage(),
    ("json", "foxglove.RawImage"): FoxgloveRawImage(),
    ("json", "foxglove.LaserScan"): FoxgloveLaserScan(),
    ("json", "foxglove.PoseInFrame"): FoxglovePoseInFrame(),
    ("json", "foxglove.FrameTransform"): FoxgloveFrameTransform(),
    ("json", "foxglove.FrameTransforms"): FoxgloveFrameTransforms(),
    ("json", "placecue.Label"): PlacecueLabel(),
}


def adapter_for(encoding: str, schema: str) -> Adapter | None:
    """Return the adapter for messages of a schema, or None.

    Parameters
    ----------
    encoding : str
        Message encoding of the channel.
    schema : str
        Name of its schema.
    """
    return ADAPTERS.get((encoding, schema.replace("/msg/", "/")))
