"""Robots that send a recorded log: a server of foxglove-sdk, and one of the older protocol."""

from __future__ import annotations

import json
import os
import signal
import socket
import struct
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.records import Channel, Message, Schema

from command_line import placecue
from placecue import Observation
from placecue.logs.live.log import LiveLog

foxglove = pytest.importorskip("foxglove", reason="needs foxglove-sdk (placecue[live])")
pytest.importorskip("websockets", reason="needs websockets (placecue[live])")

Recorded = tuple[Schema | None, Channel, Message]
#: What live serves.
SERVED = ("/placecue/belief", "/placecue/area", "/placecue/map")
#: What a log of McapWriter is read from.
READ = ("/camera/image/compressed", "/scan", "/odom", "/label")


def wait_for(what: Callable[[], object], seconds: float = 60.0) -> None:
    """Wait until something is so; a machine may be busy, but not that busy."""
    until = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.005)


def recorded(path: Path) -> list[Recorded]:
    """The messages of a log, in order of log time."""
    with path.open("rb") as file:
        return list(make_reader(file).iter_messages())


class Robot:
    """Serves topics of a log with foxglove-sdk, and sends their messages when told to."""

    def __init__(self, log: Sequence[Recorded], port: int = 0) -> None:
        self.log = log
        context = self.context = foxglove.Context()
        self.server = foxglove.start_server(
            name="robot", host="127.0.0.1", port=port, context=context, message_backlog_size=100_000
        )
        self.port = self.server.port
        self.url = f"ws://127.0.0.1:{self.port}"
        self.channels: dict[int, Any] = {}
        for schema, channel, _ in log:
            if channel.id not in self.channels:
                self.channels[channel.id] = foxglove.Channel(
                    channel.topic,
                    message_encoding=channel.message_encoding,
                    schema=schema and foxglove.Schema(
                        name=schema.name, encoding=schema.encoding, data=schema.data
                    ),
                    context=context,
                )  # fmt: skip

    def wait(self, *topics: str) -> None:
        """Wait until somebody listens to some topics, or to all, as a robot need not."""
        some = [each for each in self.channels.values() if not topics or each.topic() in topics]
        wait_for(lambda: all(each.has_sinks() for each in some))

    def drive(self, speed: float = 0.0, part: slice = slice(None)) -> None:
        """Send a part of the log, so many times as fast as it was recorded; 0: at once."""
        some = self.log[part]
        begun, first = time.monotonic(), some[0][2].log_time
        for _, channel, message in some:
            if speed:
                due = begun + (message.log_time - first) * 1e-9 / speed
                time.sleep(max(due - time.monotonic(), 0.0))
            self.channels[channel.id].log(message.data, log_time=message.log_time)

    def vanish(self) -> None:
        for channel in self.channels.values():
            channel.close()
        self.server.stop()


@contextmanager
def robot(log: Sequence[Recorded], port: int = 0) -> Iterator[Robot]:
    found = Robot(log, port)
    try:
        yield found
    finally:
        with suppress(Exception):
            found.vanish()


class OldRobot:
    """Speaks foxglove.websocket.v1, as foxglove_bridge did: a server of websockets."""

    def __init__(self, log: Sequence[Recorded]) -> None:
        from websockets.sync.server import serve

        self.log = log
        self.subscribed = Event()
        self.asked: list[Any] = []
        self._ids: dict[int, int] = {}
        self._connections: list[Any] = []
        self.server = serve(
            self._talk, "127.0.0.1", 0, subprotocols=["foxglove.websocket.v1"], compression=None
        )
        self.url = f"ws://127.0.0.1:{self.server.socket.getsockname()[1]}"
        self._thread = Thread(target=self.server.serve_forever, daemon=True)
        self._thread.start()

    def _talk(self, connection: Any) -> None:
        self._connections.append(connection)
        connection.send(json.dumps({"op": "serverInfo", "name": "old", "capabilities": []}))
        kinds = {channel.id: (schema, channel) for schema, channel, _ in self.log}
        told = [
            {
                "id": 100 + number,
                "topic": channel.topic,
                "encoding": channel.message_encoding,
                "schemaName": schema.name,
                "schema": schema.data.decode(),
            }
            for number, (schema, channel) in kinds.items()
        ]
        connection.send(json.dumps({"op": "advertise", "channels": told}))
        for frame in connection:
            asked = json.loads(frame)
            self.asked.append(asked)
            for each in asked.get("subscriptions", ()):
                self._ids[each["channelId"] - 100] = each["id"]
            if len(self._ids) == len(kinds):
                self.subscribed.set()

    def drive(self) -> None:
        assert self.subscribed.wait(60.0)
        for _, channel, message in self.log:
            head = struct.pack("<BIQ", 1, self._ids[channel.id], message.log_time)
            self._connections[-1].send(head + message.data)

    def vanish(self) -> None:
        self.server.shutdown()
        for connection in self._connections:
            connection.close()


