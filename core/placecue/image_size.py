"""The size of an encoded image, read from its header before anything is decoded."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from typing import NamedTuple

from placecue.errors import UnusableObservation
from placecue.limits import current_limits

Size = tuple[int, int]

#: Beginning, number of channels or kind, width and height of a portable any-map.
_GAP = rb"(?:\s+|#[^\n]*\n)+"
PNM = re.compile(rb"P([1-6])" + (_GAP + rb"(\d{1,9})") * 2)
#: The same with the value that stands for white.
PNM_WHITE = re.compile(rb"P([2356])" + (_GAP + rb"(\d{1,9})") * 3 + rb"\s")
#: Markers of JPEG that no length follows, and those of the frames that hold the size.
BARE, FRAMES = {0x01, *range(0xD0, 0xDA)}, {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
#: Tags of TIFF, and how many bytes their numbers take by type.
WIDTH, HEIGHT, TIFF_TYPES = 256, 257, {1: "B", 3: "H", 4: "I"}


def size_of(data: bytes) -> Size | None:
    """Return width and height of an encoded image, pixels; None where its header does not say.

    Parameters
    ----------
    data : bytes
        PNG, JPEG, PGM and its kin, BMP, TIFF or WebP.
    """
    for begins, read in READERS:
        if data.startswith(begins):
            try:
                return read(data)
            except (struct.error, IndexError, KeyError):
                return None  # it ends within its header, and will not decode
    return None


def check_size(data: bytes, origin: str) -> None:
    """Refuse an encoded image that would be larger than the limit.

    Parameters
    ----------
    data : bytes
        The image.
    origin : str
        Where it comes from, for messages.

    Raises
    ------
    UnusableObservation
        If it has too many pixels.
    """
    size = size_of(data)
    if size is not None:
        check_pixels(*size, origin)


def check_pixels(width: int, height: int, origin: str) -> None:
    """Raise UnusableObservation where an image of some size, pixels, is larger than the limit."""
    over = current_limits().over("pixels", width * height)
    if over:
        raise UnusableObservation(f"{origin} is an image of {width} x {height} pixels, {over}")


class PortableMap(NamedTuple):
    """What stands before the pixels of a PGM or PPM.

    Parameters
    ----------
    width, height : int
        Size, pixels.
    white : int
        The value that stands for white.
    colours : bool
        Whether a pixel is red, green and blue.
    plain : bool
        Whether values are text.
    start : int
        Where they begin.
    """

    width: int
    height: int
    white: int
    colours: bool
    plain: bool
    start: int


def white_of(data: bytes) -> PortableMap | None:
    """Return what a PGM or PPM says before its pixels; None for anything else."""
    found = PNM_WHITE.match(data) if data[:1] == b"P" else None
    if found is None:
        return None
    kind, width, height, white = (int(each) for each in found.groups())
    return PortableMap(width, height, white, kind in (3, 6), kind in (2, 3), found.end())


def _png(data: bytes) -> Size:
    width, height = struct.unpack_from(">II", data, 16)
    return width, height


def _jpeg(data: bytes) -> Size | None:
    """Return the largest size that a frame gives; a thumbnail inside a segment is passed over."""
    sizes = list(_jpeg_frames(data))
    return max(sizes, key=lambda size: size[0] * size[1], default=None)


def _jpeg_frames(data: bytes) -> Iterator[Size]:
    at = 2
    while (at := data.find(b"\xff", at)) >= 0 and at + 9 <= len(data):
        marker = data[at + 1]
        if marker == 0xDA:  # pixels follow
            return
        if marker in (0x00, 0xFF) or marker in BARE:
            at += 1 if marker == 0xFF else 2
            continue
        if marker in FRAMES:
            height, width = struct.unpack_from(">HH", data, at + 5)
            yield width, height
        at += 2 + int.from_bytes(data[at + 2 : at + 4])


def _pnm(data: bytes) -> Size | None:
    found = PNM.match(data)
    return None if found is None else (int(found[2]), int(found[3]))


def _bmp(data: bytes) -> Size:
    (header,) = struct.unpack_from("<I", data, 14)
    width, height = struct.unpack_from("<HH" if header == 12 else "<ii", data, 18)
    return abs(width), abs(height)


def _tiff(data: bytes) -> Size:
    order = "<" if data.startswith(b"II") else ">"
    (at,) = struct.unpack_from(order + "I", data, 4)
    (count,) = struct.unpack_from(order + "H", data, at)
    found: dict[int, int] = {}
    for entry in range(at + 2, at + 2 + 12 * count, 12):
        tag, kind = struct.unpack_from(order + "HH", data, entry)
        if tag in (WIDTH, HEIGHT):
            (found[tag],) = struct.unpack_from(order + TIFF_TYPES[kind], data, entry + 8)
    return found[WIDTH], found[HEIGHT]


def _webp(data: bytes) -> Size | None:
    kind = data[12:16]
    if kind == b"VP8X":
        return 1 + int.from_bytes(data[24:27], "little"), 1 + int.from_bytes(data[27:30], "little")
    if kind == b"VP8L":
        (bits,) = struct.unpack_from("<I", data, 21)
        return 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF)
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF
    return None


READERS: tuple[tuple[bytes | tuple[bytes, ...], Callable[[bytes], Size | None]], ...] = (
    (b"\x89PNG\r\n\x1a\n", _png),
    (b"\xff\xd8", _jpeg),
    (tuple(f"P{number}".encode() for number in range(1, 7)), _pnm),
    (b"BM", _bmp),
    ((b"II*\0", b"MM\0*"), _tiff),
    (b"RIFF", _webp),
)
