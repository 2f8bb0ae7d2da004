"""ROS messages read and written directly, against mcap_ros2 and rosbags."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.records import Schema
from mcap_ros2._dynamic import serialize_dynamic
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mcap_logs import DEFINITIONS
from placecue.logs.messages.cdr import WRITERS, serialise
from placecue.logs.messages.direct import READERS, direct_decoder
from placecue.logs.messages.ros_definitions import definition, is_standard

ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
ROS1.register(
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)
float64 = st.floats(allow_nan=False, width=64)
float32 = st.floats(allow_nan=False, width=32)
uint32 = st.integers(0, 2**32 - 1)
names = st.text(max_size=9).filter(lambda text: "\0" not in text)
headers = st.fixed_dictionaries(
    {
        "stamp": st.fixed_dictionaries({"sec": st.integers(0, 2**31 - 1), "nanosec": uint32}),
        "frame_id": names,
    }
)
vectors = st.fixed_dictionaries(dict.fromkeys("xyz", float64))
rotations = st.fixed_dictionaries(dict.fromkeys("xyzw", float64))
poses = st.fixed_dictionaries({"position": vectors, "orientation": rotations})
uncertain = st.fixed_dictionaries({"pose": poses})
SCAN_NUMBERS = ["angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"]
SCAN_NUMBERS += ["range_min", "range_max"]
MESSAGES: dict[str, Any] = {
    "sensor_msgs/LaserScan": {
        "header": headers,
        **dict.fromkeys(SCAN_NUMBERS, float32),
        "ranges": st.lists(float32, max_size=9),
        "intensities": st.lists(float32, max_size=3),
    },
    "sensor_msgs/CompressedImage": {"header": headers, "format": names, "data": st.binary()},
    "sensor_msgs/Image": {
        "header": headers,
        "height": uint32,
        "width": uint32,
        "encoding": names,
        "is_bigendian": st.integers(0, 255),
        "step": uint32,
        "data": st.binary(),
    },
    "nav_msgs/Odometry": {"header": headers, "child_frame_id": names, "pose": uncertain},
    "geometry_msgs/PoseStamped": {"header": headers, "pose": poses},
    "geometry_msgs/PoseWithCovarianceStamped": {"header": headers, "pose": uncertain},
    "tf2_msgs/TFMessage": {
        "transforms": st.lists(
            st.fixed_dictionaries(
                {
                    "header": headers,
                    "child_frame_id": names,
                    "transform": st.fixed_dictionaries(
                        {"translation": vectors, "rotation": rotations}
                    ),
                }
            ),
            max_size=3,
        )
    },
    "std_msgs/String": {"data": names},
}


def schema_of(name: str, text: str, language: str = "ros2msg") -> Schema:
    return Schema(id=1, name=name, encoding=language, data=text.encode())


def same(ours: Any, theirs: Any) -> bool:
    """Compare a message of ours, field by field, with another's, which may have more."""
    if hasattr(ours, "_fields"):
        return all(
            same(getattr(ours, name), getattr(theirs, name))
            for name in ours._fields
            if hasattr(theirs, name) or ours._fields != ("header", "child_frame_id", "pose")
        )
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(map(same, ours, theirs))
    if isinstance(ours, bytes):
        return ours == bytes(theirs)
    if isinstance(ours, np.ndarray):
        return np.array_equal(ours, np.asarray(theirs, dtype=np.float32))
    return bool(ours == theirs)


@pytest.mark.parametrize("name", MESSAGES)
def test_cdr_is_read_as_mcap_ros2_reads_it(name: str) -> None:
    full, text = name.replace("/", "/msg/"), definition(name)
    schema = schema_of(full, text)
    encode = serialize_dynamic(full, text)[full]
    theirs, ours = DecoderFactory().decoder_for("cdr", schema), direct_decoder("cdr", schema)
    assert theirs is not None
    assert ours is not None

    @settings(max_examples=60, deadline=None)
    @given(st.fixed_dictionaries(MESSAGES[name]))
    def check(message: dict[str, Any]) -> None:
        data = encode(message)
        assert same(ours(data), theirs(data))
        if name in WRITERS and not message.get("intensities"):
            assert serialise(name, message) == data

    check()