class Follower:
    """Takes the observations of a live log in a thread of its own; a context manager."""

    def __init__(self, live: LiveLog) -> None:
        self.live = live
        self.came: Counter[str] = Counter()  # messages by topic
        self.observations: list[Observation] = []
        self.error: Exception | None = None
        self._put = live.inbox.put
        live.inbox.put = self._count  # type: ignore[method-assign]
        self._thread = Thread(target=self._run, daemon=True)

    def _count(self, message: Message) -> None:
        self._put(message)
        self.came[self.live.channels.contents.channels[message.channel_id].topic] += 1

    def _run(self) -> None:
        try:
            for observation in self.live:
                self.observations.append(observation)
        except Exception as error:
            self.error = error

    def wait(self, log: Sequence[Recorded]) -> None:
        """Wait until all messages of a log have come that are read of it."""
        sent = Counter(channel.topic for _, channel, _ in log)
        wait_for(lambda: all(self.came[topic] >= sent[topic] for topic in READ))

    def __enter__(self) -> Follower:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.live.stop()
        self._thread.join(60.0)
        if self.error is not None:
            raise self.error


def heard(url: str, *topics: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """What a server says of some topics in JSON, as any client would hear it.

    It is waited for, and nothing comes first, so that it is known to be there.
    """
    with _connected(url) as connection:
        ids: dict[int, str] = {}
        while set(ids.values()) != set(topics):
            told = json.loads(connection.recv(60.0))
            for channel in told.get("channels", ()):
                if channel["topic"] in topics:
                    ids[channel["id"]] = channel["topic"]
        asked = [{"id": number, "channelId": number} for number in ids]
        connection.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
        yield "", {}
        while True:
            frame = connection.recv(60.0)
            if isinstance(frame, bytes) and frame[0] == 1:
                _, number, _ = struct.unpack_from("<BIQ", frame)
                yield ids[number], json.loads(frame[13:])


def followed_live(
    sends: Robot, topics: Sequence[str], beliefs: int, *words: str
) -> tuple[Any, dict[str, list[dict[str, Any]]]]:
    """Run ``placecue live`` while a robot sends its log; Ctrl-C after so many beliefs.

    Returns what the command answered, and what it served by topic: beliefs, areas and maps.
    """
    port, served = free_port(), dict[str, list[dict[str, Any]]]()
    hearing = heard(f"ws://127.0.0.1:{port}", *SERVED)

    def look_on() -> None:
        try:
            next(hearing)  # the command has begun
            sends.wait(*topics)
            sends.drive()
            for topic, message in hearing:
                served.setdefault(topic, []).append(message)
                if len(served.get(SERVED[0], ())) == beliefs:
                    return
        finally:
            os.kill(os.getpid(), signal.SIGINT)

    looking = Thread(target=look_on, daemon=True)
    looking.start()
    told = placecue(
        *("live", sends.url, f"port={port}", "source.patience=null", "source.beginning=0.2"),
        *words,
    )
    looking.join(60)
    return told, served


def _connected(url: str) -> Any:
    from websockets.sync.client import connect

    found: list[Any] = []

    def tried() -> bool:
        with suppress(OSError):
            found.append(connect(url, subprotocols=["foxglove.sdk.v1"], proxy=None, max_size=None))
        return bool(found)

    wait_for(tried)
    return found[0]


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
        return port
