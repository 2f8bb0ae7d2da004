"""How large a part of an input may be. No honest log meets these; a damaged or lying one does.

What is larger is refused before memory is asked for it, by a message that names the limit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from typing import Any

from placecue.errors import UsageError, choices


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest sizes that are read.

    Parameters
    ----------
    chunk : int
        Bytes of a chunk of a log, or of a bag, when it is unpacked.
    pixels : int
        Width times height of an image.
    beams : int
        Beams of a laser scan.
    channels : int
        Channels of a log, or connections of a bag.
    rows : int
        Rows of a table of labels.
    depth : int
        How deep brackets lie in one another in a file of rooms, or in a message of JSON.
    members : int
        Files in a folder or tar.
    file : int
        Bytes of a file in a folder or tar that is read as a whole, or of an attachment.
    message : int
        Bytes of a message that a robot sends.
    rate : int
        Messages a second that a robot may send.
    waiting : int
        Bytes of a robot's messages that may wait to be read.
    """

    chunk: int = 2**28
    pixels: int = 50_000_000
    beams: int = 100_000
    channels: int = 10_000
    rows: int = 1_000_000
    depth: int = 100
    members: int = 2_000_000
    file: int = 2**28
    message: int = 2**26
    rate: int = 10_000
    waiting: int = 2**28

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not isinstance(value, int) or isinstance(value, bool) or value < 1:
                raise UsageError(f"limits.{name} is {value!r}; give a whole number of at least 1")

    def over(self, name: str, size: int) -> str | None:
        """Return what is to be said of a size above a limit; None where it is within.

        Parameters
        ----------
        name : str
            Which limit, such as ``pixels``.
        size : int
            What is to be read.
        """
        most: int = getattr(self, name)
        return None if size <= most else f"more than limits.{name}={most} allows"


_current = [Limits()]


def current_limits() -> Limits:
    """Return the limits in force."""
    return _current[-1]


@contextmanager
def limited(given: Mapping[str, Any] | None) -> Iterator[Limits]:
    """Put limits into force; those that are not given keep their defaults.

    Parameters
    ----------
    given : mapping of str to int, or None
        By the names of :class:`Limits`.

    Raises
    ------
    UsageError
        If there is no limit of a name, or one is no whole number of at least 1.
    """
    known = [field.name for field in fields(Limits)]
    for name in given or {}:
        if name not in known:
            raise UsageError(f"there is no limits.{name}; {choices(str(name), known)}")
    _current.append(Limits(**dict(given or {})))
    try:
        yield current_limits()
    finally:
        _current.pop()
