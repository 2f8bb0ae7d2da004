"""Adapters: from a decoded message to a part of an observation, one small class a schema."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        *(_of_ros(*each) for each in ROS),
        *(_of_foxglove(*each) for each in FOXGLOVE),
        Component(
            kind="adapter",
            name="placecue_label",
            factory="placecue.logs.adapters.foxglove:PlacecueLabel",
            summary="placecue.Label as a label",
        ),
    ]


#: Name, class, message and part, of ROS messages.
ROS = (
    ("compressed_image", "RosCompressedImage", "sensor_msgs/CompressedImage", "an image"),
    ("image", "RosImage", "sensor_msgs/Image", "an image"),
    ("laser_scan", "RosLaserScan", "sensor_msgs/LaserScan", "a scan"),
    ("odometry", "RosOdometry", "nav_msgs/Odometry", "a pose"),
    ("pose", "RosPoseStamped", "geometry_msgs/PoseStamped", "a pose"),
    (
        "pose_with_covariance",
        "RosPoseWithCovarianceStamped",
        "geometry_msgs/PoseWithCovarianceStamped",
        "a pose",
    ),
    ("transforms", "RosTransforms", "tf2_msgs/TFMessage", "transforms"),
    ("string", "RosString", "std_msgs/String", "a label"),
)
#: The same of Foxglove's.
FOXGLOVE = (
    ("compressed_image", "FoxgloveCompressedImage", "foxglove.CompressedImage", "an image"),
    ("raw_image", "FoxgloveRawImage", "foxglove.RawImage", "an image"),
    ("laser_scan", "FoxgloveLaserScan", "foxglove.LaserScan", "a scan"),
    ("pose", "FoxglovePoseInFrame", "foxglove.PoseInFrame", "a pose"),
    ("transform", "FoxgloveFrameTransform", "foxglove.FrameTransform", "a transform"),
    ("transforms", "FoxgloveFrameTransforms", "foxglove.FrameTransforms", "transforms"),
)


def _of_ros(name: str, cls: str, message: str, part: str) -> Component:
    factory = f"placecue.logs.adapters.ros:{cls}"
    return Component("adapter", f"ros_{name}", factory, f"{message} as {part}")


def _of_foxglove(name: str, cls: str, message: str, part: str) -> Component:
    factory = f"placecue.logs.adapters.foxglove:{cls}"
    return Component("adapter", f"foxglove_{name}", factory, f"{message} as {part}")
