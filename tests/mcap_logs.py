"""Logs made by other writers than placecue's: mcap_ros2's for ROS 2, mcap's own for JSON."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory as Ros2DecoderFactory
from mcap_ros2.writer import Writer as Ros2Writer

from placecue.observation import EncodedImage, LaserScan, Observation, Pose2D

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND

HEADER = """
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
"""
QUATERNION = """
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
"""
POSE = (
    """
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
"""
    + QUATERNION
)
VECTOR = """
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
DEFINITIONS = {
    "sensor_msgs/msg/LaserScan": "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\n"
    "float32 angle_increment\nfloat32 time_increment\nfloat32 scan_time\nfloat32 range_min\n"
    "float32 range_max\nfloat32[] ranges\nfloat32[] intensities" + HEADER,
    "sensor_msgs/msg/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data"
    + HEADER,
    "sensor_msgs/msg/Image": "std_msgs/Header header\nuint32 height\nuint32 width\n"
    "string encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data" + HEADER,
    "nav_msgs/msg/Odometry": "std_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist"
    + HEADER
    + "=" * 80
    + "\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance"
    + POSE
    + "=" * 80
    + "\nMSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\n"
    "float64[36] covariance\n" + "=" * 80 + "\nMSG: geometry_msgs/Twist\n"
    "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular" + VECTOR,
    "geometry_msgs/msg/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose"
    + HEADER
    + POSE.lstrip("\n"),
    "geometry_msgs/msg/PoseWithCovarianceStamped": "std_msgs/Header header\n"
    "geometry_msgs/PoseWithCovariance pose"
    + HEADER
    + "=" * 80
    + "\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance"
    + POSE,
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms\n"
    + "=" * 80
    + "\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/Transform transform"
    + HEADER
    + "=" * 80
    + "\nMSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    "geometry_msgs/Quaternion rotation" + VECTOR + QUATERNION.lstrip("\n"),
    "std_msgs/msg/String": "string data",
}


def jpeg(shade: int = 128, size: tuple[int, int] = (12, 16)) -> bytes:
    ok, data = cv2.imencode(".jpg", np.full((*size, 3), shade, np.uint8))
    assert ok
    return data.tobytes()


def heading(theta: float) -> dict[str, float]:
    return {"x": 0.0, "y": 0.0, "z": math.sin(theta / 2), "w": math.cos(theta / 2)}


