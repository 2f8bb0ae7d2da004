"""The messages that placecue writes, into CDR: the same bytes as mcap_ros2's encoder, faster."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

#: Little-endian CDR.
ENCAPSULATION = b"\0\1\0\0"


class CdrBuilder:
    """Bytes of a message, to which fields are added one after the other."""

    def __init__(self) -> None:
        self.data = bytearray()

    def align(self, size: int) -> None:
        """Fill up to the next multiple of the size, from the first field on."""
        self.data += bytes(-len(self.data) % size)

    def numbers(self, kind: str, *values: Any) -> None:
        """Add numbers of one kind, as :mod:`struct` names it."""
        form = struct.Struct(f"<{len(values)}{kind}")
        self.align(form.size // len(values))
        self.data += form.pack(*values)

    def text(self, value: str) -> None:
        """Add a string."""
        self.content(value.encode() + b"\0")

    def content(self, value: bytes) -> None:
        """Add a sequence of bytes."""
        self.numbers("I", len(value))
        self.data += value

    def floats(self, values: Any) -> None:
        """Add a sequence of float32."""
        self.numbers("I", len(values))
        self.data += np.asarray(values, dtype="<f4").tobytes()

    def finished(self) -> bytes:
        """Return the message."""
        return ENCAPSULATION + bytes(self.data)


Fields = Mapping[str, Any]


def _header(out: CdrBuilder, header: Fields) -> None:
    out.numbers("i", header["stamp"]["sec"])
    out.numbers("I", header["stamp"]["nanosec"])
    out.text(header["frame_id"])


def _place(out: CdrBuilder, vector: Fields, rotation: Fields) -> None:
    out.numbers("d", *(vector.get(axis, 0.0) for axis in "xyz"))
    out.numbers("d", *(rotation.get(axis, float(axis == "w")) for axis in "xyzw"))


def _laser_scan(out: CdrBuilder, scan: Fields) -> None:
    _header(out, scan["header"])
    names = "angle_min angle_max angle_increment time_increment scan_time range_min range_max"
    out.numbers("f", *(scan.get(name, 0.0) for name in names.split()))
    out.floats(scan["ranges"])
    out.floats(scan.get("intensities", ()))


def _compressed_image(out: CdrBuilder, image: Fields) -> None:
    _header(out, image["header"])
    out.text(image["format"])
    out.content(image["data"])


def _odometry(out: CdrBuilder, odometry: Fields) -> None:
    _header(out, odometry["header"])
    out.text(odometry["child_frame_id"])
    pose = odometry["pose"]["pose"]
    _place(out, pose["position"], pose["orientation"])
    out.numbers("d", *[0.0] * (36 + 6 + 36))  # covariance, twist, its covariance


def _transforms(out: CdrBuilder, message: Fields) -> None:
    out.numbers("I", len(message["transforms"]))
    for each in message["transforms"]:
        _header(out, each["header"])
        out.text(each["child_frame_id"])
        _place(out, each["transform"]["translation"], each["transform"]["rotation"])


def _camera_info(out: CdrBuilder, info: Fields) -> None:
    _header(out, info["header"])
    out.numbers("I", info["height"], info["width"])
    out.text(info["distortion_model"])
    out.numbers("I", len(info["d"]))
    out.numbers("d", *info["d"], *info["k"], *info["r"], *info["p"])
    out.numbers("I", *[0] * (2 + 4))  # binning, region of interest
    out.numbers("B", 0)


def _string(out: CdrBuilder, message: Fields) -> None:
    out.text(message["data"])


WRITERS: dict[str, Callable[[CdrBuilder, Fields], None]] = {
    "sensor_msgs/LaserScan": _laser_scan,
    "sensor_msgs/CompressedImage": _compressed_image,
    "sensor_msgs/CameraInfo": _camera_info,
    "nav_msgs/Odometry": _odometry,
    "tf2_msgs/TFMessage": _transforms,
    "std_msgs/String": _string,
}


def serialise(name: str, fields: Fields) -> bytes:
    """Return a message in CDR.

    Parameters
    ----------
    name : str
        Short name of a message of :data:`WRITERS`.
    fields : mapping
        Its fields, nested; those left out are zero, and rotations the identity.
    """
    out = CdrBuilder()
    WRITERS[name](out, fields)
    return out.finished()
