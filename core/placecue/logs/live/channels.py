"""The channels of a server under numbers that stay, also where the server comes back."""

from __future__ import annotations

from mcap.records import Channel, Schema

from placecue.limits import current_limits
from placecue.logs.live.protocol import Advertised
from placecue.logs.mcap.contents import Contents

Key = tuple[str, str, str, str, bytes]


class Channels:
    """Gives channels numbers by what they carry: a topic, an encoding and a schema.

    Attributes
    ----------
    contents : Contents
        The channels and their schemas, as those of a log.
    """

    def __init__(self) -> None:
        self.contents = Contents()
        self._numbers: dict[Key, int] = {}
        self._most = current_limits().channels

    def number(self, channel: Advertised) -> int | None:
        """Return the number of a channel; None where there are too many of them."""
        key = (
            channel.topic,
            channel.encoding,
            channel.schema_name,
            channel.schema_encoding,
            channel.schema,
        )
        known = self._numbers.get(key)
        if known is not None or len(self._numbers) >= self._most:
            return known
        number = self._numbers[key] = len(self._numbers) + 1
        self.contents.schemas[number] = Schema(
            id=number,
            name=channel.schema_name,
            encoding=channel.schema_encoding,
            data=channel.schema,
        )
        self.contents.channels[number] = Channel(
            id=number,
            topic=channel.topic,
            message_encoding=channel.encoding,
            metadata={},
            schema_id=number,
        )
        return number
