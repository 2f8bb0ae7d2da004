"""Frames of the Foxglove WebSocket protocol, as its specification has them; and ones that are not.

The examples are written down from https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md.
"""

from __future__ import annotations

import base64
import json
import os
import random
import struct
from typing import Any

import pytest
from mcap.records import Message

from placecue.limits import limited
from placecue.logs.live.channels import Channels
from placecue.logs.live.inbox import Inbox
from placecue.logs.live.newest import Newest
from placecue.logs.live.protocol import (
    Advertised,
    Advertisement,
    BadFrame,
    Data,
    Status,
    Withdrawal,
    read,
)
from placecue.logs.live.rate import Rate
from placecue.logs.live.session import Session

#: Of the spoilt frames that were tried when this was written there were 10,000.
SPOILT = int(os.environ.get("PLACECUE_SPOILT_FRAMES", "2000"))
CHANNEL: dict[str, Any] = {
    "id": 3,
    "topic": "/scan",
    "encoding": "cdr",
    "schemaName": "sensor_msgs/msg/LaserScan",
    "schema": "float32 angle_min",
}


def advertised(**changed: Any) -> str:
    return json.dumps({"op": "advertise", "channels": [{**CHANNEL, **changed}]})


def message(subscription: int, data: bytes = b"abc", time: int = 5) -> bytes:
    return b"\x01" + struct.pack("<I", subscription) + struct.pack("<Q", time) + data


def test_what_a_server_says() -> None:
    known = Advertised(
        3, "/scan", "cdr", "sensor_msgs/msg/LaserScan", "ros2msg", b"float32 angle_min"
    )
    assert read(advertised()) == Advertisement((known,))
    assert read('{"op": "unadvertise", "channelIds": [3, 4]}') == Withdrawal((3, 4))
    assert read('{"op": "status", "level": 2, "message": "no"}') == Status(2, "no")
    assert read(message(7)) == Data(7, 5, b"abc")
    for other in ('{"op": "serverInfo", "name": "x"}', b"\x02" + bytes(8)):
        assert read(other) is None


def test_schemas_of_protobuf_come_in_base64() -> None:
    schema = base64.b64encode(b"\x00\xffbinary").decode()
    event = read(advertised(encoding="protobuf", schema=schema, schemaEncoding="protobuf"))
    assert isinstance(event, Advertisement)
    assert event.channels[0].schema == b"\x00\xffbinary"


@pytest.mark.parametrize(
    "frame",
    [
        *(b"", b"\x01", message(1)[:12], message(1, time=2**63)),
        *("", "nonsense", "[]", "{}", '{"op": 3}', '{"op": "advertise"}', "[" * 10_000),
        *('{"op": "advertise", "channels": [3]}', '{"op": "unadvertise", "channelIds": ["3"]}'),
        *(advertised(id=-1), advertised(id=True), advertised(id=2**64), advertised(topic=4)),
        advertised(encoding="protobuf", schema="no base64!"),
    ],
)
def test_what_makes_no_sense_is_refused(frame: str | bytes) -> None:
    with pytest.raises(BadFrame):
        read(frame)


class Server:
    """Takes what is sent."""

    def __init__(self) -> None:
        self.asked: list[Any] = []
        self.unwanted: set[int] = set()
        self.session = Session(Channels(), lambda number: number not in self.unwanted, self.receive)

    def receive(self, frame: str) -> None:
        self.asked.append(json.loads(frame))


def subscribe(*pairs: tuple[int, int]) -> dict[str, Any]:
    return {"op": "subscribe", "subscriptions": [{"id": i, "channelId": c} for i, c in pairs]}


def test_a_session() -> None:
    server = Server()
    take = server.session.take
    assert take(advertised()) is None
    assert server.asked == [subscribe((1, 3))]
    got = take(message(1))
    assert got is not None
    assert (got.channel_id, got.log_time, got.data) == (1, 5, b"abc")
    take(advertised(id=9, topic="/other"))
    assert server.asked[1:] == [subscribe((2, 9))]
    with pytest.raises(BadFrame, match="subscription 3"):
        take(message(3))
    server.unwanted = {2}
    server.session.ask_again()
    assert server.asked[2:] == [{"op": "unsubscribe", "subscriptionIds": [2]}]
    assert take(message(2)) is None  # it was under way
    take('{"op": "unadvertise", "channelIds": [3]}')
    take(advertised(id=30))  # the same under another number
    assert server.asked[3:] == [subscribe((3, 30))]
    again = take(message(3))
    assert again is not None
    assert again.channel_id == 1


