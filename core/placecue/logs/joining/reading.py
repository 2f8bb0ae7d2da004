"""One pass over a log, from messages to observations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from mcap.records import Message

from placecue.errors import UnusableObservation
from placecue.faults import Faults
from placecue.logs.joining.assemble import Assembler
from placecue.logs.joining.frames import TransformReader
from placecue.logs.joining.items import Item, TopicReader
from placecue.logs.joining.labels import Intervals
from placecue.logs.joining.poses import Motion
from placecue.logs.joining.silence import Silence
from placecue.logs.joining.synchronise import Match, Synchroniser
from placecue.logs.mcap.container import LogFile
from placecue.observation import Observation, Part

#: So long before the part that is read, transforms are read too, ns.
BEFORE = 5_000_000_000


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
    motion : Motion, optional
        Takes transforms, where something that is needed moves.
    recorded : bool
        Whether the intervals are on the recorder's clock.
    faults : Faults, optional
        Takes what goes wrong.

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
        motion: Motion | None = None,
        recorded: bool = False,
        faults: Faults | None = None,
    ) -> None:
        self.motion = motion
        self.file = file
        self.readers = {number: reader for reader in readers for number in reader.topic.channels}
        self.since = since
        self.until = until
        self.faults = Faults(str(file.path)) if faults is None else faults
        roles = {reader.role for reader in readers}
        followers: list[Part] = [p for p in ("scan", "pose") if p != driver and p in roles]
        spans = (round(seconds * 1e9) for seconds in (tolerance, window, pose_gap))
        parts: list[Part] = [*followers, "pose"] if motion and motion.from_transforms else followers
        self.recorded = recorded
        assembler = Assembler(driver, parts, intervals, self.faults, motion, recorded)
        self._assembler = assembler
        moving = motion if any(reader.role == "transform" for reader in readers) else None
        self._moving = moving
        self._synchroniser = Synchroniser(
            driver, followers, *spans, silence=silence, usable=assembler.usable, motion=moving
        )

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
        self._tell_of_transforms()

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

    def _tell_of_transforms(self) -> None:
        for reader in dict.fromkeys(self.readers.values()):
            if reader.unstamped:
                kind = "messages have no stamp and go by their log time"
                self.faults.add(kind, f"of {reader.topic.name}", reader.unstamped)
        if self._moving is not None:
            self.faults.join(self._moving.buffer.faults)

    def _past(self) -> Iterator[Message]:
        """Yield what holds when the reading begins: labels, and the transforms just before."""
        if self.since is None:
            return
        lasting = [number for number, reader in self.readers.items() if reader.lasts]
        moved = [n for n, r in self.readers.items() if r.role == "transform" and not r.lasts]
        if lasting:
            yield from self.file.messages(lasting, until=self.since)
        if moved:
            yield from self.file.messages(moved, max(self.since - BEFORE, 0), self.since)

    def _items(self) -> Iterator[Item]:
        messages = self.file.messages(self.readers, self.since, self.until)
        for message in chain(self._past(), messages):
            reader = self.readers[message.channel_id]
            try:
                if isinstance(reader, TransformReader) and self.motion is not None:
                    reader.take_in(message, self.motion.buffer)
                    continue
                item = reader.item(message)
            except UnusableObservation as error:
                self.faults.add("messages could not be used", str(error))
                continue
            if item is not None:
                yield item
