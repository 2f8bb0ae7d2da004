"""The records of an MCAP file: how they begin and end, and what is inside them."""

from __future__ import annotations

import struct
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from io import BytesIO
from typing import Any, cast

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

#: Opcode and length of what follows.
HEAD = struct.Struct("<BQ")
MESSAGE = struct.Struct("<HIQQ")
#: Where the summary begins, where its offsets begin, and its checksum.
FOOTER = struct.Struct("<QQI")
FOOTER_LENGTH = FOOTER.size
#: Bytes from which on messages are not copied out of their chunk until they are given.
LARGE_MESSAGE = 2**18
#: From here on opcodes belong to applications.
PRIVATE = 0x80

_READERS: dict[int, Callable[[Any], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.FOOTER: Footer.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.CHUNK: Chunk.read,
    Opcode.MESSAGE_INDEX: MessageIndex.read,
    Opcode.CHUNK_INDEX: ChunkIndex.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.METADATA: Metadata.read,
    Opcode.METADATA_INDEX: MetadataIndex.read,
    Opcode.SUMMARY_OFFSET: SummaryOffset.read,
    Opcode.DATA_END: DataEnd.read,
}
#: Opcodes that the format defines.
KNOWN = frozenset({Opcode.MESSAGE.value, *(int(opcode) for opcode in _READERS)})


def parse(opcode: int, body: bytes) -> McapRecord | None:
    """Return the record that a body holds; None for those of applications.

    Parameters
    ----------
    opcode : int
        Kind of the record.
    body : bytes
        What follows its head.

    Raises
    ------
    Exception
        Nearly anything, where the body is damaged.
    """
    if opcode == Opcode.MESSAGE:
        channel, sequence, log_time, publish_time = MESSAGE.unpack_from(body)
        return Message(channel, log_time, body[MESSAGE.size :], publish_time, sequence)
    if opcode >= PRIVATE:
        return None
    if opcode not in _READERS:
        raise ValueError(f"a record of the unknown kind {opcode:#04x}")
    return _READERS[opcode](ReadDataStream(BytesIO(body)))


def owned(message: Message) -> Message:
    """Return a message with bytes of its own; see :func:`split`."""
    data: object = message.data
    return replace(message, data=bytes(data)) if isinstance(data, memoryview) else message


def split(data: bytes, wanted: Collection[int] | None = None) -> Iterator[McapRecord]:
    """Yield the schemas, channels and messages of a chunk's uncompressed content.

    The data of large messages are views of the content, so that a chunk that is sorted before it
    is given takes its memory once; :func:`owned` gives them bytes of their own.

    Parameters
    ----------
    data : bytes
        The content.
    wanted : collection of int, optional
        Ids of the channels whose messages to give; all by default.

    Raises
    ------
    Exception
        Nearly anything, where the content is damaged.
    """
    at, end = 0, len(data)
    while at < end:
        opcode, length = HEAD.unpack_from(data, at)
        at += HEAD.size
        if at + length > end:
            raise ValueError("a record is longer than its chunk")
        if opcode == Opcode.MESSAGE:
            channel, sequence, log_time, publish_time = MESSAGE.unpack_from(data, at)
            if wanted is None or channel in wanted:
                whole = memoryview(data) if length > LARGE_MESSAGE else data
                content = cast(bytes, whole[at + MESSAGE.size : at + length])
                yield Message(channel, log_time, content, publish_time, sequence)
        elif opcode in (Opcode.CHANNEL, Opcode.SCHEMA):
            record = parse(opcode, data[at : at + length])
            assert record is not None  # both are known
            yield record
        at += length
