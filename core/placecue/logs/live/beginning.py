"""The first messages of a robot: enough of them to choose topics by."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from mcap.records import Message

from placecue.logs.adapters.lookup import adapter_for
from placecue.logs.joining.depth import CALIBRATION, CAMERA_INFO
from placecue.logs.live.inbox import Arrived
from placecue.logs.mcap.contents import Contents

#: What observations are made of.
MAKERS = ("image", "scan")


class Beginning:
    """Gathers messages until they show for some time what observations are made of.

    Parameters
    ----------
    contents : Contents
        The channels that the messages are of; they may grow.
    seconds : float
        So long images or scans have to come, by the clock here or by the messages' own times.
    most : int
        Bytes that are enough in any case.

    Attributes
    ----------
    messages : list of Message
        In the order in which they came.
    """

    def __init__(self, contents: Contents, seconds: float, most: int) -> None:
        self.contents = contents
        self.seconds = seconds
        self.most = most
        self.messages: list[Message] = []
        self._size = 0
        self._arrived = (inf, -inf)  # the first and last image or scan, s
        self._sent = (inf, -inf)

    def add(self, arrived: Sequence[Arrived]) -> None:
        """Take in messages."""
        for at, message in arrived:
            self.messages.append(message)
            self._size += len(message.data)
            if self.role(message.channel_id) in MAKERS:
                self._arrived = _widened(self._arrived, at)
                self._sent = _widened(self._sent, message.log_time * 1e-9)

    @property
    def shows_something(self) -> bool:
        """Whether there is an image or a scan."""
        return self._arrived[0] < inf

    @property
    def enough(self) -> bool:
        """Whether topics can be chosen."""
        spans = (last - first for first, last in (self._arrived, self._sent))
        return self._size > self.most or (self.shows_something and max(spans) >= self.seconds)

    def role(self, number: int) -> str | None:
        """Return what the messages of a channel can give, or None."""
        schema = self.contents.schemas[number].name
        if schema.replace("/msg/", "/") in (CAMERA_INFO, CALIBRATION):
            return "camera"
        adapter = adapter_for(self.contents.channels[number].message_encoding, schema)
        return None if adapter is None else adapter.role


def _widened(span: tuple[float, float], by: float) -> tuple[float, float]:
    return min(span[0], by), max(span[1], by)
