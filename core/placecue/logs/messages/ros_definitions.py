"""ROS message definitions: those of the messages that placecue knows, and whether one is such."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TypeAlias

#: Fields of each message, as in ROS 2's own .msg files; ROS 1's are the same but for the header.
FIELDS: dict[str, str] = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/String": "string data",
    "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "sensor_msgs/Image": (
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
        "uint8 is_bigendian\nuint32 step\nuint8[] data"
    ),
    "sensor_msgs/CameraInfo": (
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n"
        "float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\n"
        "uint32 binning_y\nsensor_msgs/RegionOfInterest roi"
    ),
    "sensor_msgs/RegionOfInterest": (
        "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify"
    ),
    "sensor_msgs/LaserScan": (
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
        "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
        "float32[] ranges\nfloat32[] intensities"
    ),
    "nav_msgs/Odometry": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
        "geometry_msgs/TwistWithCovariance twist"
    ),
    "geometry_msgs/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose",
    "geometry_msgs/PoseWithCovarianceStamped": (
        "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose"
    ),
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "tf/tfMessage": "geometry_msgs/TransformStamped[] transforms",
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform"
    ),
    "geometry_msgs/Transform": (
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation"
    ),
}
#: ROS 1's header begins with a running number, and its stamp is a type of its own.
ROS1_FIELDS = {**FIELDS, "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id"}
SEPARATOR = "\n" + "=" * 80 + "\n"
#: Fields of a message: type, name (lower case, for ROS 1 has K where ROS 2 has k).
Fields: TypeAlias = list[tuple[str, str]]


def definition(name: str) -> str:
    """Return ROS 2's full definition of a message, followed by those of the messages inside it."""
    order = [name]
    for each in order:  # grows while it is walked
        types = {line.split()[0].split("[")[0]: None for line in FIELDS[each].splitlines()}
        order += [inner for inner in types if inner in FIELDS and inner not in order]
    inner = (f"MSG: {each}\n{FIELDS[each]}" for each in order[1:])
    return SEPARATOR.join([FIELDS[name], *inner]) + "\n"


@lru_cache(maxsize=64)  # every reader of a topic asks, and parsing takes milliseconds
def is_standard(name: str, text: bytes, language: str) -> bool:
    """Tell whether a definition has the fields that the message has in ROS itself.

    Comments, constants and default values do not count. An empty definition is taken for the
    standard one: some recorders do not find the definitions.

    Parameters
    ----------
    name : str
        Short name of a message of :data:`FIELDS`, such as ``sensor_msgs/LaserScan``.
    text : bytes
        The definition and those of the messages inside it, as a schema has them.
    language : str
        ``ros2msg`` or ``ros1msg``.
    """
    try:
        content = text.decode()
    except UnicodeDecodeError:
        return False
    if not content.strip():
        return True
    standard = ROS1_FIELDS if language == "ros1msg" else FIELDS
    given = _messages(name, content.replace("roslib/Header", "std_msgs/Header"))  # its old place
    return _same(name, given, {each: _fields(each, fields) for each, fields in standard.items()})


def _same(name: str, given: dict[str, Fields], standard: dict[str, Fields]) -> bool:
    """Compare a message and all that is inside it."""
    if name not in standard:
        return name not in given  # a primitive
    if name == "builtin_interfaces/Time" and name not in given:
        return True  # often left out, as it is part of the language
    if given.get(name) != standard[name]:
        return False
    return all(_same(_bare(kind), given, standard) for kind, _ in standard[name])


def _messages(name: str, text: str) -> dict[str, Fields]:
    """Return the fields of each message of a definition."""
    found: dict[str, Fields] = {}
    for number, part in enumerate(re.split(r"^={3,}\s*$", text, flags=re.MULTILINE)):
        head = re.match(r"\s*MSG:\s*(\S+)\s*$", part, flags=re.MULTILINE)
        if head is not None:
            name, part = head.group(1).replace("/msg/", "/"), part[head.end() :]
        elif number:
            continue
        found[name] = _fields(name, part)
    return found


def _fields(name: str, text: str) -> Fields:
    found: Fields = []
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if len(words) >= 2 and not any("=" in word for word in words[1:3]):  # else a constant
            found.append((_full(words[0], name), words[1].lower()))
    return found


def _full(kind: str, name: str) -> str:
    """Return a type with its package."""
    kind = kind.replace("/msg/", "/")
    if kind == "Header":
        return "std_msgs/Header"
    package = name.partition("/")[0]
    return f"{package}/{kind}" if kind[:1].isupper() and "/" not in kind else kind


def _bare(kind: str) -> str:
    return kind.partition("[")[0]
