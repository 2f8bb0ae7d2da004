"""What a component may do that it should not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Nameless(Exception):
    """An error that cannot even say what it is about."""

    def __str__(self) -> str:
        raise ZeroDivisionError


def _overflow() -> Any:
    return _overflow()


def _exhausted() -> Any:
    raise MemoryError


def _left() -> Any:
    raise SystemExit(3)


def _closed() -> Any:
    raise GeneratorExit


def _nameless() -> Any:
    raise Nameless


def _wrong() -> Any:
    raise ValueError("two\n  lines")


def _missing() -> Any:
    raise FileNotFoundError(2, "No such file or directory", "table.csv")


#: What it does, and what of it is told.
MISDEEDS: dict[str, tuple[Callable[[], Any], str]] = {
    "raises": (_wrong, "ValueError: two lines"),
    "misses a file": (_missing, "FileNotFoundError: [Errno 2] No such file"),
    "recurses": (_overflow, "RecursionError: maximum recursion depth"),
    "exhausts memory": (_exhausted, "MemoryError"),
    "leaves": (_left, "SystemExit: 3"),
    "closes": (_closed, "GeneratorExit"),
    "raises the unspeakable": (_nameless, "Nameless: (which has no text)"),
}


def interrupt() -> Any:
    """Do as Ctrl-C does."""
    raise KeyboardInterrupt
