"""Logs with flipped, missing and doubled bytes: everything before the damage is delivered."""

from __future__ import annotations

import random
import struct
import tracemalloc
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from io import BufferedReader, BytesIO, FileIO
from pathlib import Path
from typing import Any

import lz4.frame
import pytest
import zstandard
from mcap.reader import make_reader
from mcap.records import Chunk, Message
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, IndexType, Writer

from mcap_logs import jpeg
from placecue.errors import PlacecueError
from placecue.logs import open_log
from placecue.logs.mcap.container import LogFile

CASES = 400  # of each kind of file: 2,000 in all
KINDS: dict[str, dict[str, Any]] = {
    "zstd": {"chunk_size": 1500},
    "lz4": {"chunk_size": 1500, "compression": CompressionType.LZ4},
    "uncompressed": {"chunk_size": 1500, "compression": CompressionType.NONE},
    "unchunked": {"use_chunking": False},
    "one chunk, no index": {"index_types": IndexType.NONE, "use_statistics": False},
}
#: What reading a log may take: its bytes so many times and one block, and so much memory.
PASSES, BLOCK, MEMORY = 40, 10_000, 4_000_000
Sent = tuple[int, bytes]  # log time, data


def whole_log(ros2: Any, options: dict[str, Any]) -> bytes:
    log = ros2("whole.mcap")
    for i in range(12):
        t = i * 0.1
        if i % 4 == 0:
            log.string(t, f"room {i}")
        log.odom(t, 0.1 * i, 0.0, 0.0)
        log.scan(t, [1.0 + i, 2.0, 3.0, 4.0 + i])
        if i % 3 == 0:
            log.image(t, jpeg(10 * i, (4, 4)))
    return rewritten(Path(log.close()), options)


def rewritten(path: Path, options: dict[str, Any]) -> bytes:
    """Return a log with the same messages, written in another way."""
    out = BytesIO()
    writer = Writer(out, **options)
    writer.start()
    channels: dict[int, int] = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if channel.id not in channels:
                assert schema is not None
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                encoding = channel.message_encoding
                channels[channel.id] = writer.register_channel(channel.topic, encoding, number)
            stamp = message.log_time
            writer.add_message(channels[channel.id], stamp, message.data, stamp)
    writer.finish()
    return out.getvalue()


def sent(data: bytes) -> list[tuple[int, Sent]]:
    """Return where each message is whole: the end of its record, or of its compressed chunk.

    Uncompressed chunks are opened by hand: 9 bytes of head, then 8 + 8 + 8 + 4 + 4 + 8.
    """
    found = []
    file = BytesIO(data)
    for record in StreamReader(file, emit_chunks=True).records:
        if isinstance(record, Message):
            found.append((file.tell(), (record.log_time, record.data)))
        elif isinstance(record, Chunk):
            end = file.tell()
            content = {
                "zstd": lambda c: zstandard.decompress(c.data, c.uncompressed_size),
                "lz4": lambda c: lz4.frame.decompress(c.data),
                "": lambda c: c.data,
            }[record.compression](record)
            at = 0
            while at < len(content):
                opcode, length = struct.unpack_from("<BQ", content, at)
                at += 9 + length
                if opcode == 5:
                    (time,) = struct.unpack_from("<Q", content, at - length + 6)
                    whole = end if record.compression else end - len(content) + at
                    found.append((whole, (time, content[at - length + 22 : at])))
    return found


def damaged(data: bytes, rng: random.Random) -> tuple[bytes, int]:
    """Return damaged bytes, and the first byte that is not as it was."""
    at = rng.randrange(len(data))
    length = min(rng.choice([1, 2, 8, 50, 500]), len(data) - at)
    way = rng.choice(["flip", "cut off", "cut out", "double"])
    if way == "flip":
        spoilt = bytes(byte ^ rng.randrange(1, 256) for byte in data[at : at + length])
        return data[:at] + spoilt + data[at + length :], at
    if way == "cut off":
        return data[:at], at
    if way == "cut out":
        return data[:at] + data[at + length :], at
    return data[: at + length] + data[at:], at + length


def delivered(path: Path) -> Counter[Sent]:
    try:
        file = LogFile(path)
        found = list(file.messages(file.contents.channels))
    except PlacecueError as error:
        assert "\n" not in str(error)  # noqa: PT017
        return Counter()
    return Counter((message.log_time, message.data) for message in found)


class Metered(BufferedReader):
    """Counts the bytes that are read from all files of its kind."""

    count = 0

    def read(self, size: int | None = -1, /) -> bytes:
        data = super().read(size)
        Metered.count += len(data)
        return data

    def readinto(self, buffer: Any, /) -> int:
        count = super().readinto(buffer)
        Metered.count += count
        return count


@contextmanager
def within_passes(size: int) -> Iterator[None]:
    """Check that a file of so many bytes is read within a bounded number of passes."""
    Metered.count = 0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Path, "open", lambda path, mode: Metered(FileIO(path, mode)))
        yield
    assert Metered.count < PASSES * size + BLOCK


@contextmanager
def within_memory() -> Iterator[None]:
    """Check that no more than so much memory is asked for."""
    tracemalloc.start()
    try:
        yield
        _, highest = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert highest < MEMORY


@pytest.mark.parametrize("kind", KINDS)
def test_damage(ros2: Any, tmp_path: Path, kind: str) -> None:
    whole = whole_log(ros2, KINDS[kind])
    messages = sent(whole)
    assert len(messages) == 31
    rng = random.Random(f"placecue {kind}")
    path = tmp_path / "damaged.mcap"
    for case in range(CASES):
        data, first = damaged(whole, rng)
        path.write_bytes(data)
        traced = within_memory() if case % 20 == 0 else nullcontext()  # it is slow
        with within_passes(len(data)), traced:
            found = delivered(path)
            try:
                list(open_log(path))
            except PlacecueError as error:
                assert "\n" not in str(error)  # noqa: PT017
        intact = Counter(message for end, message in messages if end <= first)
        missing = intact - found
        assert not missing, f"case {case}: {missing.total()} of {intact.total()} before {first}"
