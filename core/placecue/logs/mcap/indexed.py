"""The messages of an indexed MCAP file, in order of log time, few chunks in memory at a time."""

from __future__ import annotations

import struct
from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator
from operator import attrgetter
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import ChunkIndex, McapRecord, Message, MessageIndex

from placecue.logs.mcap.chunks import (
    ChunkHead,
    ContentReader,
    TooLarge,
    read_head,
    salvage,
)
from placecue.logs.mcap.framing import HEAD, owned, split
from placecue.logs.mcap.linear import Damage, OnDamage, describe, messages_of, within

log_time = attrgetter("log_time")


def messages(
    file: IO[bytes],
    indexes: Iterable[ChunkIndex],
    channels: Collection[int],
    on_damage: OnDamage,
    sound: set[int],
) -> Iterator[Message]:
    """Yield the messages of some channels in order of log time.

    Chunks that overlap in time are merged. What can be read of a damaged chunk is given, and
    the damage told of.

    Parameters
    ----------
    file : binary file
        The log.
    indexes : iterable of ChunkIndex
        The chunks to read.
    channels : collection of int
        Ids of the wanted channels.
    on_damage : callable
        Called for each damaged chunk.
    sound : set of int
        Where the contents of chunks begin whose checksums have been found right, in this pass or
        an earlier one; they are not computed again.
    """
    contents = ContentReader(file, sound)
    pending: list[Message] = []  # in order of log time
    for index in sorted(indexes, key=lambda chunk: chunk.message_start_time):
        due = bisect_left(pending, index.message_start_time, key=log_time)
        yield from map(owned, pending[:due])
        del pending[:due]
        inside = sorted(_chunk(contents, index, channels, on_damage), key=log_time)
        if pending and inside and inside[0].log_time < pending[-1].log_time:
            pending = sorted([*pending, *inside], key=log_time)  # stable: earlier chunks first
        else:
            pending += inside
    yield from map(owned, pending)


def times(file: IO[bytes], index: ChunkIndex) -> dict[int, list[int]] | None:
    """Return the log times of a chunk's messages by channel, without reading the chunk.

    None where the file has no index of the messages, or it is damaged.
    """
    found: dict[int, list[int]] = {}
    try:
        for channel, offset in index.message_index_offsets.items():
            file.seek(offset)
            opcode, length = HEAD.unpack(file.read(HEAD.size))
            if opcode != Opcode.MESSAGE_INDEX or length > index.message_index_length:
                return None
            record = MessageIndex.read(ReadDataStream(file))
            if record.channel_id != channel:
                return None
            found[channel] = [time for time, _ in record.records]
    except Exception:  # a parser fed with damaged bytes may raise anything
        return None
    return found if index.message_index_offsets else None


def _chunk(
    contents: ContentReader, index: ChunkIndex, channels: Collection[int], on_damage: OnDamage
) -> list[Message]:
    file = contents.file
    try:
        return _wanted(split(contents.content(_head(file, index)), channels), channels)
    except Exception as error:  # a parser fed with damaged bytes may raise anything
        found = [] if isinstance(error, TooLarge) else _salvaged(file, index, channels)
        held = times(file, index)
        lost = None
        if held is not None:
            said = sum(len(stamps) for channel, stamps in held.items() if channel in channels)
            lost = max(said - len(found), 0)
        on_damage(Damage(index.chunk_start_offset, describe(error), lost))
        return found


def _head(file: IO[bytes], index: ChunkIndex) -> ChunkHead:
    file.seek(index.chunk_start_offset)
    if HEAD.unpack(file.read(HEAD.size)) != (Opcode.CHUNK, index.chunk_length - HEAD.size):
        raise ValueError("the index points to something that is not the chunk")
    head = read_head(file, index.chunk_start_offset + HEAD.size)
    if head.content + head.length != index.chunk_start_offset + index.chunk_length:
        raise ValueError("the length of a chunk is wrong")
    return head


def _salvaged(file: IO[bytes], index: ChunkIndex, channels: Collection[int]) -> list[Message]:
    """Return what can be read of a damaged chunk; its fields are those of the index."""
    content = index.chunk_start_offset + index.chunk_length - index.compressed_size
    head = ChunkHead(
        index.message_start_time,
        index.message_end_time,
        index.uncompressed_size,
        0,
        index.compression,
        content,
        index.compressed_size,
    )
    try:
        if head.compression:
            data: bytes | bytearray = salvage(file, head)[0]
        else:
            file.seek(content)
            data = file.read(head.length)
    except (OSError, KeyError, ValueError, struct.error):
        return []
    return _wanted(within(messages_of(data, index.message_index_offsets), head), channels)


def _wanted(found: Iterable[McapRecord], channels: Collection[int]) -> list[Message]:
    return [each for each in found if isinstance(each, Message) and each.channel_id in channels]
