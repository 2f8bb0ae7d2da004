"""Robots that send a recorded log: a server of foxglove-sdk, and one of the older protocol."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.records import Channel, Message, Schema

foxglove = pytest.importorskip("foxglove", reason="needs foxglove-sdk (placecue[live])")
pytest.importorskip("websockets", reason="needs websockets (placecue[live])")

Recorded = tuple[Schema | None, Channel, Message]


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

    def wait(self, seconds: float = 20.0) -> None:
        """Wait until somebody listens to every topic, as a robot need not."""
        until = time.monotonic() + seconds
        while not all(each.has_sinks() for each in self.channels.values()):
            assert time.monotonic() < until, "nobody subscribes"
            time.sleep(0.005)

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
        assert self.subscribed.wait(20.0)
        for _, channel, message in self.log:
            head = struct.pack("<BIQ", 1, self._ids[channel.id], message.log_time)
            self._connections[-1].send(head + message.data)

    def vanish(self) -> None:
        self.server.shutdown()
        for connection in self._connections:
            connection.close()
