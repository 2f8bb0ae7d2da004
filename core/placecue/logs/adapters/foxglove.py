"""Foxglove's own messages, in JSON or protobuf, and placecue's label events in JSON."""

from __future__ import annotations

from base64 import b64decode
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.contracts.words import shown
from placecue.errors import UnusableObservation, described
from placecue.logs.adapters.base import Adapter, Role, increasing, stated
from placecue.logs.messages.geometry import Transform, flatten, yaw
from placecue.logs.messages.images import RawImage, ReorderedImage, compressed
from placecue.observation import EncodedImage, LaserScan, Pose2D

ENCODINGS = ("json", "protobuf")


class FoxgloveAdapter(Adapter):
    """A message with ``timestamp`` and ``frame_id``."""

    encodings: ClassVar[tuple[str, ...]] = ENCODINGS

    def stamp(self, message: Any) -> int:
        """Return the timestamp, ns."""
        return nanoseconds(message["timestamp"])

    def frame(self, message: Any) -> str:
        """Return the frame of reference."""
        return _text(message["frame_id"]).lstrip("/")


def nanoseconds(time: Any) -> int:
    """Return a Foxglove time in ns."""
    if isinstance(time, str):
        raise TypeError(f"the time is the text {shown(time)}, where sec and nsec are due")
    return int(time["sec"]) * 1_000_000_000 + int(time["nsec"])


def content(data: str | bytes) -> bytes:
    """Return the bytes of a field, which JSON holds in base 64."""
    if not isinstance(data, str | bytes):
        raise TypeError(f"the data are {described(data)}, not in base 64")
    return b64decode(data) if isinstance(data, str) else data


class FoxgloveCompressedImage(FoxgloveAdapter):
    """foxglove.CompressedImage."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.CompressedImage",)
    role: ClassVar[Role] = "image"

    def value(self, message: Any, origin: str) -> EncodedImage | ReorderedImage:
        """Return the image, undecoded."""
        return compressed(content(message["data"]), _text(message["format"]), origin)


class FoxgloveRawImage(FoxgloveAdapter):
    """foxglove.RawImage."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.RawImage",)
    role: ClassVar[Role] = "image"

    def value(self, message: Any, origin: str) -> RawImage:
        """Return the image, unconverted."""
        height, width, step = (_whole(message[name]) for name in ("height", "width", "step"))
        encoding = _text(message["encoding"])
        return RawImage(content(message["data"]), height, width, step, encoding, origin)

    def pixels(self, message: Any) -> str:
        """Return the pixel format."""
        return str(message["encoding"])


class FoxgloveLaserScan(FoxgloveAdapter):
    """foxglove.LaserScan.

    The schema has no limits of range; where the message has ``range_min`` and ``range_max`` all
    the same (placecue writes them) they are taken, else the maximum is NaN and the reader fills
    it in. Lengths that JSON cannot hold are null or the words NaN, Infinity, -Infinity.
    """

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.LaserScan",)
    role: ClassVar[Role] = "scan"

    def value(self, message: Any, origin: str) -> LaserScan:
        """Return the scan in its own frame, with its angles increasing."""
        lengths = message["ranges"]
        steps = max(len(lengths) - 1, 1)
        first = float(message["start_angle"])
        angles, ranges = increasing(
            first,
            (float(message["end_angle"]) - first) / steps,
            _lengths(lengths),
            origin,
        )
        scan = LaserScan(
            angles,
            ranges,
            float(message.get("range_min", 0.0)),
            stated(float(message.get("range_max", "nan"))),
        )
        return _placed(scan, message["pose"], self.frame(message))


class FoxglovePoseInFrame(FoxgloveAdapter):
    """foxglove.PoseInFrame."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.PoseInFrame",)
    role: ClassVar[Role] = "pose"

    def value(self, message: Any, origin: str) -> Pose2D:
        """Return the pose in the plane."""
        return _planar(message["pose"], self.frame(message))

    def is_turned(self, message: Any) -> bool:
        """Tell whether the quaternion is not zero."""
        return any(_xyzw(message["pose"]["orientation"]))


class FoxgloveFrameTransform(FoxgloveAdapter):
    """foxglove.FrameTransform."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.FrameTransform",)
    role: ClassVar[Role] = "transform"

    def value(self, message: Any, origin: str) -> list[Transform]:
        """Return the one transform."""
        return [_transform(message)]


class FoxgloveFrameTransforms(Adapter):
    """foxglove.FrameTransforms."""

    encodings: ClassVar[tuple[str, ...]] = ENCODINGS
    schemas: ClassVar[tuple[str, ...]] = ("foxglove.FrameTransforms",)
    role: ClassVar[Role] = "transform"

    def stamp(self, message: Any) -> int:
        """Return the timestamp of the first transform, ns."""
        transforms = message["transforms"]
        return nanoseconds(transforms[0]["timestamp"]) if transforms else 0

    def value(self, message: Any, origin: str) -> list[Transform]:
        """Return the transforms."""
        return [_transform(each) for each in message["transforms"]]


class PlacecueLabel(Adapter):
    """placecue.Label: ``{"stamp": ns, "label": "office"}``, which holds until the next one."""

    encodings: ClassVar[tuple[str, ...]] = ("json",)
    schemas: ClassVar[tuple[str, ...]] = ("placecue.Label",)
    role: ClassVar[Role] = "label"

    def stamp(self, message: Any) -> int:
        """Return the stamp, ns."""
        return int(message["stamp"])

    def value(self, message: Any, origin: str) -> str:
        """Return the label; empty where a label ends."""
        label = message["label"]
        if not isinstance(label, str):
            raise UnusableObservation(f"{origin}: the label is {label!r}, not a text")
        return label.strip()


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{described(value)} where a text is due")
    return value


def _whole(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise TypeError(f"{shown(value)} where a size is due")
    return value


def _placed(scan: LaserScan, pose: Any, frame: str) -> LaserScan:
    """Return a scan where its message says that it lies in its frame.

    Upside down its angles run clockwise; seen from above they are mirrored.
    """
    matrix = Transform("", "", _xyz(pose["position"]), _xyzw(pose["orientation"])).matrix()
    mount = flatten(matrix, frame)
    if matrix[2, 2] >= 0.0:
        return replace(scan, mount=mount)
    angles, ranges = -scan.angles[::-1], scan.ranges[::-1].copy()
    return replace(scan, angles=angles, ranges=ranges, mount=mount)


def _lengths(lengths: Any) -> NDArray[np.float64]:
    if not isinstance(lengths, list):  # protobuf has a number for everything
        return np.array(lengths, dtype=np.float64)
    return np.array([np.nan if each is None else float(each) for each in lengths])


def _planar(pose: Any, frame: str) -> Pose2D:
    x, y, _ = _xyz(pose["position"])
    return Pose2D(
        x,
        y,
        yaw(*_xyzw(pose["orientation"])),
        frame,
    )


def _transform(message: Any) -> Transform:
    return Transform(
        parent=_text(message["parent_frame_id"]).lstrip("/"),
        child=_text(message["child_frame_id"]).lstrip("/"),
        translation=_xyz(message["translation"]),
        rotation=_xyzw(message["rotation"]),
        stamp=nanoseconds(message["timestamp"]),
    )


def _xyz(vector: Any) -> tuple[float, float, float]:
    return float(vector["x"]), float(vector["y"]), float(vector["z"])


def _xyzw(rotation: Any) -> tuple[float, float, float, float]:
    x, y, z, w = (float(rotation[axis]) for axis in "xyzw")
    return x, y, z, w
