"""Paths that a command is given."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from placecue.errors import UsageError


def path_of(config: Mapping[str, Any], key: str) -> Path:
    """Return the path under a key.

    Raises
    ------
    UsageError
        If it is empty, or no path at all.
    """
    value = config[key]
    # A name of digits alone, such as a year, comes as a number.
    if isinstance(value, (str, int, Path)) and str(value) and not isinstance(value, bool):
        return Path(str(value))
    raise UsageError(f"{key} must be a path, got {value!r}: give {key}=PATH")