def test_too_many_channels_are_left_alone() -> None:
    with limited({"channels": 2}):
        server = Server()
    for number in range(4):
        server.session.take(advertised(id=number, topic=f"/{number}"))
    assert server.asked == [subscribe((1, 0)), subscribe((2, 1))]


def spoilt(frame: str | bytes, chance: random.Random) -> str | bytes:
    """A frame with bytes changed, left out or put in; a text stays one."""
    data = bytearray(frame.encode() if isinstance(frame, str) else frame)
    for _ in range(chance.randint(1, 8)):
        at = chance.randrange(len(data) + 1)
        what = chance.randrange(4)
        if what == 0:
            data[at:at] = chance.randbytes(chance.randint(1, 5))
        elif what == 1:
            del data[at : at + chance.randint(1, 20)]
        elif what == 2 and at < len(data):
            data[at] = chance.randrange(256)
        else:
            data[at:at] = chance.choice([b"[", b"{", b'"', b"null", b"1e999", b"-1", b'"id":7,'])
    return data.decode("utf-8", "replace") if isinstance(frame, str) else bytes(data)


def test_spoilt_frames_are_survived() -> None:
    """Nothing but BadFrame comes of them, and a good frame is understood after all of them."""
    chance, server = random.Random(14), Server()
    server.session.take(advertised())
    good: list[str | bytes] = [
        *(advertised(), advertised(id=4, topic="/b"), message(1), message(2, bytes(99))),
        *('{"op": "unadvertise", "channelIds": [4]}', '{"op": "status", "level": 1}'),
    ]
    refused = 0
    for _ in range(SPOILT):
        frame = chance.randbytes(chance.randint(0, 40))
        if chance.random() < 0.9:
            frame = spoilt(chance.choice(good), chance)
        try:
            server.session.take(frame)
        except BadFrame:
            refused += 1
    assert SPOILT // 4 < refused < SPOILT
    last = server.session.channels.number
    server.session.take(advertised(id=77, topic="/after"))
    assert server.asked[-1]["subscriptions"][0]["channelId"] == 77
    assert last is not None


def sent(channel: int, size: int = 10) -> Message:
    return Message(channel, 0, bytes(size), 0, sequence=0)


def test_an_inbox_drops_the_oldest_of_what_takes_most() -> None:
    inbox = Inbox(100, clock=iter(range(100)).__next__)
    for channel, size in ((1, 40), (2, 5), (1, 41), (2, 5), (1, 42)):
        inbox.put(sent(channel, size))
    kept = [(at, message.channel_id, len(message.data)) for at, message in inbox.take(0)]
    assert kept == [(1, 2, 5), (2, 1, 41), (3, 2, 5), (4, 1, 42)]
    assert inbox.dropped == 1
    assert inbox.take(0) == []
    inbox.put(sent(1, 1000))  # alone it may be as large as it is
    assert len(inbox.take(0)) == 1
    inbox.close()
    assert inbox.take() == []


def test_the_newest_alone_where_the_oldest_waited_too_long() -> None:
    now = [0.0]
    newest: Newest[str] = Newest(0.5, clock=lambda: now[0])
    for at, item in ((0.0, "a"), (0.1, "b"), (0.2, "c"), (0.3, "d")):
        newest.add(at, item)
    now[0] = 0.45
    assert newest.next() == "a"
    now[0] = 0.65  # b has waited 0.55
    assert newest.next() == "d"
    assert (newest.dropped, len(newest)) == (2, 0)
    newest.add(0.0, "late, but there is nothing newer")
    assert newest.next().startswith("late")
    assert newest.dropped == 2


def test_patience_without_end_drops_nothing() -> None:
    newest: Newest[int] = Newest(None, clock=lambda: 1e9)
    for item in range(3):
        newest.add(0.0, item)
    assert [newest.next() for _ in range(3)] == [0, 1, 2]
    assert newest.dropped == 0


def test_a_rate() -> None:
    now = [0.0]
    rate = Rate(10, clock=lambda: now[0])
    assert [rate.allows() for _ in range(12)] == [True] * 10 + [False] * 2
    now[0] = 0.25
    assert [rate.allows() for _ in range(3)] == [True, True, False]
