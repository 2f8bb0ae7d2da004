"""Laser scans from bare lists of ranges, in cells of tables and in small files."""

from __future__ import annotations

import re
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from placecue.limits import current_limits
from placecue.observation import LaserScan

SEPARATORS = re.compile(r"[\s,;]+")
SUFFIXES = (".npy", ".csv", ".txt")


def is_list(cell: str) -> bool:
    """Tell whether a cell holds ranges themselves, not the name of a file with them."""
    return not cell.lower().endswith(SUFFIXES)


def ranges_of(text: str) -> NDArray[np.float64]:
    """Return the numbers of a list that blanks, commas or semicolons separate, shape (n,).

    Raises
    ------
    ValueError
        If there is none, one is no number, or they are separated in more ways than one: 1,5 2,5
        may be two numbers or four.
    """
    inner = text.strip(" \t\r\n,;[]()\ufeff")
    ways = {_way(gap) for gap in SEPARATORS.findall(inner)}
    if len(ways) > 1:
        raise ValueError(
            f"numbers are separated by {' and by '.join(sorted(ways))}, so it is not known which "
            "commas are decimal ones: separate them in one way, and write decimal points"
        )
    numbers = SEPARATORS.split(inner)
    over = current_limits().over("beams", len(numbers))
    if over:
        raise ValueError(f"{len(numbers)} beams, {over}")
    return np.asarray(np.array(numbers).astype(np.float64))


def _way(gap: str) -> str:
    """Return what separates two numbers, whatever blanks there are around it."""
    named = {",": "commas", ";": "semicolons"}
    return next((named[each] for each in gap if each in named), "blanks")


def ranges_in(data: bytes, name: str) -> NDArray[np.float64]:
    """Return the numbers in a file, shape (n,).

    Parameters
    ----------
    data : bytes
        What is in it: numbers as text, or numpy's format where the name ends in ``.npy``.
    name : str
        Its name.

    Raises
    ------
    ValueError, EOFError
        If they are no numbers.
    """
    if name.lower().endswith(".npy"):
        return np.asarray(np.load(BytesIO(data), allow_pickle=False), dtype=np.float64).ravel()
    return ranges_of(data.decode("utf-8", "replace"))


def scan_of(
    ranges: NDArray[np.float64],
    field_of_view: float,
    range_min: float,
    range_max: float,
    clockwise: bool,
) -> LaserScan:
    """Return a scan with beams spread evenly over the field of view, ahead of the robot.

    Parameters
    ----------
    ranges : ndarray of float64, shape (n,)
        Lengths, m, from the right end of the field of view to the left.
    field_of_view : float
        Angle from the first beam to the last, degrees; at 360 the last is one step before the
        first, which points backwards.
    range_min, range_max : float
        What is not between is no measurement, m.
    clockwise : bool
        Whether the ranges come from left to right instead.
    """
    half = np.deg2rad(field_of_view) / 2
    angles = np.linspace(-half, half, ranges.size, endpoint=field_of_view < 360)
    if clockwise:
        angles, ranges = -angles[::-1], ranges[::-1]
    return LaserScan(angles, ranges, range_min, range_max)
