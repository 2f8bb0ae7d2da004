"""An MCAP file read from front to back, for files without an index and for damaged ones."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Collection, Iterator
from io import BytesIO
from typing import IO

from mcap.opcode import Opcode
from mcap.records import Channel, McapRecord, Message

from placecue.limits import current_limits
from placecue.logs.mcap.chunks import ChunkHead, ContentReader, read_head, salvage
from placecue.logs.mcap.framing import FOOTER_LENGTH, HEAD, KNOWN, PRIVATE, owned, parse, split

MAGIC = b"\x89MCAP0\r\n"
#: The beginning of a record of a known kind, shorter than 2^40 bytes.
BEGINNING = re.compile(rb"(?=[\x01-\x0f].{5}\0{3})", re.DOTALL)
#: Bytes that are searched together for the beginning of a record.
BLOCK = 2**20
#: Bytes of a record that is not read unless another one follows it.
LARGE = 2**26
CUT = "the file ends in the middle of a record"


class Damage(Exception):
    """A place where the file cannot be read.

    Parameters
    ----------
    offset : int
        Where it begins, bytes.
    reason : str
        What went wrong.
    lost : int or None
        How many messages are lost there, where that is known.
    """

    def __init__(self, offset: int, reason: str, lost: int | None = None) -> None:
        super().__init__(offset, reason)
        self.offset = offset
        self.reason = reason
        self.lost = lost


OnDamage = Callable[[Damage], None]


def records(
    file: IO[bytes],
    size: int,
    on_damage: OnDamage,
    channels: Collection[int] = (),
    on_chunk: Callable[[], None] = lambda: None,
) -> Iterator[McapRecord]:
    """Yield every record in the order of the file, those inside chunks too.

    What is damaged is told of and left out; the reading goes on with the next record that is
    whole. Messages out of a chunk that does not match its checksum are given where they are
    framed as they should be.

    Parameters
    ----------
    file : binary file
        The log.
    size : int
        Its length, bytes; no record can be longer.
    on_damage : callable
        Called for each damaged place.
    channels : collection of int
        Ids of channels that are known to exist, beside those that the records name.
    on_chunk : callable
        Called for each chunk, sound or damaged.
    """
    walk = _Walk(file, size, on_damage, channels)
    walk.on_chunk = on_chunk
    yield from walk.records(len(MAGIC))


def messages_of(content: bytes | bytearray, channels: Collection[int] = ()) -> Iterator[McapRecord]:
    """Yield what can be read of a damaged chunk's uncompressed content."""
    walk = _Walk(BytesIO(content), len(content), lambda damage: None, channels, inside=True)
    return walk.records(0)


def describe(error: Exception) -> str:
    """Say in a few words what a parser choked on."""
    if isinstance(error, struct.error | EOFError):  # no record ends before its fields do
        return CUT
    return " ".join(str(error).split()) or type(error).__name__


