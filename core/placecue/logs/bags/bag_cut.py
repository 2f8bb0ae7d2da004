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
from typing import IO, NamedTuple, Self

from lz4.frame import LZ4FrameDecompressor
from mcap.exceptions import EndOfFile
from rosbags.interfaces import (
    Connection,
    ConnectionExtRosbag1,
    MessageDefinition,
    MessageDefinitionFormat,
)

from placecue.logs.mcap.linear import Damage, describe

Fields = dict[bytes, bytes]

MAGIC_LINE = b"#ROSBAG V2.0\n"
MESSAGE, CHUNK, CONNECTION = b"\x02", b"\x05", b"\x07"
#: What undoes each compression; given the beginning of something, they return its beginning.
DECOMPRESSORS: dict[bytes, Callable[[bytes], bytes]] = {
    b"none": lambda data: data,
    b"bz2": lambda data: BZ2Decompressor().decompress(data),
    b"lz4": lambda data: bytes(LZ4FrameDecompressor().decompress(data)),
}


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
        """Yield the connections and messages up to the first damage."""
        offset, size = len(MAGIC_LINE), self.path.stat().st_size
        with self.path.open("rb") as file:
            file.seek(offset)
            try:
                for fields, data, whole in _records(file, size):
                    if fields[b"op"] == CHUNK:
                        yield from _inside(DECOMPRESSORS[fields[b"compression"]](data), whole)
                    if not whole:
                        raise EndOfFile
                    offset = file.tell()
            except Exception as error:  # a parser fed with damaged bytes may raise anything
                self.damage = Damage(offset, describe(error))


def _inside(chunk: bytes, whole: bool) -> Iterator[Held]:
    """Yield what a chunk holds; of one that is cut, what is whole."""
    try:
        for fields, data, complete in _records(BytesIO(chunk), len(chunk)):
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


def _records(file: IO[bytes], size: int) -> Iterator[tuple[Fields, bytes, bool]]:
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
