"""Observations, their parts, and what a source says of itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from placecue.camera import PinholeCamera
from placecue.contracts.words import array, fields, shown, whole
from placecue.errors import described
from placecue.observation import LaserScan, Observation, Pose2D

#: What fits a stamp.
_STAMPS = np.iinfo(np.int64)


def text(made: Any) -> str | None:
    """Check a name or a digest."""
    return None if isinstance(made, str) and made else f"is {shown(made)}, not a text"


def texts(made: Any) -> str | None:
    """Check a list of lines for a person."""
    right = isinstance(made, list) and all(isinstance(each, str) for each in made)
    return None if right else f"returned {shown(made)}, not a list of texts"


def count(made: Any) -> str | None:
    """Check how many observations a source says to have."""
    right = made is None or (whole(made) and made >= 0)
    return None if right else f"returned {shown(made)}, not a number of observations or None"


def metadata(made: Any) -> str | None:
    """Check the conditions of a recording: texts by name."""
    if not isinstance(made, Mapping):
        return f"is {described(made)}, not a mapping of texts"
    for name, value in made.items():
        if not (isinstance(name, str) and isinstance(value, str)):
            return f"holds {described(value)} under {name!r}, not a text"
    return None


def camera(made: Any) -> str | None:
    """Check the camera of a source."""
    if made is None or isinstance(made, PinholeCamera):
        return None
    return f"is {shown(made)}, not a PinholeCamera or None"


def observation(made: Any) -> str | None:
    """Check what comes out of a source: an Observation with parts of the right types."""
    if not isinstance(made, Observation):
        return f"returned {described(made)}, not an Observation"
    wrong = fields(
        "an Observation",
        ("stamp", made.stamp, whole(made.stamp) and fits(made.stamp), "a whole number of ns"),
        ("label", made.label, _optional(made.label, str), "a text or None"),
        ("pose", made.pose, _optional(made.pose, Pose2D), "a Pose2D or None"),
        ("scan", made.scan, _optional(made.scan, LaserScan), "a LaserScan or None"),
    )
    if wrong is None and made.scan is not None:
        wrong = scan(made.scan)
    return wrong or image(made.image_source)


def augmentations(made: Any) -> str | None:
    """Check what ``Cue.augmentations`` returns: functions."""
    if not isinstance(made, Sequence):
        return f"returned {described(made)}, not a sequence of functions"
    wrong = [each for each in made if not callable(each)]
    return f"returned {described(wrong[0])} among its functions" if wrong else None


def image(made: Any) -> str | None:
    """Check an image that an observation is made with: an array of pixels, or what decodes one."""
    if made is None or callable(made):
        return None
    if not isinstance(made, np.ndarray):
        return f"returned an Observation whose image is {described(made)}, not an array"
    colours = made.shape[2:] == (3,)
    if made.dtype.kind != "u" or not (made.ndim == 2 or colours):
        text = f"returned an Observation whose image is of {made.dtype}, shape {made.shape}"
        return f"{text}, not of uint8, (H, W, 3) or (H, W)"
    return None


def stamp(made: Any) -> str | None:
    """Check a time in ns, which may be too large for 64 bits."""
    return None if whole(made) else f"returned {shown(made)}, not a whole number of ns"


def fits(stamp: int) -> bool:
    """Tell whether a stamp fits 64 bits, as arrays of stamps hold it."""
    return _STAMPS.min <= stamp <= _STAMPS.max


def scan(made: Any) -> str | None:
    """Check a laser scan: as many angles as ranges, both floats."""
    if not isinstance(made, LaserScan):
        return f"returned {described(made)}, not a LaserScan"
    for name in ("angles", "ranges"):
        values = getattr(made, name)
        if not isinstance(values, np.ndarray) or values.dtype.kind != "f" or values.ndim != 1:
            return f"returned a LaserScan whose {name} are {array(values)}, not (n,) floats"
    if made.angles.shape != made.ranges.shape:
        return f"returned a LaserScan of {made.angles.size} angles and {made.ranges.size} ranges"
    return None


def _optional(value: object, kind: type) -> bool:
    return value is None or isinstance(value, kind)
