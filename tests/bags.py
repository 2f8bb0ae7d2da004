"""One drive as a ROS 1 bag, a ROS 2 bag and MCAP, by the writers of rosbags and mcap."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer as PlainMcapWriter
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mcap_logs import SECOND, START, jpeg

ROS1 = get_typestore(Stores.ROS1_NOETIC)
ROS1.register(  # rosbags has it for ROS 2 only
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)
ROS2 = get_typestore(Stores.ROS2_HUMBLE)

Entry = tuple[str, str, int, Any]  # topic, type, log time (ns), message


class Recording:
    """A drive of which every message is known; times are seconds after START."""

    def __init__(self, ros: int = 2) -> None:
        self.ros = ros
        self.store = ROS1 if ros == 1 else ROS2
        self.entries: list[Entry] = []

    def make(self, name: str, *args: Any) -> Any:
        return self.store.types[name](*args)

    def add(self, topic: str, name: str, t: float, message: Any) -> None:
        self.entries.append((topic, name, START + round(t * SECOND), message))

    def header(self, t: float, frame: str) -> Any:
        stamp = START + round(t * SECOND)
        time = self.make("builtin_interfaces/msg/Time", stamp // SECOND, stamp % SECOND)
        number = (len(self.entries),) if self.ros == 1 else ()
        return self.make("std_msgs/msg/Header", *number, time, frame)

    def pose(self, x: float, y: float, theta: float) -> Any:
        turn = (0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2))
        return self.make(
            "geometry_msgs/msg/Pose",
            self.make("geometry_msgs/msg/Point", x, y, 0.0),
            self.make("geometry_msgs/msg/Quaternion", *turn),
        )

    def scan(self, t: float, ranges: list[float], lag: float = 0.0, topic: str = "/scan") -> None:
        lengths = np.array(ranges, np.float32)
        message = self.make(
            "sensor_msgs/msg/LaserScan",
            self.header(t, "laser"),
            *(-0.5, 0.5, 0.5, 0.0, 0.1, 0.1, 10.0),
            lengths,
            np.zeros(0, np.float32),
        )
        self.add(topic, "sensor_msgs/msg/LaserScan", t + lag, message)

    def image(self, t: float, data: bytes) -> None:
        message = self.make(
            "sensor_msgs/msg/CompressedImage",
            self.header(t, "camera"),
            "jpeg",
            np.frombuffer(data, np.uint8),
        )
        self.add("/image", "sensor_msgs/msg/CompressedImage", t, message)

    def odometry(self, t: float, x: float, y: float, theta: float) -> None:
        still = self.make("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0)
        twist = self.make("geometry_msgs/msg/Twist", still, still)
        message = self.make(
            "nav_msgs/msg/Odometry",
            self.header(t, "odom"),
            "base_link",
            self.make("geometry_msgs/msg/PoseWithCovariance", self.pose(x, y, theta), np.zeros(36)),
            self.make("geometry_msgs/msg/TwistWithCovariance", twist, np.zeros(36)),
        )
        self.add("/odom", "nav_msgs/msg/Odometry", t, message)

    def mounted(self, t: float, xyz: tuple[float, ...], rotation: tuple[float, ...]) -> None:
        transform = self.make(
            "geometry_msgs/msg/Transform",
            self.make("geometry_msgs/msg/Vector3", *xyz),
            self.make("geometry_msgs/msg/Quaternion", *rotation),
        )
        stamped = self.make(
            "geometry_msgs/msg/TransformStamped", self.header(t, "base_link"), "laser", transform
        )
        message = self.make("tf2_msgs/msg/TFMessage", [stamped])
        self.add("/tf_static", "tf2_msgs/msg/TFMessage", t, message)

    def label(self, t: float, text: str) -> None:
        self.add("/room", "std_msgs/msg/String", t, self.make("std_msgs/msg/String", text))

    def serialised(self) -> Iterator[tuple[str, str, int, bytes]]:
        write = self.store.serialize_ros1 if self.ros == 1 else self.store.serialize_cdr
        for topic, name, stamp, message in self.entries:
            yield topic, name, stamp, bytes(write(message, name))

    # The same in three kinds of files.

    def as_bag(self, path: Path, **options: Any) -> str:
        return self.as_ros1(path, **options) if self.ros == 1 else self.as_ros2(path, **options)

    def as_ros1(self, path: Path, compression: str = "", chunk: int = 1 << 20) -> str:
        writer = rosbag1.Writer(path)
        writer.chunk_threshold = chunk
        if compression:
            writer.set_compression(rosbag1.Writer.CompressionFormat[compression])
        with writer:
            topics: dict[tuple[str, str], Any] = {}
            for topic, name, stamp, data in self.serialised():
                if (topic, name) not in topics:
                    topics[topic, name] = writer.add_connection(topic, name, typestore=self.store)
                writer.write(topics[topic, name], stamp, data)
        return str(path)

    def as_ros2(self, path: Path, storage: str = "SQLITE3", compression: str = "NONE") -> str:
        plugin = rosbag2.StoragePlugin[storage]
        writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
        if compression != "NONE":
            mode = rosbag2.CompressionMode[compression]
            writer.set_compression(mode, rosbag2.CompressionFormat.ZSTD)
        with writer:
            topics: dict[tuple[str, str], Any] = {}
            for topic, name, stamp, data in self.serialised():
                if (topic, name) not in topics:
                    topics[topic, name] = writer.add_connection(topic, name, typestore=self.store)
                writer.write(topics[topic, name], stamp, data)
        return str(path)

    def as_bare_sqlite(self, path: Path) -> str:
        """Write the tables as ROS 2 Foxy did: no definitions, no metadata."""
        with sqlite3.connect(path) as base:
            base.execute(
                "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, "
                "type TEXT NOT NULL, serialization_format TEXT NOT NULL, "
                "offered_qos_profiles TEXT NOT NULL)"
            )
            base.execute(
                "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                "timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
            )
            topics: dict[str, int] = {}
            for topic, name, stamp, data in self.serialised():
                if topic not in topics:
                    topics[topic] = len(topics) + 1
                    row = (topics[topic], topic, name, "cdr", "")
                    base.execute("INSERT INTO topics VALUES(?, ?, ?, ?, ?)", row)
                base.execute(
                    "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                    (topics[topic], stamp, data),
                )
        base.close()
        return str(path)

    def as_mcap(self, path: Path) -> str:
        encoding, language = ("ros1", "ros1msg") if self.ros == 1 else ("cdr", "ros2msg")
        with path.open("wb") as file:
            writer = PlainMcapWriter(file)
            writer.start()
            channels: dict[tuple[str, str], int] = {}
            for topic, name, stamp, data in self.serialised():
                if (topic, name) not in channels:
                    text = self.store.generate_msgdef(name, ros_version=self.ros)[0]
                    plain = name.replace("/msg/", "/") if self.ros == 1 else name
                    schema = writer.register_schema(plain, language, text.encode())
                    channels[topic, name] = writer.register_channel(topic, encoding, schema)
                writer.add_message(channels[topic, name], stamp, data, stamp)
            writer.finish()
        return str(path)


UPSIDE_DOWN = (1.0, 0.0, 0.0, 0.0)  # half a turn about the x axis


def drive(ros: int, steps: int = 12, images: bool = True) -> Recording:
    """Return a drive along x at 1 m/s, 10 Hz, with a laser that hangs upside down."""
    made = Recording(ros)
    made.mounted(0.0, (0.2, 0.1, 0.5), UPSIDE_DOWN)
    made.label(0.0, "office")
    for i in range(steps):
        t = 0.1 * i
        made.odometry(t, t, 0.0, 0.1 * i)
        made.scan(t + 0.02, [1.0 + i, math.inf, 3.0], lag=0.03)
        if images:
            made.image(t + 0.03, jpeg(10 * i % 256))
        if i == steps // 2:
            made.label(t + 0.06, "corridor")
    made.odometry(0.1 * steps, 0.1 * steps, 0.0, 0.1 * steps)
    return made