def built(store: Any, name: str, fields: Any, **more: Any) -> Any:
    """Build a message of rosbags' classes from nested dicts."""
    kind = store.types[name]
    values: dict[str, Any] = {}
    for field, (node, inner) in store.get_msgdef(name).fields:
        given = fields.get(field)
        if node == 2:  # another message
            values[field] = built(store, inner, given or {}, **more)
        elif node == 1:
            values[field] = given if given is not None else more.get(inner[0], 0)
        elif isinstance(given, bytes):
            values[field] = np.frombuffer(given, np.uint8)
        elif given and isinstance(given[0], dict):
            values[field] = [built(store, inner[0][1], each, **more) for each in given]
        elif inner[0][0] == 1 and inner[0][1][0] != "string":
            length = inner[1] if node == 3 else 0
            values[field] = np.array(given or [0] * length, dtype=inner[0][1][0])
        else:
            values[field] = given or []
    return kind(**values)


@pytest.mark.parametrize("language", ["cdr, big-endian", "cdr, little-endian", "ros1"])
@pytest.mark.parametrize("name", MESSAGES)
def test_messages_that_rosbags_writes(name: str, language: str) -> None:
    store = ROS1 if language == "ros1" else ROS2
    full = name.replace("/", "/msg/")
    text, _ = store.generate_msgdef(full, ros_version=1 if language == "ros1" else 2)
    schema = schema_of(name, text, "ros1msg" if language == "ros1" else "ros2msg")
    ours = direct_decoder("ros1" if language == "ros1" else "cdr", schema)
    assert ours is not None

    @settings(max_examples=25, deadline=None)
    @given(st.fixed_dictionaries(MESSAGES[name]))
    def check(fields: dict[str, Any]) -> None:
        message = built(store, full, fields, string="")
        if language == "ros1":
            data = bytes(store.serialize_ros1(message, full))
        else:
            little = language.endswith("little-endian")
            data = bytes(store.serialize_cdr(message, full, little_endian=little))
        assert same(ours(data), message)

    check()


@pytest.mark.parametrize("name", DEFINITIONS)
def test_definitions_of_other_writers_are_recognised(name: str) -> None:
    assert is_standard(name.replace("/msg/", "/"), DEFINITIONS[name].encode(), "ros2msg")


@pytest.mark.parametrize("store", [ROS1, ROS2], ids=["ros1", "ros2"])
@pytest.mark.parametrize("name", sorted(set(READERS) - {"tf/tfMessage"}))
def test_definitions_of_rosbags_are_recognised(name: str, store: Any) -> None:
    version = 1 if store is ROS1 else 2
    text, _ = store.generate_msgdef(name.replace("/", "/msg/"), ros_version=version)
    assert is_standard(name, text.encode(), f"ros{version}msg")


SCAN = definition("sensor_msgs/LaserScan")


@pytest.mark.parametrize(
    ("text", "standard"),
    [
        (SCAN, True),
        ("# a comment\nuint8 KIND=3\n\n" + SCAN.replace("ranges", "ranges # in m"), True),
        ("", True),
        (
            SCAN.replace(
                "float32 range_min\nfloat32 range_max", "float32 range_max\nfloat32 range_min"
            ),
            False,
        ),
        (SCAN.replace("float32[] ranges", "float64[] ranges"), False),
        (SCAN.replace("string frame_id", "string frame_id\nstring more"), False),
        (SCAN.split("=" * 80)[0], False),
    ],
)
def test_only_standard_definitions_are_read_directly(text: str, standard: bool) -> None:
    schema = schema_of("sensor_msgs/msg/LaserScan", text)
    assert (direct_decoder("cdr", schema) is not None) is standard


def test_another_definition_goes_to_the_other_decoder(ros2: Any, monkeypatch: Any) -> None:
    from placecue.logs import open_log

    other = DEFINITIONS["sensor_msgs/msg/LaserScan"].replace("float32[] ranges", "float64[] ranges")
    monkeypatch.setitem(DEFINITIONS, "sensor_msgs/msg/LaserScan", other)
    log = ros2()
    log.scan(0.0, [1.0, 2.5, 1 / 3])
    (observation,) = open_log(log.close())
    assert observation.scan is not None
    assert observation.scan.ranges.tolist() == [1.0, 2.5, 1 / 3]  # more than a float32 holds


@pytest.mark.parametrize("name", MESSAGES)
def test_cut_messages_are_refused(name: str) -> None:
    full, text = name.replace("/", "/msg/"), definition(name)
    decode = direct_decoder("cdr", schema_of(full, text))
    assert decode is not None
    data = serialize_dynamic(full, text)[full](
        {"transforms": [{}], "data": "x"} if "/TF" in name or "String" in name else {}
    )
    decode(data)
    for size in range(len(data)):
        with pytest.raises((ValueError, struct.error)):
            decode(data[:size])
