"""An MCAP file read from front to back, for files without an index and for cut ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO

from mcap.exceptions import EndOfFile, RecordLengthLimitExceeded
from mcap.records import Chunk, McapRecord
from mcap.stream_reader import StreamReader, breakup_chunk


class Damage(Exception):
    """The file cannot be read on from here.

    Parameters
    ----------
    offset : int
        Where the last readable record ends, bytes.
    reason : str
        What went wrong.
    """

    def __init__(self, offset: int, reason: str) -> None:
        super().__init__(offset, reason)
        self.offset = offset
        self.reason = reason


def records(file: IO[bytes], size: int) -> Iterator[McapRecord]:
    """Yield every record in the order of the file, those inside chunks too.

    Parameters
    ----------
    file : binary file
        Open at its beginning.
    size : int
        Its length, bytes; no record can be longer.

    Raises
    ------
    Damage
        If the file ends, or stops making sense, before its footer.
    """
    reader = iter(StreamReader(file, emit_chunks=True, record_size_limit=size).records)
    while True:
        offset = file.tell()
        try:
            record = next(reader, None)
            inside = contents(record) if isinstance(record, Chunk) else None
        except Exception as error:  # a parser fed with damaged bytes may raise anything
            raise Damage(offset, describe(error)) from error
        if record is None:
            return
        if inside is None:
            yield record
        else:
            yield from inside


def contents(chunk: Chunk) -> list[McapRecord]:
    """Return the records inside a chunk; raises nearly anything where it is damaged."""
    if chunk.compression not in {"", "lz4", "zstd"}:
        raise ValueError(f"chunks compressed with '{chunk.compression}', which is not known")
    return breakup_chunk(chunk, validate_crc=True)


def describe(error: Exception) -> str:
    """Say in a few words what a parser choked on."""
    if isinstance(error, EndOfFile | RecordLengthLimitExceeded):  # no record outgrows the file
        return "the file ends in the middle of a record"
    return " ".join(str(error).split()) or type(error).__name__
