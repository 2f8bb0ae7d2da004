"""Sends an MCAP log as a robot would, over Foxglove's WebSocket protocol.

    python benchmarks/live_robot.py run.mcap [--speed 1] [--port 8765]

It waits until somebody listens to a topic, sends the log once, and goes on serving.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import foxglove
from mcap.reader import make_reader


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("log", type=Path)
    options.add_argument("--speed", type=float, default=1.0)
    options.add_argument("--port", type=int, default=8765)
    given = options.parse_args()
    context = foxglove.Context()
    server = foxglove.start_server(name=given.log.name, port=given.port, context=context)
    print(f"ws://127.0.0.1:{server.port}", flush=True)
    with given.log.open("rb") as file:
        reader = make_reader(file)
        channels = _channels(reader, context)
        while not any(channel.has_sinks() for channel in channels.values()):
            time.sleep(0.01)
        _send(reader, channels, given.speed)
    print("sent", flush=True)
    time.sleep(3600)


def _channels(reader, context) -> dict[int, foxglove.Channel]:
    summary = reader.get_summary()
    found = {}
    for number, channel in summary.channels.items():
        schema = summary.schemas[channel.schema_id]
        found[number] = foxglove.Channel(
            channel.topic,
            message_encoding=channel.message_encoding,
            schema=foxglove.Schema(name=schema.name, encoding=schema.encoding, data=schema.data),
            context=context,
        )
    return found


def _send(reader, channels: dict[int, foxglove.Channel], speed: float) -> None:
    begun, first = time.monotonic(), None
    for _, channel, message in reader.iter_messages():
        first = message.log_time if first is None else first
        due = begun + (message.log_time - first) * 1e-9 / speed
        time.sleep(max(due - time.monotonic(), 0.0))
        channels[channel.id].log(message.data, log_time=message.log_time)


if __name__ == "__main__":
    main()
