"""The few words of protobuf's wire format that an ONNX file is written with.

A message is a ``bytes`` object: its fields one after the other.
"""

from __future__ import annotations

import struct

_VARINT, _BYTES, _FIXED32 = 0, 2, 5


def number(field: int, value: int) -> bytes:
    """Return an integer field."""
    return _varint(field << 3 | _VARINT) + _varint(value & (2**64 - 1))


def real(field: int, value: float) -> bytes:
    """Return a single-precision field."""
    return _varint(field << 3 | _FIXED32) + struct.pack("<f", value)


def data(field: int, value: bytes) -> bytes:
    """Return a field of bytes, or of a message."""
    return _varint(field << 3 | _BYTES) + _varint(len(value)) + value


def text(field: int, value: str) -> bytes:
    """Return a field of text."""
    return data(field, value.encode())


def _varint(value: int) -> bytes:
    """Return a number seven bits at a time, the lowest first."""
    made = bytearray()
    while value > 127:
        made.append(value & 127 | 128)
        value >>= 7
    made.append(value)
    return bytes(made)
