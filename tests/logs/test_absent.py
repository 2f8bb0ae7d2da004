"""Chunks that are too large, and chunks that are not there any more."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
import zstandard
from mcap.records import Chunk, ChunkIndex, MessageIndex
from mcap.stream_reader import StreamReader
from mcap.writer import IndexType, Writer

from placecue.errors import DataError
from placecue.limits import limited
from placecue.logs.mcap.container import LogFile


def written(folder: Path, topics: int = 1, **options: Any) -> Path:
    """Write twenty messages, five or so a chunk."""
    path = folder / "run.mcap"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=600, **options)
        writer.start()
        schema = writer.register_schema("some/Thing", "jsonschema", b"{}")
        ids = [writer.register_channel(f"/{n}", "json", schema) for n in range(topics)]
        for number in range(20):
            data = b"%d" % number * 50
            writer.add_message(ids[number % topics], number * 10**8, data, number * 10**8)
        writer.finish()
    return path


def count(path: Path) -> int:
    file = LogFile(path)
    return len(list(file.messages(set(file.contents.channels))))


def chunk_places(path: Path) -> list[tuple[int, int]]:
    """Return beginning and end of each chunk record."""
    with path.open("rb") as file:
        records = list(StreamReader(file, emit_chunks=True).records)
    found = [each for each in records if isinstance(each, ChunkIndex)]
    return [
        (each.chunk_start_offset, each.chunk_start_offset + each.chunk_length) for each in found
    ]


def without_chunk(path: Path) -> int:
    """Cut out the third chunk; return how many messages it held."""
    start, end = chunk_places(path)[2]
    data = path.read_bytes()
    before = count(path)
    path.write_bytes(data[:start] + data[end:])
    return before


def test_statistics_betray_a_chunk_that_was_cut_out(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = written(tmp_path)
    before = without_chunk(path)
    left = count(path)
    assert 0 < left < before
    (record,) = caplog.records
    assert "a chunk that its summary names cannot be found" in record.message
    assert f"{before - left} messages are lost" in record.message


def test_orphaned_indexes_betray_it_too(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = written(tmp_path, use_statistics=False, index_types=IndexType.MESSAGE)
    data = path.read_bytes()
    stream = BytesIO(data)
    # Without an index of chunks they are found by their indexes of messages behind them.
    reader = StreamReader(stream, emit_chunks=True)
    at, places, indexed = stream.tell(), [], 0
    for record in reader.records:
        if isinstance(record, Chunk):
            places.append((at, stream.tell()))
        indexed += isinstance(record, MessageIndex)
        at = stream.tell()
    assert indexed >= len(places) > 3
    before = count(path)
    path.write_bytes(data[: places[2][0]] + data[places[2][1] :])
    caplog.clear()
    left = count(path)
    assert 0 < left < before
    assert f"{before - left} messages are lost" in caplog.text


def test_a_sound_file_says_nothing(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    assert count(written(tmp_path)) == 20
    assert count(written(tmp_path, use_statistics=False, index_types=IndexType.NONE)) == 20
    assert not caplog.records


def test_a_chunk_larger_than_the_limit_is_left_out(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = written(tmp_path)
    with limited({"chunk": 50}):
        assert count(path) == 0
    assert "bytes when unpacked, more than limits.chunk=50 allows" in caplog.text
    assert "20 messages are lost" in caplog.text


def test_a_bomb_is_not_unpacked(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Both the chunk and the frame in it say 2^32 bytes; nothing of that size is asked for."""
    path = written(tmp_path, use_statistics=False, index_types=IndexType.NONE)
    frame = zstandard.ZstdCompressor().compress(bytes(2**20))
    head = (0).to_bytes(8, "little") * 2 + (2**32).to_bytes(8, "little") + bytes(4)
    head += (4).to_bytes(4, "little") + b"zstd" + len(frame).to_bytes(8, "little")
    body = head + frame
    data = path.read_bytes()
    at = data.index(b"\x06", 8)  # the first chunk
    record = b"\x06" + len(body).to_bytes(8, "little") + body
    path.write_bytes(data[:at] + record + data[at:])
    assert count(path) == 20
    assert "a chunk of 4294967296 bytes when unpacked, more than limits.chunk=" in caplog.text


def test_more_channels_than_the_limit_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path)
    with limited({"channels": 1}):
        assert count(path) == 20
    path = written(tmp_path, topics=2)
    with limited({"channels": 1}), pytest.raises(DataError, match=r"more than limits\.channels=1"):
        LogFile(path)
