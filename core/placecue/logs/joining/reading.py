"""One pass over a log, from messages to observations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from placecue.errors import UnusableObservation
from placecue.faults import Faults
from placecue.logs.joining.assemble import Assembler
from placecue.logs.joining.items import Item, TopicReader
from placecue.logs.joining.labels import Intervals
from placecue.logs.joining.silence import Silence
from placecue.logs.joining.synchronise import Match, Synchroniser
from placecue.logs.mcap.container import LogFile
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
    silence : Silence or None
        When the camera counts as silent, so that scans make the observations.

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
        *,
        silence: Silence | None = None,
    ) -> None:
        self.file = file
        self.readers = {number: reader for reader in readers for number in reader.topic.channels}
        self.since = since
        self.until = until
        self.faults = Faults(str(file.path))
        roles = {reader.role for reader in readers}
        followers: list[Part] = [p for p in ("scan", "pose") if p != driver and p in roles]
        spans = (round(seconds * 1e9) for seconds in (tolerance, window, pose_gap))
        self._synchroniser = Synchroniser(driver, followers, *spans, silence=silence)
        self._assembler = Assembler(driver, followers, intervals, self.faults)

    def observations(self) -> Iterator[Observation]:
        """Yield the observations in order of time."""
        for match in self._matches():
            observation = self._assembler.observation(match)
            if observation is not None:
                yield observation

    def trail(self) -> Iterator[Observation]:
        """Yield the observations with nothing but pose and label, decoding nothing else."""
        return map(self._assembler.place, self._matches())

    def _matches(self) -> Iterator[Match]:
        synchroniser = self._synchroniser
        for item in self._items():
            yield from synchroniser.push(item)
        yield from synchroniser.finish()
        self._tell_of_time()

    def _tell_of_time(self) -> None:
        synchroniser, drivers = self._synchroniser, f"{self._synchroniser.driver}s"
        at = {what: f"at stamp {stamp}" for what, stamp in synchroniser.first.items()}
        if synchroniser.late:
            kind = f"{drivers} came behind ones of a later time and were left out"
            self.faults.add(kind, at["late"], synchroniser.late)
        if synchroniser.jumps:
            kind = f"jumps back in the time of {drivers}, which is not in order there"
            self.faults.add(kind, at["jump"], synchroniser.jumps)
        if synchroniser.stood_in:
            kind = "observations are of scans alone, where the camera was silent"
            self.faults.add(kind, at["stood in"], synchroniser.stood_in)
        if synchroniser.repeated:
            kind = f"{drivers} have the stamp of the one before"
            self.faults.add(kind, at["repeated"], synchroniser.repeated)

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
