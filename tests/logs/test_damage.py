"""Files that are cut, corrupt, empty or something else: what is readable, and one line."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.records import Channel, Message, Schema
from mcap.writer import CompressionType, IndexType

from mcap_logs import START
from placecue.errors import DataError, PlacecueError
from placecue.logs import open_log
from placecue.logs.mcap.container import LogFile


def cut(path: str, size: int) -> Path:
    whole = Path(path)
    part = whole.with_name("cut.mcap")
    part.write_bytes(whole.read_bytes()[:size])
    return part


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", r"is empty \(0 bytes\)"),
        (b"hello world, this is text", r"is not an MCAP file \(it begins with b'hello wo'\)"),
        (b"\x89MCAP", "is not an MCAP file"),
        (b"#ROSBAG V2.0\n" + bytes(50), "a ROS 1 bag, which source=rosbag reads"),
        (b"SQLite format 3\0" + bytes(50), "a ROS 2 sqlite3 bag, which source=rosbag reads"),
    ],
)
def test_not_mcap(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    with pytest.raises(DataError, match=said) as caught:
        open_log(path)
    assert str(path) in str(caught.value)


def test_missing_and_folder(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no such log: .*nothing\.mcap"):
        open_log(tmp_path / "nothing.mcap")
    with pytest.raises(DataError, match="cannot read"):
        open_log(tmp_path)


def test_cut_anywhere(small_log: str, caplog: pytest.LogCaptureFixture) -> None:
    size = Path(small_log).stat().st_size
    whole = [each.stamp for each in open_log(small_log)]
    most = 0
    for end in [*range(0, size, 37), size - 1]:
        caplog.clear()
        path = cut(small_log, end)
        try:
            found = [each.stamp for each in open_log(path)]
        except PlacecueError as error:
            assert "\n" not in str(error)  # noqa: PT017
            found = []
        else:
            said = [record.message for record in caplog.records if "cut off" in record.message]
            assert len(said) == 1
            assert f"of {end} (" in said[0]
        assert found == whole[: len(found)]
        assert len(found) >= most  # the more of the file, the more is read
        most = len(found)
    assert most == len(whole)


def test_a_cut_log_says_how_far_it_was_read(ros2: Any, caplog: pytest.LogCaptureFixture) -> None:
    log = ros2(chunk_size=1, compression=CompressionType.NONE)  # a chunk a message
    for i in range(10):
        log.scan(i * 0.5, [float(i)])
    path = log.close()
    with Path(path).open("rb") as file:
        chunk = LogFile(path).contents.chunks[6]
        assert file.seek(chunk.chunk_start_offset)
    part = cut(path, chunk.chunk_start_offset + 20)
    assert len(list(open_log(part))) == 6
    (record,) = caplog.records
    assert f"{part} is cut off or damaged: read 6 messages over 2.5 s" in record.message
    assert f"at byte {chunk.chunk_start_offset} of {part.stat().st_size}" in record.message
    assert "how many messages are lost is not known" in record.message
    assert "mcap recover" in record.message


@pytest.mark.parametrize("compression", CompressionType)
def test_a_cut_chunk_gives_its_beginning(ros2: Any, compression: CompressionType) -> None:
    log, noise = ros2(chunk_size=2**30, compression=compression), np.random.default_rng(0)
    for i in range(20):
        log.image(i * 0.1, noise.bytes(20_000))  # incompressible, so that sizes are known
    path = log.close()
    part = cut(path, Path(path).stat().st_size // 2)
    # Compressed blocks hold up to 128 KiB, which is six images and a half.
    stamps = [each.stamp - START for each in open_log(part)]
    assert 10 - 7 <= len(stamps) <= 10
    assert stamps == [i * 100_000_000 for i in range(len(stamps))]


def test_reading_goes_on_behind_damage_without_an_index(
    as_json: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json(use_chunking=False)
    for i in range(30):
        log.scan(i * 0.1, [float(i)])
    path = Path(log.close())
    data = bytearray(path.read_bytes())
    place = data.index(b'"ranges": [10.0]')
    head = data.rindex(b"\x05", 0, place - 200)  # the opcode of a message
    data[head : head + 9] = bytes(9)
    path.write_bytes(data)
    scans = [each.scan.ranges[0] for each in open_log(path) if each.scan]
    assert len(scans) == 29
    assert scans == sorted(scans)
    (record,) = caplog.records
    assert "read 29 messages over 2.9 s" in record.message
    assert "1 message is lost" in record.message  # the file's statistics still say 30
    assert "unknown kind 0x00" in record.message


def test_no_message_is_lost_where_only_the_summary_is_damaged(small_log: str) -> None:
    path = Path(small_log)
    whole = path.read_bytes()
    stamps = [each.stamp for each in open_log(path)]
    chunks = LogFile(path).contents.chunks
    end = chunks[-1].chunk_start_offset + chunks[-1].chunk_length + chunks[-1].message_index_length
    for position in range(end, len(whole) - 8, 11):
        path.write_bytes(whole[:position] + b"\xff\xff" + whole[position + 2 :])
        assert [each.stamp for each in open_log(path)] == stamps, position


def test_a_damaged_chunk_gives_what_is_left_of_it(
    small_log: str, caplog: pytest.LogCaptureFixture
) -> None:
    chunks = LogFile(small_log).contents.chunks
    assert len(chunks) > 3
    damaged = bytearray(Path(small_log).read_bytes())
    middle = chunks[1].chunk_start_offset + chunks[1].chunk_length // 2
    damaged[middle] ^= 0xFF
    Path(small_log).write_bytes(damaged)
    opened = open_log(small_log)
    found = list(opened)
    assert 10 <= len(found) < 20
    assert len(list(opened)) == len(found)
    said = [record.message for record in caplog.records if "chunks" in record.message]
    assert len(said) == 1
    assert f"1 of {len(chunks)} chunks are damaged" in said[0]
    assert f"byte {chunks[1].chunk_start_offset}" in said[0]
    assert "lost" in said[0]


def test_flipped_bytes_never_end_in_a_traceback(small_log: str) -> None:
    whole = Path(small_log).read_bytes()
    for position in range(0, len(whole), 29):
        damaged = bytearray(whole)
        damaged[position] ^= 0x55
        Path(small_log).write_bytes(damaged)
        try:
            list(open_log(small_log))
        except PlacecueError as error:
            assert "\n" not in str(error)  # noqa: PT017


@pytest.mark.parametrize(
    "options",
    [
        {"use_chunking": False},
        {"index_types": IndexType.NONE},
        {"repeat_channels": False},
        {"repeat_schemas": False},
        {"use_statistics": False},
        {"compression": CompressionType.LZ4},
        {"compression": CompressionType.NONE, "chunk_size": 100},
        {"chunk_size": 2**30},
        {
            "use_chunking": False,
            "index_types": IndexType.NONE,
            "repeat_channels": False,
            "repeat_schemas": False,
            "use_statistics": False,
            "use_summary_offsets": False,
        },
    ],
)
def test_every_way_to_write_a_file(
    as_json: Any, options: dict[str, Any], caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json(**options)
    for i in range(30):
        log.scan(i * 0.1, [float(i), 1.0])
    scans = list(open_log(log.close(), range_max=40.0))
    assert [each.scan.ranges[0] for each in scans if each.scan] == list(range(30))
    assert caplog.text == ""


def test_chunks_that_overlap_in_time_are_merged(as_json: Any) -> None:
    log = as_json(chunk_size=300)
    for i in [0, 4, 8, 1, 5, 9, 2, 6, 3, 7]:
        log.scan(i * 0.1, [float(i)])
    stamps = [each.stamp - START for each in open_log(log.close())]
    assert stamps == [i * 100_000_000 for i in range(10)]


DATA = os.environ.get("PLACECUE_DATA")


@pytest.mark.skipif(DATA is None, reason="needs PLACECUE_DATA (recorded logs)")
def test_the_conformance_files_are_read(caplog: pytest.LogCaptureFixture) -> None:
    """Messages, channels and schemas are those of the JSON; that no topic is known is said."""
    files = sorted(Path(str(DATA), "mcap_conformance").glob("*.mcap"))
    assert len(files) == 154
    for path in files:
        listed = json.loads(path.with_suffix(".json").read_text())["records"]
        expected = {
            kind: [dict(r["fields"]) for r in listed if r["type"] == kind] for kind in KINDS
        }
        log = LogFile(path)
        contents = log.contents
        found = list(log.messages(contents.channels))
        by_time = contents.chunks != []  # an indexed file is read in order of time
        messages = sorted(expected["Message"], key=lambda m: int(m["log_time"]) * by_time)
        assert [message_fields(each) for each in found] == messages, path.name
        assert [channel_fields(each) for each in contents.channels.values()] == unique(
            expected["Channel"]
        ), path.name
        assert [schema_fields(each) for each in contents.schemas.values()] == unique(
            expected["Schema"]
        ), path.name
        times = [int(message["log_time"]) for message in messages]
        assert (contents.start, contents.end) == (min(times, default=0), max(times, default=0))
        assert contents.profile == expected["Header"][0]["profile"]
        assert contents.damages == []
        for statistics in expected["Statistics"]:
            counts = {str(key): str(n) for key, n in (contents.counts or {}).items()}
            assert counts == statistics["channel_message_counts"], path.name
        with pytest.raises(DataError, match="no image and no scan"):
            open_log(path)
    assert caplog.records == []


KINDS = ("Header", "Schema", "Channel", "Message", "Statistics")


def unique(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Leave out those that the summary repeats."""
    return [each for i, each in enumerate(records) if each not in records[:i]]


def texts(data: bytes) -> list[str]:
    return [str(byte) for byte in data]


def message_fields(message: Message) -> dict[str, Any]:
    return {
        "channel_id": str(message.channel_id),
        "data": texts(message.data),
        "log_time": str(message.log_time),
        "publish_time": str(message.publish_time),
        "sequence": str(message.sequence),
    }


def channel_fields(channel: Channel) -> dict[str, Any]:
    return {
        "id": str(channel.id),
        "message_encoding": channel.message_encoding,
        "metadata": channel.metadata,
        "schema_id": str(channel.schema_id),
        "topic": channel.topic,
    }


def schema_fields(schema: Schema) -> dict[str, Any]:
    return {
        "data": texts(schema.data),
        "encoding": schema.encoding,
        "id": str(schema.id),
        "name": schema.name,
    }
