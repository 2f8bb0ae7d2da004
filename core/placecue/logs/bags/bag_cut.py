"""A ROS 1 bag without an index, as a recorder that was killed leaves it, read front to back.

The format is that of http://wiki.ros.org/Bags/Format/2.0. ``rosbags`` reads by index only.
"""

from __future__ import annotations

import struct
from bz2 import BZ2Decompressor
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import IO, Any

from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import EndOfFile
from rosbags.interfaces import (
    Connection,
    ConnectionExtRosbag1,
    MessageDefinition,
    MessageDefinitionFormat,
)

from placecue.limits import current_limits
from placecue.logs.bags.cut_reader import CutReader, Held
from placecue.logs.mcap.linear import Damage, describe

Fields = dict[bytes, bytes]

MAGIC_LINE = b"#ROSBAG V2.0\n"
MESSAGE, CHUNK, CHUNK_INFO, CONNECTION = b"\x02", b"\x05", b"\x06", b"\x07"
#: What undoes each compression, piece by piece.
DECOMPRESSORS: dict[bytes, Callable[[], Any]] = {
    b"bz2": BZ2Decompressor,
    b"lz4": LZ4FrameDecompressor,
}
#: Bytes that are unpacked together where a chunk is damaged.
PIECE = 2**10


class CutBag(CutReader):
    """What can be read of a bag without its index.

    Of a chunk that the file ends in, the messages that are whole are kept.

    Parameters
    ----------
    path : Path
        The bag.

    Attributes
    ----------
    damage : Damage or None
        Where reading stopped before the end of the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.damage: Damage | None = None
        super().__init__()

    def _held(self) -> Iterator[Held]:
        """Yield the connections and messages; past a damaged chunk it goes on with the next."""
        offset, size = len(MAGIC_LINE), self.path.stat().st_size
        with self.path.open("rb") as file:
            file.seek(offset)
            try:
                for fields, data, whole in records(file, size):
                    if fields[b"op"] == CHUNK:
                        yield from self._of_chunk(offset, fields, data, whole)
                    if not whole:
                        raise EndOfFile
                    offset = file.tell()
            except Exception as error:  # a parser fed with damaged bytes may raise anything
                self._note(Damage(offset, describe(error)))

    def _of_chunk(self, offset: int, fields: Fields, data: bytes, whole: bool) -> Iterator[Held]:
        content, reason = unpacked(fields, data)
        if reason is not None and whole:
            self._note(Damage(offset, reason))
        try:
            yield from inside(content, whole and reason is None)
        except Exception as error:  # a parser fed with damaged bytes may raise anything
            self._note(Damage(offset, describe(error)))

    def _note(self, damage: Damage) -> None:
        self.damage = self.damage or damage


def unpacked(fields: Fields, data: bytes) -> tuple[bytes, str | None]:
    """Return the content of a chunk as far as it goes, and why it does not go further.

    Parameters
    ----------
    fields : dict of bytes to bytes
        Of the chunk's header.
    data : bytes
        What follows it.

    Raises
    ------
    ValueError
        If the compression is not known.
    """
    name = fields[b"compression"]
    if name == b"none":
        return data, None
    if name not in DECOMPRESSORS:
        raise ValueError(f"a chunk compressed with {name!r}, which is not known")
    most = current_limits().chunk
    said = _number(fields[b"size"])
    if over := current_limits().over("chunk", said):
        return b"", f"a chunk of {said} bytes when unpacked, {over}"
    decoder = DECOMPRESSORS[name]()
    try:
        content = bytes(decoder.decompress(data, max_length=most))
    except Exception as error:  # decoders raise their own, over damaged bytes
        return _beginning(name, data, most), describe(error)
    if not decoder.eof and len(content) >= most:
        return b"", f"a chunk of more bytes when unpacked than limits.chunk={most} allows"
    return content, None if decoder.eof else "the content of a chunk is cut"


def _beginning(name: bytes, data: bytes, most: int) -> bytes:
    """Return what can be unpacked before the damage."""
    decoder, found = DECOMPRESSORS[name](), bytearray()
    for start in range(0, len(data), PIECE):
        try:
            found += decoder.decompress(data[start : start + PIECE], max_length=most - len(found))
        except Exception:  # here it breaks
            break
        if decoder.eof or len(found) >= most:
            break
    return bytes(found)


def inside(chunk: bytes, whole: bool) -> Iterator[Held]:
    """Yield what a chunk holds; of one that is cut, what is whole."""
    try:
        for fields, data, complete in records(BytesIO(chunk), len(chunk)):
            if not complete:
                raise EndOfFile
            if fields[b"op"] == CONNECTION:
                yield _connection(fields, _fields(data))
            elif fields[b"op"] == MESSAGE:
                seconds, nanoseconds = struct.unpack("<II", fields[b"time"])
                stamp = seconds * 1_000_000_000 + nanoseconds
                yield Held(_number(fields[b"conn"]), stamp, data)
    except EndOfFile:
        if whole:
            raise


def records(file: IO[bytes], size: int) -> Iterator[tuple[Fields, bytes, bool]]:
    """Yield header and data of each record, and whether all of its data is there."""
    while file.tell() < size:
        length = _number(_exactly(file, 4, size))
        fields = _fields(_exactly(file, length, size))
        length = _number(_exactly(file, 4, size))
        data = file.read(min(length, size - file.tell()))  # no more, however damaged the length
        yield fields, data, len(data) == length


def _exactly(file: IO[bytes], length: int, size: int) -> bytes:
    if length > size - file.tell():
        raise EndOfFile
    return file.read(length)


def _fields(header: bytes) -> Fields:
    """Return the fields of a header; each is its length, its name, = and its value."""
    found: Fields = {}
    place = 0
    while place < len(header):
        end = place + 4 + _number(header[place : place + 4])
        name, _, value = header[place + 4 : end].partition(b"=")
        found[name] = value
        place = end
    return found


def _connection(record: Fields, header: Fields) -> Held:
    text = {name: value.decode("utf-8", "replace") for name, value in header.items()}
    definition = MessageDefinition(MessageDefinitionFormat.MSG, text[b"message_definition"])
    number, topic = _number(record[b"conn"]), record[b"topic"].decode("utf-8", "replace")
    described = (text[b"type"], definition, text[b"md5sum"], 0, ConnectionExtRosbag1(None, None))
    return Held(number, 0, b"", Connection(number, topic, *described, None))


def _number(raw: bytes) -> int:
    (number,) = struct.unpack("<I", raw)
    return int(number)
