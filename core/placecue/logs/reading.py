"""One pass over a log, from messages to observations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from placecue.errors import UnusableObservation
from placecue.logs.assemble import Assembler
from placecue.logs.container import LogFile
from placecue.logs.faults import Faults
from placecue.logs.items import Item, TopicReader
from placecue.logs.labels import Intervals
from placecue.logs.synchronise import Match, Synchroniser
from placecue.observation import Observation, Part


class Reading:
    """One pass over a log.

    Parameters
    ----------
    file : LogFile
        The log.
    driver : {"image", "scan"}
        The part that makes an observation.
    readers : sequence of TopicReader
        Of the topics to read.
    intervals : Intervals or None
        Labels beside the log.
    tolerance, window, pose_gap : float
        See :class:`McapLog`, s.
    since, until : int or None
        First log time to read, and the one to stop before, ns.

    Attributes
    ----------
    faults : Faults
        What went wrong so far.
    """

    def __init__(
        self,
        file: LogFile,
        driver: Part,
        readers: Sequence[TopicReader],
        intervals: Intervals | None,
        tolerance: float,
        window: float,
        pose_gap: float,
        since: int | None = None,
        until: int | None = None,
    ) -> None:
        self.file = file
        self.readers = {number: reader for reader in readers for number in reader.topic.channels}
        self.window = window
        self.since = since
        self.until = until
        self.faults = Faults(str(file.path))
        roles = {reader.role for reader in readers}
        followers: list[Part] = [p for p in ("scan", "pose") if p != driver and p in roles]
        spans = (round(seconds * 1e9) for seconds in (tolerance, window, pose_gap))
        self._synchroniser = Synchroniser(driver, followers, *spans)
        self._assembler = Assembler(driver, followers, intervals, self.faults)

    def observations(self) -> Iterator[Observation]:
        """Yield the observations in order of time."""
        for match in self._matches():
            observation = self._assembler.observation(match)
            if observation is not None:
                yield observation

    def labels(self) -> Iterator[str | None]:
        """Yield the label of each observation in order of time, decoding nothing else."""
        return map(self._assembler.label, self._matches())

    def _matches(self) -> Iterator[Match]:
        synchroniser = self._synchroniser
        for item in self._items():
            yield from synchroniser.push(item)
        yield from synchroniser.finish()
        if synchroniser.late:
            kind = f"{synchroniser.driver}s came more than {self.window:g} s late and were left out"
            self.faults.add(kind, "raise source.window to keep them", synchroniser.late)

    def _items(self) -> Iterator[Item]:
        labels = [number for number, reader in self.readers.items() if reader.role == "label"]
        past = labels if self.since is not None else []  # what holds when the reading begins
        before = self.file.messages(past, until=self.since) if past else ()
        for message in chain(before, self.file.messages(self.readers, self.since, self.until)):
            try:
                item = self.readers[message.channel_id].item(message)
            except UnusableObservation as error:
                self.faults.add("messages could not be used", str(error))
                continue
            if item is not None:
                yield item
