"""ROS 1 logs in MCAP, serialised by rosbags."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mcap_logs import SECOND, START, heading

STORE = get_typestore(Stores.ROS1_NOETIC)
STORE.register(
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)


class Ros1Log:
    """Writes a log of ROS 1 messages; times are seconds after START."""

    def __init__(self, path: Path, **options: Any) -> None:
        self.path = path
        self.file = path.open("wb")
        self.writer = Writer(self.file, **options)
        self.writer.start(profile="ros1")
        self.channels: dict[str, int] = {}

    def put(self, topic: str, name: str, message: Any, t: float) -> None:
        full = name.replace("/", "/msg/")
        if topic not in self.channels:
            text, _ = STORE.generate_msgdef(full)
            schema = self.writer.register_schema(name, "ros1msg", text.encode())
            self.channels[topic] = self.writer.register_channel(topic, "ros1", schema)
        when = START + round(t * SECOND)
        data = bytes(STORE.serialize_ros1(message, full))
        self.writer.add_message(self.channels[topic], when, data, when)

    def kind(self, name: str) -> Any:
        return STORE.types[name.replace("/", "/msg/")]

    def header(self, t: float, frame: str) -> Any:
        stamp = START + round(t * SECOND)
        time = self.kind("builtin_interfaces/Time")(stamp // SECOND, stamp % SECOND)
        return self.kind("std_msgs/Header")(7, time, frame)

    def scan(self, t: float, ranges: list[float], first: float = -1.0, step: float = 0.5) -> None:
        values = np.array(ranges, np.float32)
        message = self.kind("sensor_msgs/LaserScan")(
            self.header(t, "/laser"), first, 1.0, step, 0.0, 0.0, 0.1, 10.0, values, values
        )
        self.put("/scan", "sensor_msgs/LaserScan", message, t)

    def _pose(self, x: float, y: float, theta: float) -> Any:
        point = self.kind("geometry_msgs/Point")(x, y, 0.0)
        turn = self.kind("geometry_msgs/Quaternion")(**heading(theta))
        return self.kind("geometry_msgs/Pose")(point, turn)

    def odom(self, t: float, x: float, y: float, theta: float) -> None:
        zero = self.kind("geometry_msgs/Vector3")(0.0, 0.0, 0.0)
        pose = self.kind("geometry_msgs/PoseWithCovariance")(self._pose(x, y, theta), np.zeros(36))
        twist = self.kind("geometry_msgs/Twist")(zero, zero)
        moving = self.kind("geometry_msgs/TwistWithCovariance")(twist, np.zeros(36))
        message = self.kind("nav_msgs/Odometry")(self.header(t, "odom"), "base_link", pose, moving)
        self.put("/odom", "nav_msgs/Odometry", message, t)

    def mounting(self, t: float, x: float, rotation: dict[str, float]) -> None:
        transform = self.kind("geometry_msgs/Transform")(
            self.kind("geometry_msgs/Vector3")(x, 0.0, 0.0),
            self.kind("geometry_msgs/Quaternion")(**rotation),
        )
        stamped = self.kind("geometry_msgs/TransformStamped")(
            self.header(t, "base_link"), "laser", transform
        )
        message = self.kind("tf2_msgs/TFMessage")([stamped])
        self.put("/tf_static", "tf2_msgs/TFMessage", message, t)

    def image(self, t: float, data: bytes) -> None:
        message = self.kind("sensor_msgs/CompressedImage")(
            self.header(t, "cam"), "jpeg", np.frombuffer(data, np.uint8)
        )
        self.put("/image", "sensor_msgs/CompressedImage", message, t)

    def raw(self, t: float, encoding: str, pixels: np.ndarray) -> None:
        height, width = pixels.shape[:2]
        data = np.frombuffer(pixels.tobytes(), np.uint8)
        message = self.kind("sensor_msgs/Image")(
            self.header(t, "cam"), height, width, encoding, 0, len(data) // height, data
        )
        self.put("/raw", "sensor_msgs/Image", message, t)

    def string(self, t: float, text: str) -> None:
        self.put("/label", "std_msgs/String", self.kind("std_msgs/String")(text), t)

    def close(self) -> str:
        self.writer.finish()
        self.file.close()
        return str(self.path)