class _Walk:
    """A way through the records of a file, or of a chunk's content (``inside``)."""

    def __init__(
        self,
        file: IO[bytes],
        size: int,
        on_damage: OnDamage,
        channels: Collection[int],
        inside: bool = False,
    ) -> None:
        self.file = file
        self.contents = ContentReader(file)
        self.size = size
        self.on_damage = on_damage
        self.channels = set(channels)
        self.inside = inside
        self.on_chunk: Callable[[], None] = lambda: None

    def records(self, at: int) -> Iterator[McapRecord]:
        """Yield the records from a place on."""
        place: int | None = at
        while place is not None and not self._over(place):
            head = self._head(place)
            if head is None:
                found, place = self._broken(place)
            elif head == (Opcode.FOOTER, FOOTER_LENGTH):
                found, place = self._footer(place)
            else:
                found, place = self._record(place, *head)
            for record in found:
                self._note(record)
                yield owned(record) if isinstance(record, Message) else record

    def _over(self, at: int) -> bool:
        return self.inside and at == self.size

    def _head(self, at: int) -> tuple[int, int] | None:
        """Return opcode and length of the record at a place; None where there cannot be one."""
        self.file.seek(at)
        data = self.file.read(HEAD.size)
        if len(data) < HEAD.size:
            return None
        opcode, length = HEAD.unpack(data)
        fits = at + HEAD.size + length <= self.size
        return (opcode, length) if fits and (opcode in KNOWN or opcode >= PRIVATE) else None

    def _record(self, at: int, opcode: int, length: int) -> tuple[Iterator[McapRecord], int | None]:
        """Return what a record holds, and where to go on."""
        end = at + HEAD.size + length
        followed = self._over(end) or self._head(end) is not None
        if not followed and length > LARGE:
            return self._broken(at)
        try:
            found = self._content(at, opcode, length)
        except Exception as error:  # a parser fed with damaged bytes may raise anything
            if opcode == Opcode.CHUNK:
                return self._chunk(at, end if followed else None, describe(error))
            self._tell(at, describe(error))
            return iter(()), end if followed else self._search(at + 1)
        if not followed and opcode != Opcode.CHUNK:
            # Either its length is damaged, or what follows it is.
            place = self._search(at + HEAD.size)
            if place is not None and place < end:
                self._tell(at, "the length of a record is wrong")
                return iter(()), place
        return found, end

    def _content(self, at: int, opcode: int, length: int) -> Iterator[McapRecord]:
        if opcode == Opcode.ATTACHMENT and (over := current_limits().over("file", length)):
            raise ValueError(f"an attachment of {length} bytes, {over}")
        if opcode == Opcode.CHUNK:
            head = read_head(self.file, at + HEAD.size)
            if head.content + head.length != at + HEAD.size + length:
                raise ValueError("the length of a chunk is wrong")
            found = list(split(self.contents.content(head)))
            self.on_chunk()
            return iter(found)
        self.file.seek(at + HEAD.size)
        record = parse(opcode, self.file.read(length))
        return iter(() if record is None else (record,))

    def _broken(self, at: int) -> tuple[Iterator[McapRecord], int | None]:
        """Go on behind a place where a record should begin and none does."""
        self.file.seek(at)
        if self.file.read(1) == bytes([Opcode.CHUNK]):
            return self._chunk(at, None, CUT)
        self._tell(at, self._why(at))
        return iter(()), self._search(at + 1)

    def _why(self, at: int) -> str:
        self.file.seek(at)
        data = self.file.read(HEAD.size)
        if len(data) < HEAD.size or data[0] in KNOWN:
            return CUT
        return f"a record of the unknown kind {data[0]:#04x}"

    def _chunk(
        self, at: int, end: int | None, reason: str
    ) -> tuple[Iterator[McapRecord], int | None]:
        """Read what there is of a damaged or cut chunk."""
        self._tell(at, reason)
        self.on_chunk()
        try:
            head = read_head(self.file, at + HEAD.size)
        except (ValueError, struct.error):
            return iter(()), self._search(at + 1) if end is None else end
        if end is not None and current_limits().over("chunk", head.size):
            return iter(()), end
        if not head.compression:
            return iter(()), head.content  # its records are read as if there were no chunk
        content, broken = salvage(self.file, head)
        found = within(messages_of(content, self.channels), head)
        # What does not compress is stored as it is, so the search must not see again what was read.
        return found, self._search(broken) if end is None else end

    def _footer(self, at: int) -> tuple[Iterator[McapRecord], None]:
        end = at + HEAD.size + FOOTER_LENGTH
        self.file.seek(at + HEAD.size)
        record = parse(Opcode.FOOTER, self.file.read(FOOTER_LENGTH))
        if self.file.read(len(MAGIC)) != MAGIC:
            self._tell(end, "the file does not end as it should")
        assert record is not None  # footers are known
        return iter((record,)), None

    def _search(self, start: int) -> int | None:
        """Return where the next record begins that is whole and followed by another."""
        while start < self.size:
            self.file.seek(start)
            block = self.file.read(BLOCK + HEAD.size - 1)
            for match in BEGINNING.finditer(block):
                if self._whole(start + match.start()):
                    return start + match.start()
            start += BLOCK
        return None

    def _whole(self, at: int) -> bool:
        head = self._head(at)
        if head is None or head[0] >= PRIVATE:
            return False
        opcode, length = head
        end = at + HEAD.size + length
        if opcode == Opcode.FOOTER:
            return length == FOOTER_LENGTH
        if end != self.size and self._head(end) is None:
            return False
        try:
            if opcode == Opcode.CHUNK:
                chunk = read_head(self.file, at + HEAD.size)
                return chunk.content + chunk.length == end
            if opcode == Opcode.ATTACHMENT:
                return end != self.size
            self.file.seek(at + HEAD.size)
            record = parse(opcode, self.file.read(length))
        except Exception:  # a parser fed with anything may raise anything
            return False
        return not isinstance(record, Message) or record.channel_id in self.channels

    def _note(self, record: McapRecord) -> None:
        if isinstance(record, Channel):
            self.channels.add(record.id)

    def _tell(self, at: int, reason: str) -> None:
        self.on_damage(Damage(at, reason))


def within(found: Iterator[McapRecord], head: ChunkHead) -> Iterator[McapRecord]:
    """Leave out the messages whose time cannot be right, for it is not that of their chunk."""
    for record in found:
        if not isinstance(record, Message) or head.start <= record.log_time <= head.end:
            yield record
