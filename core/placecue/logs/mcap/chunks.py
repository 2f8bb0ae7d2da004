"""The content of chunks: whole where it is sound, as far as it goes where it is not."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import IO, Any

import lz4.frame
import zstandard

from placecue.limits import current_limits

#: Times of the first and last message, size and checksum of the content, length of a name.
FIELDS = struct.Struct("<QQQII")
LENGTH = struct.Struct("<Q")
COMPRESSIONS = ("", "lz4", "zstd")
LONGEST_NAME = 32
#: A byte of lz4 cannot stand for more than this.
LZ4_MOST = 256
#: Larger contents are not kept: what they cost is not the asking for memory.
KEPT = 2**24
#: Bytes that are salvaged from a chunk that says to be larger than chunks may be.
SALVAGED = 2**26

Decoder = Callable[[], Any]
STREAMS: dict[str, Decoder] = {
    "zstd": lambda: zstandard.ZstdDecompressor().decompressobj(),
    "lz4": lz4.frame.LZ4FrameDecompressor,
}


class TooLarge(ValueError):
    """A chunk is larger, unpacked, than chunks may be."""


@dataclass(frozen=True, slots=True)
class ChunkHead:
    """What stands before the content of a chunk.

    Parameters
    ----------
    start, end : int
        Log times of its first and last message, ns.
    size : int
        Bytes of its content, uncompressed.
    crc : int
        Checksum of its content; 0 where there is none.
    compression : str
        ``lz4``, ``zstd``, or empty.
    content : int
        Where the content begins in the file.
    length : int
        Bytes of the content in the file.
    """

    start: int
    end: int
    size: int
    crc: int
    compression: str
    content: int
    length: int


def read_head(file: IO[bytes], at: int) -> ChunkHead:
    """Read the fields of a chunk whose record's body begins at a place.

    Raises
    ------
    ValueError
        If they are no fields of a chunk, or it is compressed in an unknown way.
    struct.error
        If the file ends before they do.
    """
    file.seek(at)
    start, end, size, crc, letters = FIELDS.unpack(file.read(FIELDS.size))
    if letters > LONGEST_NAME:
        raise ValueError("a chunk whose compression has no name")
    name = file.read(letters).decode("utf-8", "replace")
    if name not in COMPRESSIONS:
        raise ValueError(f"a chunk compressed with '{name}', which is not known")
    (length,) = LENGTH.unpack(file.read(LENGTH.size))
    return ChunkHead(start, end, size, crc, name, file.tell(), length)


class ContentReader:
    """Reads the content of sound chunks.

    The content given last is kept until the next one is there: memory that goes back to the
    system and is asked for anew with every chunk costs several times what the reading does.

    Parameters
    ----------
    file : binary file
        The log.
    sound : set of int, optional
        Where contents begin whose checksums have been found right; they are not computed again.
    """

    def __init__(self, file: IO[bytes], sound: set[int] | None = None) -> None:
        self.file = file
        self.sound: set[int] = set() if sound is None else sound
        self._kept = (b"", b"")

    def content(self, head: ChunkHead) -> bytes:
        """Return the uncompressed content of a chunk.

        Raises
        ------
        Exception
            Nearly anything, where it is damaged; ValueError where sizes or checksum differ.
        TooLarge
            If it would take more memory than a chunk may.
        """
        check_size(head.size)
        self.file.seek(head.content)
        data = self.file.read(head.length)
        if len(data) != head.length:
            raise ValueError("the file ends in the middle of a chunk")
        content = _uncompressed(data, head)
        self._kept = (data, content) if len(content) <= KEPT else (b"", b"")
        if len(content) != head.size:
            raise ValueError(f"a chunk of {len(content)} bytes that is said to have {head.size}")
        if head.crc and head.content not in self.sound and zlib.crc32(content) != head.crc:
            raise ValueError("a chunk does not match its checksum")
        self.sound.add(head.content)
        return content


def check_size(size: int) -> None:
    """Raise TooLarge where a chunk of so many bytes, unpacked, is more than chunks may have."""
    over = current_limits().over("chunk", size)
    if over:
        raise TooLarge(f"a chunk of {size} bytes when unpacked, {over}")


def _uncompressed(data: bytes, head: ChunkHead) -> bytes:
    if head.compression == "zstd":
        said = zstandard.frame_content_size(data)
        if said not in (-1, head.size):  # nothing is allocated for a size that is damaged
            raise ValueError(f"a chunk of {said} bytes that is said to have {head.size}")
        return zstandard.decompress(data, head.size)
    if head.compression == "lz4":
        if head.size > LZ4_MOST * (len(data) + 1):
            raise ValueError(f"{len(data)} bytes of lz4 cannot hold the {head.size} of the chunk")
        # Told the size, it is several times as fast as lz4.frame.decompress.
        content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=head.size)
        return content
    return data


def salvage(file: IO[bytes], head: ChunkHead, piece: int = 2**12) -> tuple[bytes | bytearray, int]:
    """Return as much of a damaged or cut chunk's content as can be uncompressed, and its end.

    The compressed stream itself says where it ends, so the length in the head is not relied on.
    No more is uncompressed than the head says, or than 64 MiB where it says too much.

    Parameters
    ----------
    file : binary file
        The log.
    head : ChunkHead
        Of a compressed chunk.
    piece : int
        Bytes that are uncompressed together.

    Returns
    -------
    content : bytes
        What was uncompressed.
    end : int
        Where in the file the stream ends or breaks.
    """
    make = STREAMS[head.compression]
    decoder, found = make(), bytearray()
    most = SALVAGED if current_limits().over("chunk", head.size) else max(head.size, SALVAGED)
    at = head.content
    file.seek(at)
    while len(found) < most and not decoder.eof and (data := file.read(piece)):
        try:
            found += decoder.decompress(data)
        except Exception:  # decoders raise their own, over damaged bytes
            last, at = _last_blocks(make, file, head.content, at, piece)
            found += last
            break
        at += len(data)
    else:
        at -= len(decoder.unused_data or b"")
    del found[most:]
    return found, at


def _last_blocks(
    make: Decoder, file: IO[bytes], start: int, at: int, piece: int
) -> tuple[bytes, int]:
    """Uncompress byte by byte the piece in which a stream breaks; return what it adds, and where.

    The piece begins ``at``, the stream at ``start``.
    """
    decoder = make()
    file.seek(start)
    for _ in range(start, at, piece):
        decoder.decompress(file.read(piece))
    found = []
    for byte in file.read(piece):
        try:
            found.append(decoder.decompress(bytes([byte])))
        except Exception:  # here it breaks
            break
        at += 1
    return b"".join(found), at
