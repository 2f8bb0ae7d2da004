"""The two libraries of ``placecue[slam]``, imported when they are first needed."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from placecue.errors import UsageError

INSTALL = "pip install 'placecue[slam]'"


def check_installed() -> None:
    """Raise UsageError, with the line to type, unless both libraries are installed."""
    missing = [name for name in ("small_gicp", "gtsam") if find_spec(name) is None]
    if missing:
        raise UsageError(
            f"poses from scans need {' and '.join(missing)}, which is not installed: {INSTALL}, "
            "or leave out slam=true"
        )


@cache
def small_gicp() -> Any:
    """Return the library that lays scans on one another (Koide, JOSS 2024; MIT)."""
    check_installed()
    return import_module("small_gicp")


@cache
def gtsam() -> Any:
    """Return the library that smooths graphs of poses (Dellaert et al.; BSD)."""
    check_installed()
    return import_module("gtsam")
