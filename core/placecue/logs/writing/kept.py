"""What a log holds besides the observations: it can be copied beside them, byte for byte."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from heapq import merge

from mcap.records import Channel, Message

from placecue.logs.mcap.container import Topic
from placecue.logs.reader import McapLog
from placecue.logs.writing.attachments import attachments_of
from placecue.logs.writing.output import Output, profile_of

#: Topics that observations are written to; others of these names go below :data:`ASIDE`.
TAKEN = frozenset((
    "/camera/image/compressed", "/camera/camera_info", "/scan", "/odom", "/tf", "/tf_static",
    "/label", "/camera/calibration", "/pose",
))  # fmt: skip
ASIDE = "/source"


class Kept:
    """The topics of logs that make no observation, copied in step with those that do.

    Parameters
    ----------
    logs : sequence of McapLog
        What is being converted.
    """

    def __init__(self, logs: Sequence[McapLog]) -> None:
        self.logs = logs
        self._channels = [_channels(each) for each in logs]
        self._waiting: Iterator[tuple[int, int, Message]] = iter(())
        self._next: tuple[int, int, Message] | None = None
        self.count = 0

    def profile(self, written: str) -> str:
        """Return the profile of a file that holds this too, where ``written`` is its own."""
        channels = [channel for each in self._channels for channel in each.values()]
        return written if not channels or profile_of(channels) == written else ""

    def begin(self, output: Output) -> None:
        """Copy metadata and attachments, and be ready for messages."""
        self._output = output
        for each in self.logs:
            for name, values in each.file.contents.metadata.items():
                if name != "placecue":
                    output.metadata(name, values)
            for attachment in attachments_of(each.file):
                output.attach(attachment)
        self._waiting = merge(*(self._messages(n) for n in range(len(self.logs))))
        self._next = next(self._waiting, None)

    def until(self, stamp: int | None) -> None:
        """Copy the messages that were recorded up to a time, ns; None for the rest."""
        while self._next is not None and (stamp is None or self._next[0] <= stamp):
            _, number, message = self._next
            schemas = self.logs[number].file.contents.schemas
            self._output.copy(message, self._channels[number], schemas)
            self.count += 1
            self._next = next(self._waiting, None)

    def _messages(self, number: int) -> Iterator[tuple[int, int, Message]]:
        for message in self.logs[number].file.messages(self._channels[number]):
            yield message.log_time, number, message


def left_out(log: McapLog) -> list[Topic]:
    """Return the topics of a log that make no part of its observations."""
    used = {topic.name for choice in log.choices.values() for topic in choice.topics}
    return [topic for topic in log.topics if topic.name not in used and topic.count != 0]


def _channels(log: McapLog) -> dict[int, Channel]:
    known = log.file.contents.channels
    return {
        number: replace(known[number], topic=_aside(topic.name))
        for topic in left_out(log)
        for number in topic.channels
    }


def _aside(topic: str) -> str:
    return f"{ASIDE}{topic}" if topic in TAKEN else topic
