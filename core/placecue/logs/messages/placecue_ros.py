"""What placecue says, as ROS 2 messages: beliefs, areas, the map, and scenes for viewers.

A log of ROS stays one that ROS tools read: every channel is CDR, its definitions are in the file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, partial
from typing import Any

from placecue.logs.messages.cdr import CdrBuilder
from placecue.logs.messages.kinds import MessageType
from placecue.logs.messages.ros_definitions import FIELDS, SEPARATOR

_SHAPE = "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\n"
_COLOURED = "foxglove_msgs/Color color\nfoxglove_msgs/Color[] colors\nuint32[] indices"
#: Fields of each message; those of scenes as in foxglove_msgs.
OWN: dict[str, str] = {
    "placecue_msgs/Belief": (
        "builtin_interfaces/Time timestamp\nint64 stamp\nstring label\nfloat64 confidence\n"
        "string[] columns\nfloat64[] scores\nstring[] cues_used"
    ),
    "placecue_msgs/AreaUpdate": (
        "builtin_interfaces/Time timestamp\nint64 stamp\nint64 area\nstring label\n"
        "float64 confidence\nbool finished"
    ),
    "placecue_msgs/SemanticMap": "string json",
    "foxglove_msgs/SceneUpdate": (
        "foxglove_msgs/SceneEntityDeletion[] deletions\nfoxglove_msgs/SceneEntity[] entities"
    ),
    "foxglove_msgs/SceneEntityDeletion": (
        "builtin_interfaces/Time timestamp\nuint8 type\nstring id"
    ),
    "foxglove_msgs/SceneEntity": (
        "builtin_interfaces/Time timestamp\nstring frame_id\nstring id\n"
        "builtin_interfaces/Duration lifetime\nbool frame_locked\n"
        "foxglove_msgs/KeyValuePair[] metadata\nfoxglove_msgs/ArrowPrimitive[] arrows\n"
        "foxglove_msgs/CubePrimitive[] cubes\nfoxglove_msgs/SpherePrimitive[] spheres\n"
        "foxglove_msgs/CylinderPrimitive[] cylinders\nfoxglove_msgs/LinePrimitive[] lines\n"
        "foxglove_msgs/TriangleListPrimitive[] triangles\nfoxglove_msgs/TextPrimitive[] texts\n"
        "foxglove_msgs/ModelPrimitive[] models"
    ),
    "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
    "foxglove_msgs/KeyValuePair": "string key\nstring value",
    "foxglove_msgs/ArrowPrimitive": (
        "geometry_msgs/Pose pose\nfloat64 shaft_length\nfloat64 shaft_diameter\n"
        "float64 head_length\nfloat64 head_diameter\nfoxglove_msgs/Color color"
    ),
    "foxglove_msgs/CubePrimitive": f"{_SHAPE}foxglove_msgs/Color color",
    "foxglove_msgs/SpherePrimitive": f"{_SHAPE}foxglove_msgs/Color color",
    "foxglove_msgs/CylinderPrimitive": (
        f"{_SHAPE}float64 bottom_scale\nfloat64 top_scale\nfoxglove_msgs/Color color"
    ),
    "foxglove_msgs/LinePrimitive": (
        "uint8 type\ngeometry_msgs/Pose pose\nfloat64 thickness\nbool scale_invariant\n"
        f"geometry_msgs/Point[] points\n{_COLOURED}"
    ),
    "foxglove_msgs/TriangleListPrimitive": (
        f"geometry_msgs/Pose pose\ngeometry_msgs/Point[] points\n{_COLOURED}"
    ),
    "foxglove_msgs/TextPrimitive": (
        "geometry_msgs/Pose pose\nbool billboard\nfloat64 font_size\nbool scale_invariant\n"
        "foxglove_msgs/Color color\nstring text"
    ),
    "foxglove_msgs/ModelPrimitive": (
        "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nfoxglove_msgs/Color color\n"
        "bool override_color\nstring url\nstring media_type\nuint8[] data"
    ),
    "foxglove_msgs/Color": "float64 r\nfloat64 g\nfloat64 b\nfloat64 a",
}
ALL = {**FIELDS, **OWN}
#: Letters of :mod:`struct` for the primitives.
PRIMITIVES = {"int32": "i", "uint32": "I", "int64": "q", "float64": "d", "uint8": "B", "bool": "B"}


@cache
def message_type(name: str) -> MessageType:
    """Return the type of a message of :data:`OWN`."""
    order = [name]
    for each in order:  # grows while it is walked
        kinds = {kind.removesuffix("[]"): None for kind, _ in _fields(each)}
        order += [inner for inner in kinds if inner in ALL and inner not in order]
    parts = [ALL[name], *(f"MSG: {each}\n{ALL[each]}" for each in order[1:])]
    text = SEPARATOR.join(parts) + "\n"
    full = name.replace("/", "/msg/")
    return MessageType(full, "cdr", "ros2msg", text.encode(), partial(serialise, name))


def serialise(name: str, fields: Mapping[str, Any]) -> bytes:
    """Return a message in CDR.

    Parameters
    ----------
    name : str
        A message of :data:`OWN`.
    fields : mapping
        Its fields, nested, all of them; a time may call its rest ``nsec``, as Foxglove does.
    """
    out = CdrBuilder()
    _put(out, name, fields)
    return out.finished()


@cache
def _fields(name: str) -> Sequence[tuple[str, str]]:
    lines = (line.split() for line in ALL[name].splitlines())
    return tuple((words[0], words[1]) for words in lines)


def _put(out: CdrBuilder, kind: str, value: Any) -> None:
    if kind.endswith("[]"):
        out.numbers("I", len(value))
        for each in value:
            _put(out, kind[:-2], each)
    elif kind == "string":
        out.text(value)
    elif kind in PRIMITIVES:
        out.numbers(PRIMITIVES[kind], value)
    else:
        for inner, name in _fields(kind):
            _put(out, inner, value["nsec"] if name == "nanosec" else value[name])
