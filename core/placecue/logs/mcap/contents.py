"""What an MCAP file holds: read from its summary, or found by a look through all of it."""

from __future__ import annotations

import logging
import zlib
from collections import Counter
from dataclasses import dataclass, field
from io import BufferedReader, RawIOBase
from pathlib import Path
from typing import IO, cast

from mcap.reader import FOOTER_SIZE, SeekingReader
from mcap.records import (
    Attachment,
    Channel,
    ChunkIndex,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    Schema,
    Statistics,
)
from mcap.summary import Summary

from placecue.logs.mcap import linear
from placecue.logs.mcap.framing import FOOTER, HEAD
from placecue.logs.mcap.linear import MAGIC, Damage

log = logging.getLogger(__name__)


@dataclass(slots=True)
class Contents:
    """What an MCAP file holds.

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
    attachments : list of str
        Names of attachments.
    profile : str
        Of the file's header.
    damages : list of Damage
        Where a file that was looked through cannot be read.
    said : int or None
        How many messages the file should hold by its own statistics, where it was looked through
        and has them.
    indexed : Counter of int
        How many messages by channel id the indexes behind the chunks name, where it was looked
        through.
    absent : int
        How many chunks the summary names beyond those that are there, where it was looked through.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: Counter[int] | None = None
    start: int = 0
    end: int = 0
    chunks: list[ChunkIndex] = field(default_factory=list)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: list[str] = field(default_factory=list)
    profile: str = ""
    damages: list[Damage] = field(default_factory=list)
    said: int | None = None
    indexed: Counter[int] = field(default_factory=Counter)
    absent: int = 0

    @property
    def damage(self) -> Damage | None:
        """The first place that cannot be read, or None."""
        return self.damages[0] if self.damages else None

    @property
    def lost(self) -> int | None:
        """How many messages a file has lost, where statistics or indexes are left to tell."""
        if self.counts is None:
            return None
        missing = (self.indexed - self.counts).total()
        if self.said is None:
            return missing or None
        return max(self.said - self.counts.total(), missing, 0)


def read_contents(path: Path, size: int) -> Contents:
    """Return what a file holds, from its summary or else by a look through all of it.

    Parameters
    ----------
    path : Path
        An MCAP file.
    size : int
        Its length, bytes.
    """
    return _from_summary(path, size) or _survey(path, size)


def _from_summary(path: Path, size: int) -> Contents | None:
    """Return what the summary says, or None where there is none to rely on."""
    with path.open("rb") as file:
        try:
            reader = SeekingReader(_Within(file, size), record_size_limit=size)
            summary = reader.get_summary()
            if summary is None or not _complete(summary) or not _matches_checksum(file, size):
                return None
            metadata = {record.name: record.metadata for record in reader.iter_metadata()}
            profile = reader.get_header().profile
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
        attachments=[each.name for each in summary.attachment_indexes],
        profile=profile,
    )


class _Within(BufferedReader):
    """Asks for no more than a file holds: a damaged length would reserve gigabytes."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        super().__init__(cast(RawIOBase, file))
        self.most = size

    def read(self, size: int | None = -1, /) -> bytes:
        return super().read(self.most if size is None else min(size, self.most))


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


def _matches_checksum(file: IO[bytes], size: int) -> bool:
    """Tell whether the summary is what was written: else it points to the wrong chunks."""
    footer = size - FOOTER_SIZE - len(MAGIC)
    file.seek(footer + HEAD.size)
    start, _, checksum = FOOTER.unpack(file.read(FOOTER.size))
    file.seek(start)
    covered = file.read(footer + FOOTER_SIZE - 4 - start)  # all but the checksum itself
    return bool(checksum == 0 or zlib.crc32(covered) == checksum)


def _survey(path: Path, size: int) -> Contents:
    """Look through the whole file and note what is in it."""
    found = Contents(counts=Counter())
    chunks, named = 0, set()

    def count() -> None:
        nonlocal chunks
        chunks += 1

    with path.open("rb") as file:
        for record in linear.records(file, size, found.damages.append, on_chunk=count):
            _take_in(found, record)
            if isinstance(record, ChunkIndex):
                named.add(record.chunk_start_offset)
    found.absent = max(len(named) - chunks, 0)
    return found


def _take_in(found: Contents, record: McapRecord) -> None:
    if isinstance(record, Message):
        assert found.counts is not None  # the survey counts
        first = not found.counts
        found.counts[record.channel_id] += 1
        found.start = record.log_time if first else min(found.start, record.log_time)
        found.end = max(found.end, record.log_time)
    elif isinstance(record, MessageIndex):
        found.indexed[record.channel_id] += len(record.records)
    elif isinstance(record, Schema):
        found.schemas.setdefault(record.id, record)
    elif isinstance(record, Channel):
        found.channels.setdefault(record.id, record)
    elif isinstance(record, Metadata):
        found.metadata[record.name] = record.metadata
    elif isinstance(record, Attachment):
        found.attachments.append(record.name)
    elif isinstance(record, Header):
        found.profile = record.profile
    elif isinstance(record, Statistics):
        consistent = sum(record.channel_message_counts.values()) == record.message_count
        found.said = record.message_count if consistent else None
