"""The sqlite files of a ROS 2 bag that are cut off or damaged, read as far as their tables lead.

``rosbags`` counts messages before it reads any, which takes a whole file.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Generator, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Self

import apsw
from rosbags.interfaces import (
    Connection,
    ConnectionExtRosbag2,
    MessageDefinition,
    MessageDefinitionFormat,
)

FORMATS = {"ros2msg": MessageDefinitionFormat.MSG, "ros2idl": MessageDefinitionFormat.IDL}
NO_DEFINITION = MessageDefinition(MessageDefinitionFormat.NONE, "")
#: What compressed messages begin with (RFC 8878); those of ROS begin with their byte order.
ZSTD = b"\x28\xb5\x2f\xfd"

Row = tuple[str, int, bytes]  # name of the topic, time (ns), message


class CutStorage:
    """What can be read of sqlite files without their end; has the methods of a rosbags reader.

    Messages come in the order of the files: those before the damage, and those behind it.

    Parameters
    ----------
    files : sequence of Path
        The storage files of one bag, in order.

    Attributes
    ----------
    connections : list of rosbags Connection
        Who published what, with the number of messages that are left.
    start_time, end_time : int
        Time of the first message, and after that of the last, ns.
    message_count : int
        How many messages are left.
    """

    def __init__(self, files: Sequence[Path]) -> None:
        self.files = files
        self.start_time, self.end_time = 2**63 - 1, 0
        found: dict[str, Connection] = {}
        for file in files:
            with closing(_opened(file)) as base:
                for each in _connections(base):
                    found.setdefault(each.topic, each._replace(id=len(found) + 1))
        counts: Counter[str] = Counter()
        for topic, stamp, _ in self._rows():
            counts[topic] += 1
            self.start_time = min(self.start_time, stamp)
            self.end_time = max(self.end_time, stamp + 1)
        self.connections = [each._replace(msgcount=counts[name]) for name, each in found.items()]
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
        wanted = {each.topic: each for each in connections}
        for topic, stamp, data in self._rows():
            since = start is None or stamp >= start
            if topic in wanted and since and (stop is None or stamp < stop):
                yield wanted[topic], stamp, data

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def _rows(self) -> Iterator[Row]:
        for file in self.files:
            with closing(_opened(file)) as base:
                names = {number: name for number, name, *_ in _table(base, "topics", TOPIC)}
                for number, stamp, data in _messages(base):
                    if number in names and not data.startswith(ZSTD):
                        yield names[number], stamp, data


TOPIC = "id, name, type, serialization_format"
MESSAGE = "SELECT id, topic_id, timestamp, data FROM messages NOT INDEXED WHERE id >= ? ORDER BY id"
NUMBERS = "SELECT id FROM messages NOT INDEXED WHERE id > ? ORDER BY id DESC"


class _WholePages(apsw.VFS):
    """Gives a file as if it ended with its last whole page: sqlite fills up others with zeros."""

    NAME = "placecue_whole_pages"

    def __init__(self) -> None:
        super().__init__(self.NAME, "")

    def xOpen(self, name: Any, flags: list[int]) -> apsw.VFSFile:  # noqa: N802 - apsw's name
        """Open a file."""
        return _WholePagesFile("", name, flags)


class _WholePagesFile(apsw.VFSFile):
    def xFileSize(self) -> int:  # noqa: N802 - apsw's name
        size = super().xFileSize()
        page = int.from_bytes(self.xRead(2, 16))  # https://www.sqlite.org/fileformat.html, 1.3
        return size - size % (65536 if page <= 1 else page)


_whole_pages = _WholePages()  # known to sqlite as long as it is kept


def _opened(file: Path) -> apsw.Connection:
    flags = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
    base = apsw.Connection(f"{file.resolve().as_uri()}?immutable=1", flags, _WholePages.NAME)
    # Else sqlite refuses a file that is shorter than it says itself to be.
    base.execute("PRAGMA writable_schema = ON")
    return base


def _connections(base: apsw.Connection) -> Iterator[Connection]:
    columns = "topic_type, encoding, encoded_message_definition"
    held = {
        name: MessageDefinition(FORMATS[encoding], text)
        for name, encoding, text in _table(base, "message_definitions", columns)
        if encoding in FORMATS
    }
    for number, name, kind, encoding in _table(base, "topics", TOPIC):
        details = ConnectionExtRosbag2(encoding, [])
        definition = held.get(kind, NO_DEFINITION)
        yield Connection(number, name, kind, definition, "", 0, details, None)


def _table(base: apsw.Connection, name: str, columns: str) -> list[tuple[Any, ...]]:
    """Return the rows of a small table; none where it is not there or damaged."""
    try:
        return list(base.execute(f"SELECT {columns} FROM {name}"))
    except apsw.Error:
        return []


def _messages(base: apsw.Connection) -> Iterator[tuple[int, int, bytes]]:
    """Yield topic, time and bytes of the messages before the damage, and of those behind it."""
    last = yield from _since(base, 0)
    behind = None
    try:
        for row in base.execute(NUMBERS, (last,)):
            behind = row[0]
    except apsw.Error:
        pass
    if behind is not None:
        yield from _since(base, behind)


def _since(base: apsw.Connection, number: int) -> Generator[tuple[int, int, bytes], None, int]:
    """Yield messages from a number on, up to the damage; return the last number."""
    try:
        for last, topic, stamp, data in base.execute(MESSAGE, (number,)):
            number = last
            if isinstance(stamp, int) and isinstance(data, bytes):
                yield topic, stamp, data
    except apsw.Error:
        pass
    return number
