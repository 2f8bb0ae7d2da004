"""An MCAP file: which topics it holds, and their messages."""

from __future__ import annotations

import hashlib
import logging
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from mcap.reader import SeekingReader
from mcap.records import (
    Channel,
    ChunkIndex,
    McapRecord,
    Message,
    Metadata,
    Schema,
)
from mcap.summary import Summary

from placecue.errors import DataError
from placecue.logs import indexed, linear
from placecue.logs.linear import Damage

log = logging.getLogger(__name__)

MAGIC = b"\x89MCAP0\r\n"
#: Beginnings of files that people mistake for MCAP, and what to do with them.
OTHER_FILES = {
    b"#ROSBAG": "a ROS 1 bag; convert it first: mcap convert IN.bag OUT.mcap",
    b"SQLite format 3": "a ROS 2 sqlite3 bag; convert it first: mcap convert IN.db3 OUT.mcap",
    b"\x1f\x8b": "gzip-compressed; unpack it first",
}


@dataclass(frozen=True, slots=True)
class Topic:
    """One topic of a log.

    Parameters
    ----------
    name : str
        Such as ``/scan``.
    schema : str
        Name of the schema, such as ``sensor_msgs/msg/LaserScan``; empty where there is none.
    encoding : str
        How messages are encoded, such as ``cdr`` or ``json``.
    channels : tuple of int
        Ids of its channels; several where several nodes published.
    count : int or None
        Number of messages; None where the file does not say.
    """

    name: str
    schema: str
    encoding: str
    channels: tuple[int, ...]
    count: int | None

    def __str__(self) -> str:
        count = "?" if self.count is None else str(self.count)
        return f"{self.name} ({self.schema or 'no schema'}, {count} messages)"


@dataclass(slots=True)
class Contents:
    """What an MCAP file holds, from its summary or from a look through all of it.

    Attributes
    ----------
    schemas, channels : dict
        Records by id.
    counts : dict of int to int, or None
        Number of messages by channel id, where known.
    start, end : int
        Log times of the first and last message, ns.
    chunks : list of ChunkIndex
        Where the chunks are; empty where the file must be read from front to back.
    metadata : dict of str to dict
        Metadata records by name.
    damage : Damage or None
        Where a file without a good end stops being readable.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: Counter[int] | None = None
    start: int = 0
    end: int = 0
    chunks: list[ChunkIndex] = field(default_factory=list)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    damage: Damage | None = None


class LogFile:
    """An MCAP file on disk. It is opened anew for every pass, so passes may overlap.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    DataError
        If it is missing, empty or not MCAP.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.size = _checked_size(self.path)
        self.contents = _from_summary(self.path) or _survey(self.path, self.size)
        self._told_of_chunks = False
        if self.contents.damage is not None:
            self._tell_cut(self.contents.damage)

    def topics(self) -> list[Topic]:
        """Return the topics in order of name; one that changes its schema appears twice."""
        groups: dict[tuple[str, str, str], list[int]] = {}
        for number, channel in sorted(self.contents.channels.items()):
            schema = self.contents.schemas.get(channel.schema_id)
            key = (channel.topic, schema.name if schema else "", channel.message_encoding)
            groups.setdefault(key, []).append(number)
        counts = self.contents.counts
        return [
            Topic(*key, tuple(ids), None if counts is None else sum(counts[i] for i in ids))
            for key, ids in sorted(groups.items())
        ]

    def messages(
        self, channels: Collection[int], since: int | None = None, until: int | None = None
    ) -> Iterator[Message]:
        """Yield the messages of some channels.

        In order of log time where the file has an index, else in the order of the file.

        Parameters
        ----------
        channels : collection of int
            Ids of the wanted channels.
        since, until : int, optional
            First log time to give, and the one to stop before, ns.
        """
        since = 0 if since is None else since
        until = 2**64 if until is None else until
        wanted = frozenset(channels)
        damaged: list[Damage] = []
        with self.path.open("rb") as file:
            if self.contents.chunks:
                chunks = [
                    chunk
                    for chunk in self.contents.chunks
                    if chunk.message_end_time >= since
                    and chunk.message_start_time < until
                    and _may_hold(chunk, wanted)
                ]
                found: Iterator[McapRecord] = indexed.messages(file, chunks, wanted, damaged.append)
            else:
                found = _until_damage(linear.records(file, self.size))
            for record in found:
                if (
                    isinstance(record, Message)
                    and record.channel_id in wanted
                    and since <= record.log_time < until
                ):
                    yield record
        self._tell_chunks(damaged)

    def digest(self) -> str:
        """Return the SHA-256 of the file's bytes, in hexadecimal."""
        with self.path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()

    def _tell_chunks(self, damaged: list[Damage]) -> None:
        if damaged and not self._told_of_chunks:
            self._told_of_chunks = True
            log.warning(
                f"{self.path}: {len(damaged)} of {len(self.contents.chunks)} chunks are damaged "
                f"and left out, the first at byte {damaged[0].offset} ({damaged[0].reason})"
            )

    def _tell_cut(self, damage: Damage) -> None:
        total = (self.contents.counts or Counter()).total()
        seconds = (self.contents.end - self.contents.start) * 1e-9
        log.warning(
            f"{self.path} is cut off or damaged: read {total} messages over {seconds:.1f} s, up to "
            f"byte {damage.offset} of {self.size} ({damage.reason}); 'mcap recover' makes a whole "
            "file of what is left"
        )


