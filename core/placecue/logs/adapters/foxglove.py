"""Foxglove's own messages, in JSON or protobuf, and placecue's label events in JSON."""

from __future__ import annotations

from base64 import b64decode
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UnusableObservation
from placecue.logs.adapters.base import Adapter, Role, increasing
from placecue.logs.messages.geometry import Transform, yaw
from placecue.logs.messages.images import RawImage
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
        return str(message["frame_id"]).lstrip("/")


def nanoseconds(time: Any) -> int:
    """Return a Foxglove time in ns."""
    return int(time["sec"]) * 1_000_000_000 + int(time["nsec"])


def content(data: str | bytes) -> bytes:
    """Return the bytes of a field, which JSON holds in base 64."""
    return b64decode(data) if isinstance(data, str) else data


class FoxgloveCompressedImage(FoxgloveAdapter):
    """foxglove.CompressedImage."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.CompressedImage",)
    role: ClassVar[Role] = "image"

    def value(self, message: Any, origin: str) -> EncodedImage:
        """Return the image, undecoded."""
        return EncodedImage(content(message["data"]), message["format"], origin)


class FoxgloveRawImage(FoxgloveAdapter):
    """foxglove.RawImage."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.RawImage",)
    role: ClassVar[Role] = "image"

    def value(self, message: Any, origin: str) -> RawImage:
        """Return the image, unconverted."""
        size = (message["height"], message["width"], message["step"])
        return RawImage(content(message["data"]), *size, message["encoding"], origin)

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
        return LaserScan(
            angles,
            ranges,
            float(message.get("range_min", 0.0)),
            float(message.get("range_max", "nan")),
            _planar(message["pose"], self.frame(message)),
        )


class FoxglovePoseInFrame(FoxgloveAdapter):
    """foxglove.PoseInFrame."""

    schemas: ClassVar[tuple[str, ...]] = ("foxglove.PoseInFrame",)
    role: ClassVar[Role] = "pose"

    def value(self, message: Any, origin: str) -> Pose2D:
        """Return the pose in the plane."""
        return _planar(message["pose"], self.frame(message))


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


def _lengths(lengths: Any) -> NDArray[np.float64]:
    if not isinstance(lengths, list):  # protobuf has a number for everything
        return np.array(lengths, dtype=np.float64)
    return np.array([np.nan if each is None else float(each) for each in lengths])


def _planar(pose: Any, frame: str) -> Pose2D:
    return Pose2D(
        float(pose["position"]["x"]),
        float(pose["position"]["y"]),
        yaw(*_xyzw(pose["orientation"])),
        frame,
    )


def _transform(message: Any) -> Transform:
    translation = message["translation"]
    return Transform(
        parent=str(message["parent_frame_id"]).lstrip("/"),
        child=str(message["child_frame_id"]).lstrip("/"),
        translation=(translation["x"], translation["y"], translation["z"]),
        rotation=_xyzw(message["rotation"]),
        stamp=nanoseconds(message["timestamp"]),
    )


def _xyzw(rotation: Any) -> tuple[float, float, float, float]:
    return rotation["x"], rotation["y"], rotation["z"], rotation["w"]
