"""The sqlite files of a ROS 2 bag that are cut off or damaged, read as far as their tables lead.

``rosbags`` counts messages before it reads any, which takes a whole file.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import apsw
from rosbags.interfaces import (
    Connection,
    ConnectionExtRosbag2,
    MessageDefinition,
    MessageDefinitionFormat,
)

from placecue.logs.bags.cut_reader import CutReader, Held

FORMATS = {"ros2msg": MessageDefinitionFormat.MSG, "ros2idl": MessageDefinitionFormat.IDL}
NO_DEFINITION = MessageDefinition(MessageDefinitionFormat.NONE, "")
#: What compressed messages begin with (RFC 8878); those of ROS begin with their byte order.
ZSTD = b"\x28\xb5\x2f\xfd"


class CutStorage(CutReader):
    """What can be read of sqlite files without their end.

    Messages come in the order of the files: those before the damage, and those behind it.

    Parameters
    ----------
    files : sequence of Path
        The storage files of one bag, in order.
    """

    def __init__(self, files: Sequence[Path]) -> None:
        self.files = files
        super().__init__()

    def _held(self) -> Iterator[Held]:
        numbers: dict[str, int] = {}  # a topic has one in each file, and here one in all
        for file in self.files:
            with closing(_opened(file)) as base:
                here = {}
                for each in _connections(base):
                    number = numbers.setdefault(each.topic, len(numbers) + 1)
                    here[each.id] = number
                    yield Held(number, 0, b"", each._replace(id=number))
                for topic, stamp, data in _messages(base):
                    if topic in here and not data.startswith(ZSTD):
                        yield Held(here[topic], stamp, data)


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