def _checked_size(path: Path) -> int:
    try:
        with path.open("rb") as file:
            start = file.read(16)
            size = path.stat().st_size
    except FileNotFoundError as error:
        raise DataError(f"no such log: {path}") from error
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}") from error
    if size == 0:
        raise DataError(f"{path} is empty (0 bytes): not an MCAP file")
    if not start.startswith(MAGIC):
        hint = next((hint for sign, hint in OTHER_FILES.items() if start.startswith(sign)), None)
        raise DataError(
            f"{path} is not an MCAP file ("
            + (f"it is {hint})" if hint else f"it begins with {start[:8]!r})")
        )
    return size


def _from_summary(path: Path) -> Contents | None:
    """Return what the summary says, or None where there is none to rely on."""
    with path.open("rb") as file:
        try:
            reader = SeekingReader(file, record_size_limit=path.stat().st_size)
            summary = reader.get_summary()
            if summary is None or not _complete(summary):
                return None
            metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        except Exception as error:  # a parser fed with damaged bytes may raise anything
            log.debug("%s: no usable summary (%s)", path, linear.describe(error))
            return None
    statistics = summary.statistics
    return Contents(
        schemas=summary.schemas,
        channels=summary.channels,
        counts=None if statistics is None else Counter(statistics.channel_message_counts),
        start=min(chunk.message_start_time for chunk in summary.chunk_indexes),
        end=max(chunk.message_end_time for chunk in summary.chunk_indexes),
        chunks=summary.chunk_indexes,
        metadata=metadata,
    )


def _complete(summary: Summary) -> bool:
    """Tell whether a summary has all that reading by index takes."""
    known = all(
        channel.schema_id == 0 or channel.schema_id in summary.schemas
        for channel in summary.channels.values()
    )
    held = {number for chunk in summary.chunk_indexes for number in chunk.message_index_offsets}
    statistics = summary.statistics
    if statistics is not None:
        held |= set(statistics.channel_message_counts)
        known = known and statistics.chunk_count == len(summary.chunk_indexes)
    return (
        bool(summary.chunk_indexes)
        and known
        and bool(summary.channels)
        and held <= set(summary.channels)
    )


def _survey(path: Path, size: int) -> Contents:
    """Look through the whole file and note what is in it, up to its end or its first damage."""
    found = Contents(counts=Counter())
    assert found.counts is not None
    with path.open("rb") as file:
        try:
            for record in linear.records(file, size):
                if isinstance(record, Message):
                    first = not found.counts
                    found.counts[record.channel_id] += 1
                    found.start = record.log_time if first else min(found.start, record.log_time)
                    found.end = max(found.end, record.log_time)
                elif isinstance(record, Schema):
                    found.schemas[record.id] = record
                elif isinstance(record, Channel):
                    found.channels[record.id] = record
                elif isinstance(record, Metadata):
                    found.metadata[record.name] = record.metadata
        except Damage as damage:
            found.damage = damage
    return found


def _until_damage(records: Iterator[McapRecord]) -> Iterator[McapRecord]:
    try:
        yield from records
    except Damage:  # told when the file was opened
        return


def _may_hold(chunk: ChunkIndex, channels: frozenset[int]) -> bool:
    offsets = chunk.message_index_offsets
    return not offsets or not channels.isdisjoint(offsets)
