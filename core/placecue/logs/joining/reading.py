"""One pass over a log: its messages go into a feed, and observations come out."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from mcap.records import Message

from placecue.logs.joining.feed import Feed
from placecue.logs.joining.synchronise import Match
from placecue.logs.mcap.container import LogFile
from placecue.observation import Observation

#: So long before the part that is read, transforms are read too, ns.
BEFORE = 5_000_000_000


class Reading:
    """One pass over a log.

    Parameters
    ----------
    file : LogFile
        The log.
    feed : Feed
        Takes its messages.
    since, until : int or None
        First log time to read, and the one to stop before, ns.
    """

    def __init__(
        self, file: LogFile, feed: Feed, since: int | None = None, until: int | None = None
    ) -> None:
        self.file = file
        self.feed = feed
        self.since = since
        self.until = until

    def observations(self) -> Iterator[Observation]:
        """Yield the observations in order of time."""
        for match in self._matches():
            observation = self.feed.observation(match)
            if observation is not None:
                yield observation

    def trail(self) -> Iterator[Observation]:
        """Yield the observations with nothing but pose and label, decoding nothing else."""
        return map(self.feed.place, self._matches())

    def _matches(self) -> Iterator[Match]:
        messages = self.file.messages(self.feed.readers, self.since, self.until)
        for message in chain(self._past(), messages):
            yield from self.feed.push(message)
        yield from self.feed.finish()

    def _past(self) -> Iterator[Message]:
        """Yield what holds when the reading begins: labels, and the transforms just before."""
        if self.since is None:
            return
        readers = self.feed.readers
        lasting = [number for number, reader in readers.items() if reader.lasts]
        moved = [n for n, r in readers.items() if r.role == "transform" and not r.lasts]
        if lasting:
            yield from self.file.messages(lasting, until=self.since)
        if moved:
            yield from self.file.messages(moved, max(self.since - BEFORE, 0), self.since)
