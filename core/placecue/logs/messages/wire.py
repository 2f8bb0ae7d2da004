"""How ROS puts fields into bytes: CDR for ROS 2, and ROS 1's own way."""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Bytes before the fields of a CDR message; alignment counts from behind them.
ENCAPSULATION = 4
SIZES = {"B": 1, "i": 4, "I": 4, "f": 4, "d": 8}


class Cursor(ABC):
    """A place in the bytes of a message that moves on as fields are read.

    Parameters
    ----------
    data : bytes
        The message.

    Attributes
    ----------
    at : int
        Where the next field begins.
    """

    __slots__ = ("at", "data", "order")

    order: str

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    @abstractmethod
    def aligned(self, at: int, size: int) -> int:
        """Return where a number of ``size`` bytes may begin, from a place on."""

    @abstractmethod
    def header(self) -> tuple[int, int, str]:
        """Return the stamp of a header, s and ns, and its frame."""

    def numbers(self, kind: str, count: int) -> tuple[Any, ...]:
        """Return some numbers of one kind, as :mod:`struct` names it."""
        form = _struct(self.order, kind, count)
        at = self.aligned(self.at, SIZES[kind])
        self.at = at + form.size
        return form.unpack_from(self.data, at)

    def array(self, kind: str) -> NDArray[Any]:
        """Return a sequence of numbers of one kind, shape (n,)."""
        (count,) = self.numbers("I", 1)
        start = self._taken(count, SIZES[kind])
        return np.frombuffer(self.data, f"{self.order}{kind}{SIZES[kind]}", count, start)

    def content(self) -> bytes:
        """Return a sequence of bytes."""
        (count,) = self.numbers("I", 1)
        start = self._taken(count, 1)
        return bytes(self.data[start : self.at])

    def skip(self, kind: str, count: int) -> None:
        """Pass over some numbers of one kind."""
        self._taken(count, SIZES[kind])

    def skip_array(self, kind: str) -> None:
        """Pass over a sequence of numbers of one kind."""
        (count,) = self.numbers("I", 1)
        self._taken(count, SIZES[kind])

    def text(self) -> str:
        """Return a string."""
        return self.content().removesuffix(b"\0").decode()

    def _taken(self, count: int, size: int) -> int:
        """Move on over numbers that must be there, and return where they begin."""
        start = self.aligned(self.at, size) if count else self.at  # an empty sequence is not padded
        self.at = start + count * size
        if self.at > len(self.data):
            raise ValueError(f"the message ends after {len(self.data)} bytes, in a field")
        return start


@cache
def _struct(order: str, kind: str, count: int) -> struct.Struct:
    return struct.Struct(f"{order}{count}{kind}")


class CdrCursor(Cursor):
    """Plain CDR, version 1, of either byte order (OMG, DDS Interoperability Wire Protocol)."""

    __slots__ = ()

    def __init__(self, data: bytes) -> None:
        super().__init__(data)
        if len(data) < ENCAPSULATION or data[0] or data[1] > 1:
            raise ValueError(f"a message that begins with {bytes(data[:4]).hex()} is not plain CDR")
        self.order = "<" if data[1] else ">"
        self.at = ENCAPSULATION

    def aligned(self, at: int, size: int) -> int:
        """Return the next multiple of the size."""
        return at + (ENCAPSULATION - at) % size

    def header(self) -> tuple[int, int, str]:
        """Return stamp, s and ns, and frame."""
        (sec,) = self.numbers("i", 1)
        (nanosec,) = self.numbers("I", 1)
        return sec, nanosec, self.text()


class Ros1Cursor(Cursor):
    """ROS 1: little-endian, without alignment; a header begins with a running number."""

    __slots__ = ()
    order = "<"

    def aligned(self, at: int, size: int) -> int:
        """Return the place itself: fields follow one another without gaps."""
        return at

    def header(self) -> tuple[int, int, str]:
        """Return stamp, s and ns, and frame, behind the running number."""
        _, sec, nanosec = self.numbers("I", 3)
        return sec, nanosec, self.text()
