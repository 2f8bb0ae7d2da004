"""Checks of parameters, each with one line for the person who set it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from placecue.errors import UsageError, choices


def check_choice(parameter: str, value: Any, allowed: Sequence[str]) -> None:
    """Raise UsageError unless a parameter is one of the allowed words."""
    if value not in allowed:
        raise UsageError(f"{parameter} is {value!r}; {choices(str(value), allowed)}")


def check_number(
    parameter: str,
    value: Any,
    *,
    above: float | None = None,
    least: float | None = None,
    below: float | None = None,
    most: float | None = None,
) -> None:
    """Raise UsageError unless a parameter is a number within its limits."""
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise UsageError(f"{parameter} is {value!r}; give a number")
    if above is not None and not value > above:
        raise UsageError(f"{parameter} is {value!r}; give a number above {above:g}")
    if least is not None and not value >= least:
        raise UsageError(f"{parameter} is {value!r}; give a number of at least {least:g}")
    if below is not None and not value < below:
        raise UsageError(f"{parameter} is {value!r}; give a number below {below:g}")
    if most is not None and not value <= most:
        raise UsageError(f"{parameter} is {value!r}; give a number of at most {most:g}")


def check_whole(parameter: str, value: Any, *, least: int, most: int | None = None) -> None:
    """Raise UsageError unless a parameter is a whole number from ``least`` to ``most``."""
    if not isinstance(value, int) or isinstance(value, bool) or value < least:
        raise UsageError(f"{parameter} is {value!r}; give a whole number of at least {least}")
    if most is not None and value > most:
        raise UsageError(f"{parameter} is {value!r}; give a whole number of at most {most}")


def check_flag(parameter: str, value: Any) -> None:
    """Raise UsageError unless a parameter is true or false."""
    if not isinstance(value, bool):
        raise UsageError(f"{parameter} must be true or false, got {value!r}")
