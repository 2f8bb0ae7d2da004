"""Bags that are cut or damaged: what is readable is read, and it is said once."""

from __future__ import annotations

import bz2
import logging
import random
import sqlite3
import struct
from pathlib import Path

import pytest
from rosbags import rosbag1
from rosbags.interfaces import (
    Connection,
    ConnectionExtRosbag2,
    MessageDefinition,
    MessageDefinitionFormat,
)

from bags import drive
from placecue.errors import DataError, PlacecueError
from placecue.limits import limited
from placecue.logs import recognise
from placecue.logs.bags.bag import BagFile
from placecue.logs.bags.bag_cut import unpacked
from placecue.logs.bags.bag_definitions import Definitions
from placecue.logs.rosbag import RosbagLog
from placecue.recognition import Found, look


def held(path: str | Path) -> list[tuple[str, int, bytes]]:
    """Return topic, log time and bytes of every message."""
    file = BagFile(path)
    names = {number: channel.topic for number, channel in file.contents.channels.items()}
    return [(names[m.channel_id], m.log_time, m.data) for m in file.messages(set(names))]


def outcome(path: Path) -> PlacecueError | None:
    """Read all observations of a bag; return the error that placecue raises, if it does."""
    try:
        assert len(list(RosbagLog(str(path)))) < 100
    except PlacecueError as error:
        return error
    return None


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a ROS 1 bag in several chunks, in order of time."""
    made = drive(1, images=False)
    made.entries.sort(key=lambda entry: entry[2])
    return Path(made.as_ros1(tmp_path_factory.mktemp("bag") / "run.bag", chunk=1500))


@pytest.mark.parametrize("share", [0.35, 0.5, 0.61, 0.83, 0.9, 0.99])
def test_a_cut_bag_gives_every_message_before_the_cut(
    plain: Path, share: float, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    whole = plain.read_bytes()
    cut = tmp_path / "cut.bag"
    cut.write_bytes(whole[: 4096 + int(share * (len(whole) - 4096))])
    every = held(plain)
    # A message is there if its log time and its bytes are: in a record they stand side by side.
    places = [cut.read_bytes().find(data) for _, _, data in every]
    before = [each for each, place in zip(every, places, strict=True) if place >= 0]
    with caplog.at_level(logging.WARNING):
        found = held(cut)
    assert found == every[: len(found)]
    assert len(found) >= len(before) > 0
    (record,) = caplog.records
    assert f"read {len(found)} messages over" in record.message
    assert "'rosbag reindex' makes a whole bag of it" in record.message
    observations = list(RosbagLog(str(cut)))
    assert len(observations) == sum(topic == "/scan" for topic, _, _ in found)


def test_the_place_of_the_damage_is_said(
    plain: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with rosbag1.Reader(plain) as reader:
        last = reader.chunk_infos[-1].pos
    (tmp_path / "cut.bag").write_bytes(plain.read_bytes()[: last + 60])
    held(tmp_path / "cut.bag")
    assert f"up to byte {last} of {last + 60}" in caplog.text


@pytest.mark.parametrize("compression", ["BZ2", "LZ4"])
def test_a_cut_bag_in_compressed_chunks(compression: str, tmp_path: Path) -> None:
    made = drive(1, images=False)
    made.entries.sort(key=lambda entry: entry[2])
    path = Path(made.as_ros1(tmp_path / "run.bag", compression, chunk=1500))
    whole, every = path.read_bytes(), held(path)
    counts = []
    for size in range(4500, len(whole), 700):
        path.write_bytes(whole[:size])
        try:
            found = held(path)
        except DataError:
            found = []
        assert found == every[: len(found)]
        counts.append(len(found))
    assert counts == sorted(counts)
    assert counts[-1] == len(every)  # the index is cut, the messages are not
    assert len(set(counts)) > 4


def test_a_bag_that_was_never_closed(plain: Path, tmp_path: Path) -> None:
    """The recorder writes the place of the index last; until then it is 0."""
    whole = bytearray(plain.read_bytes())
    place = whole.index(b"index_pos=") + len(b"index_pos=")
    (index,) = struct.unpack_from("<Q", whole, place)
    whole[place : place + 8] = bytes(8)
    active = tmp_path / "run.bag.active"
    active.write_bytes(whole[:index])
    assert held(active) == held(plain)


def test_a_bag_cut_before_its_first_message(plain: Path, tmp_path: Path) -> None:
    (tmp_path / "cut.bag").write_bytes(plain.read_bytes()[:4200])
    with pytest.raises(DataError, match=r"cut.bag cannot be read as a bag: ") as raised:
        held(tmp_path / "cut.bag")
    assert "\n" not in str(raised.value)


def test_a_damaged_chunk_of_a_whole_bag(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    made = drive(1, images=False)
    made.entries.sort(key=lambda entry: entry[2])
    path = Path(made.as_ros1(tmp_path / "run.bag", "BZ2", chunk=1500))
    every = held(path)
    content = bytearray(path.read_bytes())
    chunks = [i for i in range(len(content)) if content.startswith(b"BZh", i)]
    content[chunks[2] + 60] ^= 255
    path.write_bytes(content)
    found = held(path)
    assert 0 < len(found) < len(every)
    # Behind the damaged chunk it goes on.
    left = iter(every)
    assert all(each in left for each in found)
    assert found[-1] == every[-1]
    (record,) = caplog.records
    assert "is damaged: 1 chunks cannot be read to their end" in record.message
    assert f"{len(every) - len(found)} messages are lost" in record.message
    assert len(list(RosbagLog(str(path)))) > 0


@pytest.mark.parametrize(("folder", "odd"), [(False, 0), (True, 2500)])
def test_a_cut_sqlite_bag_gives_what_stands_before_the_cut(
    folder: bool, odd: int, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    made = drive(2, steps=60)
    if folder:
        bag = Path(made.as_ros2(tmp_path / "run"))
        (path,) = bag.glob("*.db3")
    else:
        path = bag = Path(made.as_bare_sqlite(tmp_path / "run_0.db3"))
    every = held(bag)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2 // 4096 * 4096 + odd])
    found = held(bag)
    assert len(set(found)) == len(found)
    assert set(found) <= set(every)
    assert len(every) / 3 < len(found) < len(every)
    assert "is cut off or damaged" in caplog.text
    assert f"read {len(found)} messages" in caplog.text


@pytest.mark.parametrize("metadata", [True, False])
def test_a_cut_mcap_in_the_folder_of_a_bag(
    metadata: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = Path(drive(2, steps=60).as_ros2(tmp_path / "run", storage="MCAP"))
    every = held(folder)
    (path,) = folder.glob("*.mcap")
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    if not metadata:  # as a recorder that was killed leaves it
        (folder / "metadata.yaml").unlink()
    found = held(folder)
    assert found
    assert set(found) < set(every)
    assert "is cut off or damaged" in caplog.text
    assert RosbagLog(str(folder)).file.topics()
    assert recognise.rosbag(look(folder)) == Found.BY_CONTENT


def test_a_hole_in_a_sqlite_bag_takes_no_more_than_lay_there(tmp_path: Path) -> None:
    path = Path(drive(2, steps=60).as_bare_sqlite(tmp_path / "run_0.db3"))
    every, data = held(path), bytearray(path.read_bytes())
    middle = len(data) // 2 // 4096 * 4096
    data[middle : middle + 4096] = bytes(4096)
    path.write_bytes(data)
    found = held(path)
    assert set(found) < set(every)
    assert len(found) > 0.8 * len(every)
    assert found[-1] == every[-1]


def test_a_sqlite_bag_cut_before_its_first_message(tmp_path: Path) -> None:
    path = Path(drive(2, steps=60).as_bare_sqlite(tmp_path / "run_0.db3"))
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(DataError, match=r"cannot be read as a bag: .*disk image is malformed"):
        held(path)


def test_a_bag_of_unknown_messages_says_so(tmp_path: Path) -> None:
    path = Path(drive(2, images=False).as_bare_sqlite(tmp_path / "run_0.db3"))
    with sqlite3.connect(path) as base:
        base.execute("UPDATE topics SET type = 'my_msgs/msg/Scan' WHERE name = '/scan'")
    base.close()
    with pytest.raises(DataError, match=r"holds no image and no scan .*my_msgs/msg/Scan, 12 mess"):
        list(RosbagLog(str(path)))


def test_definitions_in_idl() -> None:
    rule = "=" * 80 + "\n"
    one = "module my_msgs { module msg { struct Named { string name; uint8 kind; }; }; };\n"
    two = (
        "module my_msgs { module msg { struct Pair { my_msgs::msg::Named first; "
        "sequence<double> values; }; }; };\n"
    )
    for text in (
        f"{rule}IDL: my_msgs/msg/Pair\n{two}{rule}IDL: my_msgs/msg/Named\n{one}",
        one + two,
    ):
        name, language, found = Definitions("humble").of(
            Connection(
                1,
                "/pair",
                "my_msgs/msg/Pair",
                MessageDefinition(MessageDefinitionFormat.IDL, text),
                "",
                0,
                ConnectionExtRosbag2("cdr", []),
                None,
            )
        )
        assert (name, language) == ("my_msgs/msg/Pair", "ros2msg")
        assert found.split("\n")[:2] == ["my_msgs/Named first", "float64[] values"]
        assert "MSG: my_msgs/Named\nstring name\nuint8 kind" in found


@pytest.mark.parametrize("kind", ["none", "BZ2", "LZ4", "sqlite"])
def test_nothing_but_one_line_for_any_damage(
    kind: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    made = drive(2 if kind == "sqlite" else 1, steps=4)
    if kind == "sqlite":
        path = Path(made.as_bare_sqlite(tmp_path / "run_0.db3"))
    else:
        path = Path(made.as_ros1(tmp_path / "run.bag", kind.replace("none", ""), chunk=2000))
    whole, chance = path.read_bytes(), random.Random(kind)
    for _ in range(60):
        content = bytearray(whole)
        for _ in range(chance.randint(1, 3)):
            place = chance.randrange(len(content))
            what = chance.choice(("flip", "cut", "double"))
            if what == "flip":
                content[place] ^= 1 << chance.randrange(8)
            elif what == "cut":
                del content[place:]
                content = content or bytearray(b"#")
            else:
                content[place:place] = content[place : place + 300]
        path.write_bytes(content)
        caplog.clear()
        said = [] if (error := outcome(path)) is None else [str(error)]
        said += [record.getMessage() for record in caplog.records]
        assert all("\n" not in line for line in said)


@pytest.mark.parametrize("compression", ["", "LZ4"])
def test_an_index_that_misleads_loses_nothing(compression: str, tmp_path: Path) -> None:
    """Places of messages within chunks: 4 + 4 bytes of time, then 4 of the place."""
    made = drive(1, images=False)
    path = Path(made.as_ros1(tmp_path / "run.bag", compression, chunk=1500))
    every = held(path)
    content = bytearray(path.read_bytes())
    places = [i for i in range(len(content)) if content.startswith(b"op=\x04", i)]
    assert len(places) > 4
    for place in places[1:]:
        start = content.index(b"ver=\x01\0\0\0", place - 40) + 8
        content[start + 12 : start + 16] = b"\xff\xff\0\0"
    path.write_bytes(content)
    assert sorted(held(path)) == sorted(every)


def test_a_chunk_that_unpacks_to_more_than_the_limit(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    made = drive(1, images=False)
    made.entries.sort(key=lambda entry: entry[2])
    path = Path(made.as_ros1(tmp_path / "run.bag", "BZ2", chunk=1500))
    with limited({"chunk": 1400}):
        assert held(path) == []
    assert "when unpacked, more than limits.chunk=1400 allows" in caplog.text


def test_a_chunk_whose_size_lies_is_unpacked_no_further_than_the_limit(tmp_path: Path) -> None:
    fields = {b"op": b"\x05", b"compression": b"bz2", b"size": struct.pack("<I", 10)}
    with limited({"chunk": 1_000_000}):
        content, reason = unpacked(fields, bz2.compress(bytes(50_000_000)))
    assert content == b""
    assert reason is not None
    assert "more bytes when unpacked than limits.chunk=1000000 allows" in reason


def test_a_sqlite_bag_that_lacks_its_end_says_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = Path(drive(2, steps=60).as_bare_sqlite(tmp_path / "run_0.db3"))
    whole = path.stat().st_size
    path.write_bytes(path.read_bytes()[: whole - 2000])
    try:
        held(path)
    except DataError:
        return  # what was cut is needed to read anything
    assert f"is cut off: 2000 of the {whole} bytes" in caplog.text


@pytest.mark.parametrize("field", [b"conn=\x02", b"chunk_count="])
def test_an_index_that_leaves_something_out_loses_nothing(
    plain: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture, field: bytes
) -> None:
    """A connection under another number, or fewer chunks than there are."""
    every = held(plain)
    content = bytearray(plain.read_bytes())
    if field == b"chunk_count=":
        content[content.index(field) + len(field)] -= 2
    else:
        content[content.rindex(b"conn=\x02\0\0\0\x0b") + 7] = 9
    path = tmp_path / "run.bag"
    path.write_bytes(content)
    assert held(path) == every
    (record,) = caplog.records
    assert f"read {len(every)} messages over" in record.message
