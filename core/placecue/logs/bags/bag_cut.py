"""A ROS 1 bag without an index, as a recorder that was killed leaves it, read front to back.

The format is that of http://wiki.ros.org/Bags/Format/2.0. ``rosbags`` reads by index only.
"""

from __future__ import annotations

import struct
from bz2 import BZ2Decompressor
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import IO, Any, NamedTuple, Self

from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import EndOfFile
from rosbags.interfaces import (
    Connection,
    ConnectionExtRosbag1,
    MessageDefinition,
    MessageDefinitionFormat,
)

from placecue.limits import current_limits
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


class Held(NamedTuple):
    """A connection, or a message of one.

    Parameters
    ----------
    number : int
        Of the connection.
    stamp : int
        Time of the message, ns.
    data : bytes
        The message.
    connection : Connection or None
        None for a message.
    """

    number: int
    stamp: int
    data: bytes
    connection: Connection | None = None


class CutBag:
    """What can be read of a bag without its index; has the methods of a rosbags reader.

    Messages come in the order of the file. Of a chunk that the file ends in, the messages that
    are whole are kept.

    Parameters
    ----------
    path : Path
        The bag. All of it is looked through.

    Attributes
    ----------
    connections : list of rosbags Connection
        Who published what, with the number of messages.
    start_time, end_time : int
        Time of the first message, and after that of the last, ns.
    message_count : int
        How many messages there are.
    damage : Damage or None
        Where reading stopped before the end of the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.start_time, self.end_time = 2**63 - 1, 0
        self.damage: Damage | None = None
        found: dict[int, Connection] = {}
        counts: Counter[int] = Counter()
        for held in self._held():
            if held.connection is not None:
                found.setdefault(held.number, held.connection)
            else:
                counts[held.number] += 1
                self.start_time = min(self.start_time, held.stamp)
                self.end_time = max(self.end_time, held.stamp + 1)
        self.connections = [each._replace(msgcount=counts[i]) for i, each in found.items()]
        self.message_count = counts.total()

    def messages(
        self, connections: Collection[Connection], start: int | None = None, stop: int | None = None
    ) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield connection, time (ns) and bytes of the messages of some connections.

        Parameters
        ----------
        connections : collection of rosbags Connection
            The wanted ones.
        start, stop : int, optional
            First time to give, and the one to stop before, ns.
        """
        wanted = {each.id: each for each in connections}
        for held in self._held():
            since = start is None or held.stamp >= start
            until = stop is None or held.stamp < stop
            if held.connection is None and held.number in wanted and since and until:
                yield wanted[held.number], held.stamp, held.data

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

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
