"""What a robot sent at the beginning, as a log that can be looked through."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from mcap.records import Message

from placecue.logs.mcap.container import LogFile
from placecue.logs.mcap.contents import Contents


class LiveFile(LogFile):
    """The first messages of a server: by them topics, frames and clocks are told.

    Parameters
    ----------
    name : str
        Host and port.
    contents : Contents
        The channels that the server has.
    messages : sequence of Message
        In the order in which they came.
    """

    def __init__(self, name: str, contents: Contents, messages: Sequence[Message]) -> None:
        self.path = Path(name)
        self.size = sum(len(each.data) for each in messages)
        times = [each.log_time for each in messages]
        self.contents = Contents(
            schemas=dict(contents.schemas),
            channels=dict(contents.channels),
            counts=Counter(each.channel_id for each in messages),
            start=min(times, default=0),
            end=max(times, default=0),
        )
        self._messages = list(messages)

    def messages(
        self, channels: Collection[int], since: int | None = None, until: int | None = None
    ) -> Iterator[Message]:
        """Yield the messages of some channels, in the order in which they came."""
        since, until = since or 0, 2**64 if until is None else until
        for each in self._messages:
            if each.channel_id in channels and since <= each.log_time < until:
                yield each

    def forget(self) -> None:
        """Keep no more than the first message of each channel, which says what it is."""
        seen: set[int] = set()
        kept = []
        for each in self._messages:
            if each.channel_id not in seen:
                seen.add(each.channel_id)
                kept.append(each)
        self._messages = kept

    def digest(self) -> str:
        """Return the SHA-256 of the messages, in hexadecimal."""
        found = hashlib.sha256()
        for each in self._messages:
            found.update(each.data)
        return found.hexdigest()