class Ros2Log:
    """Writes a ROS 2 log; times are seconds after START, log times those plus ``lag``."""

    def __init__(self, path: Path, **options: Any) -> None:
        self.path = path
        self.file = path.open("wb")
        self.writer = Ros2Writer(self.file, **options)
        self.schemas: dict[str, Any] = {}

    def put(self, topic: str, name: str, message: dict[str, Any], log: float) -> None:
        if name not in self.schemas:
            self.schemas[name] = self.writer.register_msgdef(name, DEFINITIONS[name])
        when = START + round(log * SECOND)
        self.writer.write_message(topic, self.schemas[name], message, when, when)

    def header(self, t: float | None, frame: str) -> dict[str, Any]:
        stamp = 0 if t is None else START + round(t * SECOND)
        return {
            "stamp": {"sec": stamp // SECOND, "nanosec": stamp % SECOND},
            "frame_id": frame,
        }

    def image(self, t: float, data: bytes, lag: float = 0.0, topic: str = "/image") -> None:
        message = {"header": self.header(t, "cam"), "format": "jpeg", "data": data}
        self.put(topic, "sensor_msgs/msg/CompressedImage", message, t + lag)

    def raw(self, t: float, encoding: str, height: int, width: int, step: int, data: bytes) -> None:
        message = {
            "header": self.header(t, "cam"),
            "height": height,
            "width": width,
            "encoding": encoding,
            "step": step,
            "data": data,
        }
        self.put("/raw", "sensor_msgs/msg/Image", message, t)

    def scan(
        self,
        t: float,
        ranges: list[float],
        first: float = -1.0,
        step: float = 0.5,
        lag: float = 0.0,
        frame: str = "laser",
        topic: str = "/scan",
        stamped: bool = True,
    ) -> None:
        message = {
            "header": self.header(t if stamped else None, frame),
            "angle_min": first,
            "angle_increment": step,
            "range_min": 0.1,
            "range_max": 10.0,
            "ranges": ranges,
        }
        self.put(topic, "sensor_msgs/msg/LaserScan", message, t + lag)

    def odom(self, t: float, x: float, y: float, theta: float, topic: str = "/odom") -> None:
        pose = {"position": {"x": x, "y": y, "z": 0.0}, "orientation": heading(theta)}
        message = {
            "header": self.header(t, "odom"),
            "child_frame_id": "base_link",
            "pose": {"pose": pose},
        }
        self.put(topic, "nav_msgs/msg/Odometry", message, t)

    def pose(
        self,
        t: float,
        x: float,
        y: float,
        theta: float,
        covariance: bool = False,
        frame: str = "map",
    ) -> None:
        pose: dict[str, Any] = {"position": {"x": x, "y": y}, "orientation": heading(theta)}
        kind = "PoseWithCovarianceStamped" if covariance else "PoseStamped"
        message = {
            "header": self.header(t, frame),
            "pose": {"pose": pose} if covariance else pose,
        }
        self.put("/where", f"geometry_msgs/msg/{kind}", message, t)

    def transform(
        self,
        t: float,
        parent: str,
        child: str,
        xyz: tuple[float, float, float],
        rotation: dict[str, float],
        topic: str = "/tf_static",
    ) -> None:
        one = {
            "header": self.header(t, parent),
            "child_frame_id": child,
            "transform": {
                "translation": dict(zip("xyz", xyz, strict=True)),
                "rotation": rotation,
            },
        }
        self.put(topic, "tf2_msgs/msg/TFMessage", {"transforms": [one]}, t)

    def string(self, t: float, text: str, topic: str = "/label") -> None:
        self.put(topic, "std_msgs/msg/String", {"data": text}, t)

    def close(self) -> str:
        self.writer.finish()
        self.file.close()
        return str(self.path)


class JsonLog:
    """Writes a log of JSON messages; times are seconds after START."""

    def __init__(self, path: Path, **options: Any) -> None:
        self.path = path
        self.file = path.open("wb")
        self.writer = Writer(self.file, **options)
        self.writer.start()
        self.channels: dict[tuple[str, str], int] = {}

    def put(self, topic: str, name: str, message: Any, t: float) -> None:
        if (topic, name) not in self.channels:
            schema = self.writer.register_schema(name, "jsonschema", b'{"type":"object"}')
            self.channels[topic, name] = self.writer.register_channel(topic, "json", schema)
        data = message if isinstance(message, bytes) else json.dumps(message).encode()
        when = START + round(t * SECOND)
        self.writer.add_message(self.channels[topic, name], when, data, when)

    @staticmethod
    def time(t: float) -> dict[str, int]:
        stamp = START + round(t * SECOND)
        return {"sec": stamp // SECOND, "nsec": stamp % SECOND}

    def scan(self, t: float, ranges: list[Any], **more: Any) -> None:
        pose = {"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": heading(0.0)}
        message = {
            "timestamp": self.time(t),
            "frame_id": "laser",
            "pose": pose,
            "start_angle": -1.0,
            "end_angle": 1.0,
            "ranges": ranges,
            "intensities": [],
            **more,
        }
        self.put("/scan", "foxglove.LaserScan", message, t)

    def close(self) -> str:
        self.writer.finish()
        self.file.close()
        return str(self.path)


MOUNT = Pose2D(0.25, -0.5, 0.75, "base_link")


def scan_of(ranges: list[float], mount: Pose2D = MOUNT) -> LaserScan:
    angles = np.linspace(-1.5, 1.5, len(ranges))
    return LaserScan(angles, np.array(ranges), 0.05, 32.0, mount)


def walk(count: int = 6) -> list[Observation]:
    labels = [None, "office", "office", "corridor", None, "lab"]
    return [
        Observation(
            START + i * 200_000_000 + i,
            image=EncodedImage(jpeg(20 * i)),
            scan=scan_of([1.0 + i, 2.0, math.inf, math.nan, 0.0]),
            pose=Pose2D(0.1 * i, -1 / 3, 0.3 * i - 1, "odom"),
            label=labels[i % 6],
        )
        for i in range(count)
    ]


def fits(value: Any, schema: dict[str, Any]) -> bool:
    kinds = {"object": dict, "array": list, "string": str, "boolean": bool}
    kind = schema["type"]
    if kind in ("number", "integer"):
        # Lengths that JSON has no number for are words, as in protobuf's JSON.
        words = kind == "number" and value in ("NaN", "Infinity", "-Infinity")
        whole = isinstance(value, int) and not isinstance(value, bool)
        return words or whole or (kind == "number" and isinstance(value, float))
    if not isinstance(value, kinds[kind]):
        return False
    if kind == "array":
        return all(fits(each, schema["items"]) for each in value)
    if kind == "object":
        known, rest = schema["properties"], schema.get("additionalProperties")
        return all(name in value for name in schema.get("required", [])) and all(
            fits(each, known.get(name, rest)) if name in known or rest else True
            for name, each in value.items()
        )
    return True


def json_messages(path: str) -> list[tuple[str, str, Any]]:
    """Return topic, schema name and message, after checking the message against its schema."""
    found = []
    with Path(path).open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if channel.message_encoding == "json":
                assert schema is not None
                value = json.loads(message.data, parse_constant=pytest.fail)
                assert fits(value, json.loads(schema.data)), (schema.name, value)
                found.append((channel.topic, schema.name, value))
    return found


def told_messages(path: str) -> list[tuple[str, str, Any]]:
    """Return topic, schema name and message of what placecue said, JSON or ROS 2, as plain data."""
    found = []
    with Path(path).open("rb") as file:
        reader = make_reader(file, decoder_factories=[Ros2DecoderFactory()])
        for schema, channel, _, decoded in reader.iter_decoded_messages(topics=ros_topics(path)):
            value = as_data(decoded)
            if schema.name == "placecue_msgs/msg/Belief":
                value["scores"] = dict(zip(value.pop("columns"), value["scores"], strict=True))
            elif channel.topic == "/placecue/map":
                value = json.loads(value["json"])
            found.append((channel.topic, schema.name, value))
    return [*json_messages(path), *found]


def ros_topics(path: str) -> list[str]:
    with Path(path).open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    channels = summary.channels.values()
    told = [each for each in channels if each.topic.startswith("/placecue/")]
    return [each.topic for each in told if each.message_encoding == "cdr"] or ["/none"]


def as_data(value: Any) -> Any:
    """Return a decoded ROS message as nested dicts."""
    if isinstance(value, list):
        return [as_data(each) for each in value]
    names = getattr(value, "__slots__", ())
    return {name: as_data(getattr(value, name)) for name in names} if names else value
