"""The messages of an indexed MCAP file, in order of log time, one chunk in memory at a time."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, Message

from placecue.logs.linear import Damage, contents, describe


def messages(
    file: IO[bytes],
    indexes: Iterable[ChunkIndex],
    channels: Collection[int],
    on_damage: Callable[[Damage], None],
) -> Iterator[Message]:
    """Yield the messages of some channels in order of log time.

    Chunks that overlap in time are merged. A damaged chunk is left out and told of.

    Parameters
    ----------
    file : binary file
        The log.
    indexes : iterable of ChunkIndex
        The chunks to read.
    channels : collection of int
        Ids of the wanted channels.
    on_damage : callable
        Called for each chunk that cannot be read.
    """
    pending: list[tuple[int, int, Message]] = []  # log time, running number, message
    number = 0
    for index in sorted(indexes, key=lambda chunk: chunk.message_start_time):
        while pending and pending[0][0] < index.message_start_time:
            yield heapq.heappop(pending)[2]
        try:
            inside = _chunk_messages(file, index, channels)
        except Damage as damage:
            on_damage(damage)
            continue
        for message in inside:
            heapq.heappush(pending, (message.log_time, number, message))
            number += 1
    while pending:
        yield heapq.heappop(pending)[2]


def _chunk_messages(file: IO[bytes], index: ChunkIndex, channels: Collection[int]) -> list[Message]:
    try:
        file.seek(index.chunk_start_offset)
        stream = ReadDataStream(file)
        opcode, length = stream.read1(), stream.read8()
        if opcode != Opcode.CHUNK or length != index.chunk_length - 9:
            raise ValueError("the index points to something that is not the chunk")
        inside = contents(Chunk.read(stream))
    except Exception as error:  # a parser fed with damaged bytes may raise anything
        raise Damage(index.chunk_start_offset, describe(error)) from error
    return [
        record for record in inside if isinstance(record, Message) and record.channel_id in channels
    ]
