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

ROS: dict[str, Adapter] = {
    "sensor_msgs/CompressedImage": RosCompressedImage(),
    "sensor_msgs/Image": RosImage(),
    "sensor_msgs/LaserScan": RosLaserScan(),
    "nav_msgs/Odometry": RosOdometry(),
    "geometry_msgs/PoseStamped": RosPoseStamped(),
    "geometry_msgs/PoseWithCovarianceStamped": RosPoseWithCovarianceStamped(),
    "tf2_msgs/TFMessage": RosTransforms(),
    "tf/tfMessage": RosTransforms(),
    "std_msgs/String": RosString(),
}
FOXGLOVE: dict[str, Adapter] = {
    "foxglove.CompressedImage": FoxgloveCompressedImage(),
    "foxglove.RawImage": FoxgloveRawImage(),
    "foxglove.LaserScan": FoxgloveLaserScan(),
    "foxglove.PoseInFrame": FoxglovePoseInFrame(),
    "foxglove.FrameTransform": FoxgloveFrameTransform(),
    "foxglove.FrameTransforms": FoxgloveFrameTransforms(),
}
#: By message encoding and schema name (without the ``/msg`` of ROS 2).
ADAPTERS: dict[tuple[str, str], Adapter] = {
    **{(encoding, name): each for encoding in ("cdr", "ros1") for name, each in ROS.items()},
    **{(encoding, name): e for encoding in ("json", "protobuf") for name, e in FOXGLOVE.items()},
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
