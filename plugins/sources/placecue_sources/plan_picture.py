"""Floor plans drawn as grey pictures, one grey value a class."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np

from placecue.errors import DataError, UsageError
from placecue.observation import EncodedImage
from placecue_sources.contents import read_bytes
from placecue_sources.plan import WALL, Plan


def read_picture(path: Path, legend: Mapping[int, str], resolution: float) -> Plan:
    """Read a plan from a picture; its lower left corner is the origin.

    Parameters
    ----------
    path : Path
        The picture; one in colour is turned to grey.
    legend : mapping of int to str
        Class of each grey value. Every other value is wall or unknown.
    resolution : float
        Side of a pixel, m.

    Raises
    ------
    DataError
        If it is no picture, or has no pixel of any class.
    """
    picture = EncodedImage(read_bytes(path), "png", str(path))()
    if picture.ndim == 3:
        picture = np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY), dtype=np.uint8)
    classes = sorted(set(legend.values()))
    meaning = np.full(256, WALL, dtype=np.int16)
    for value, name in _values(legend).items():
        meaning[value] = classes.index(name)
    labels = meaning[np.flipud(picture)]
    if (labels == WALL).all():
        there = ", ".join(map(str, np.unique(picture)[:10]))
        wanted = ", ".join(map(str, legend))
        raise DataError(f"{path} has no pixel of a value in the legend ({wanted}); it has {there}")
    return Plan.of(path.stem, labels, classes, resolution)


def _values(legend: Mapping[int, str]) -> dict[int, str]:
    """Return the legend with whole numbers from 0 to 255 as keys."""
    try:
        values = {int(value): name for value, name in legend.items()}
    except ValueError as error:
        raise UsageError(f"a key of the legend is not a grey value: {error}") from error
    wrong = [value for value in values if not 0 <= value <= 255]
    if wrong:
        raise UsageError(f"the legend has the value {wrong[0]}; grey values are 0 to 255")
    return values
