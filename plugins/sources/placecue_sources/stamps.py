"""Times as data sets write them, in nanoseconds."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

NANOSECONDS = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
UNITS = (*NANOSECONDS, "iso", "none")
#: What 64 bits of nanoseconds hold.
LONGEST = 2**63 - 1
#: Digits before the point of the largest time in the smallest unit, and some more.
DIGITS = 25


def nanoseconds(text: str, unit: str = "s") -> int:
    """Return a time to its last digit, ns.

    Parameters
    ----------
    text : str
        A decimal number, or ISO 8601 (UTC where no zone is given).
    unit : {"s", "ms", "us", "ns", "iso"}
        What it is counted in, from 1970.

    Raises
    ------
    ValueError
        If it is no time after 1970 that 64 bits can hold.
    """
    try:
        stamp = _iso(text) if unit == "iso" else _counted(text, NANOSECONDS[unit])
    except (ArithmeticError, ValueError) as error:
        raise ValueError(f"'{text}' is not a time in {unit}") from error
    if not 0 <= stamp <= LONGEST:
        raise ValueError(
            f"the time '{text}' {unit} does not lie between 1970 and 2262{_finer(stamp, unit)}"
        )
    return stamp


def _finer(stamp: int, unit: str) -> str:
    """Return the unit in which a time makes sense, as a hint; empty where there is none."""
    factor = NANOSECONDS.get(unit, 1)
    fits = [name for name, each in NANOSECONDS.items() if 0 <= stamp // factor * each <= LONGEST]
    return f", but in {fits[0]} it does: stamp_unit={fits[0]}" if fits else ""


def _counted(text: str, unit: int) -> int:
    number = Decimal(text)
    if number.is_finite() and number.adjusted() > DIGITS:  # to write it out can take forever
        raise ValueError("too large")
    return int(number * unit)


def nearest(stamps: NDArray[np.int64], stamp: int, tolerance: int) -> int | None:
    """Return which of ``stamps`` (sorted, ns) is nearest, or None if it is not near enough.

    Parameters
    ----------
    stamps : ndarray of int64, shape (n,)
        Times in order, ns.
    stamp : int
        The time in question, ns.
    tolerance : int
        How far off the nearest may be, ns.
    """
    after = int(np.searchsorted(stamps, stamp))
    near = {
        abs(int(stamps[index]) - stamp): index
        for index in (after, after - 1)
        if 0 <= index < stamps.size
    }
    distance = min(near, default=tolerance + 1)
    return near[distance] if distance <= tolerance else None


def _iso(text: str) -> int:
    time = datetime.fromisoformat(text.strip())
    time = time if time.tzinfo else time.replace(tzinfo=UTC)
    since = time - datetime(1970, 1, 1, tzinfo=UTC)
    return since // timedelta(microseconds=1) * 1000
