"""Kinds of messages that placecue writes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from placecue.camera import PinholeCamera
from placecue.observation import LaserScan, Pose2D

#: Frames in what placecue writes.
ODOM_FRAME = "odom"
BASE_FRAME = "base_link"
LASER_FRAME = "laser"
CAMERA_FRAME = "camera"
#: The identity, row by row.
NO_ROTATION = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class MessageType:
    """A schema, and how messages of it are encoded.

    Parameters
    ----------
    name : str
        Name of the schema.
    encoding : str
        Encoding of the messages, such as ``cdr``.
    schema_encoding : str
        Language of the schema, such as ``ros2msg``.
    schema : bytes
        The schema.
    serialise : callable
        From nested dicts to the bytes of a message.
    """

    name: str
    encoding: str
    schema_encoding: str
    schema: bytes
    serialise: Callable[[Any], bytes]


@dataclass(frozen=True, slots=True)
class Written:
    """A message ready to be written.

    Parameters
    ----------
    topic : str
        Where it goes.
    type : MessageType
        What it is.
    message : dict
        Its fields.
    """

    topic: str
    type: MessageType
    message: dict[str, Any]


class Dialect(ABC):
    """Puts parts of an observation into messages of one family.

    Attributes
    ----------
    profile : str
        Profile of an MCAP file that holds nothing else.
    """

    profile: str = ""

    @abstractmethod
    def image(self, stamp: int, data: bytes, format: str) -> Written:
        """Return a compressed image; format is ``jpeg`` or ``png``."""

    @abstractmethod
    def camera(self, stamp: int, camera: PinholeCamera) -> Written:
        """Return the camera of the image of the same stamp."""

    @abstractmethod
    def scan(self, stamp: int, scan: LaserScan) -> Written:
        """Return a scan in the laser's frame; its angles are evenly spaced."""

    @abstractmethod
    def pose(self, stamp: int, pose: Pose2D) -> Written:
        """Return the robot's pose."""

    @abstractmethod
    def transform(self, stamp: int, parent: str, child: str, pose: Pose2D, static: bool) -> Written:
        """Return where the frame ``child`` lies in ``parent``."""

    @abstractmethod
    def label(self, stamp: int, label: str) -> Written:
        """Return the event of a new label; an empty one ends the label before."""


def seconds(stamp: int) -> tuple[int, int]:
    """Return whole seconds and the rest, ns."""
    return divmod(stamp, 1_000_000_000)


def spacing(scan: LaserScan) -> float:
    """Return the mean angle from one beam to the next, rad; 0 where there is one beam or none."""
    beams = len(scan.angles)
    return float(scan.angles[-1] - scan.angles[0]) / (beams - 1) if beams > 1 else 0.0
