"""From messages to observations, one message at a time: a log's from a file, or a robot's."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

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
from placecue.observation import Observation, Part


class Feed:
    """Takes messages in the order in which they come, and gives observations.

    Parameters
    ----------
    driver : {"image", "scan"}
        The part that makes an observation.
    readers : sequence of TopicReader
        Of the topics to read.
    intervals : Intervals or None
        Labels beside the log.
    tolerance, window, pose_gap : float
        See :class:`LogOptions`, s.
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
    readers : dict of int to TopicReader
        By the number of the channel.
    """

    def __init__(
        self,
        driver: Part,
        readers: Sequence[TopicReader],
        intervals: Intervals | None,
        tolerance: float,
        window: float,
        pose_gap: float,
        *,
        silence: Silence | None = None,
        motion: Motion | None = None,
        recorded: bool = False,
        faults: Faults | None = None,
    ) -> None:
        self.motion = motion
        self.recorded = recorded
        self.faults = Faults() if faults is None else faults
        self.readers = {number: reader for reader in readers for number in reader.topic.channels}
        roles = {reader.role for reader in readers}
        followers: list[Part] = [p for p in ("scan", "pose") if p != driver and p in roles]
        spans = (round(seconds * 1e9) for seconds in (tolerance, window, pose_gap))
        parts: list[Part] = [*followers, "pose"] if motion and motion.from_transforms else followers
        self._assembler = Assembler(driver, parts, intervals, self.faults, motion, recorded)
        self._moving = motion if "transform" in roles else None
        self._synchroniser = Synchroniser(
            driver,
            followers,
            *spans,
            silence=silence,
            usable=self._assembler.usable,
            motion=self._moving,
            labelled="label" in roles,
        )

    def push(self, message: Message) -> Iterator[Match]:
        """Take in a message, and yield what it completes; others than those read are left out."""
        reader = self.readers.get(message.channel_id)
        item = None if reader is None else self._item(reader, message)
        if item is not None:
            yield from self._synchroniser.push(item)

    def finish(self) -> Iterator[Match]:
        """Yield what still waits where no more messages come, and count what was left out."""
        yield from self._synchroniser.finish()
        self._tell_of_time()
        self._tell_of_transforms()

    def observation(self, match: Match) -> Observation | None:
        """Return the observation of a match; None where what makes it does not decode."""
        return self._assembler.observation(match)

    def place(self, match: Match) -> Observation:
        """Return where a match is and under what label, decoding nothing else."""
        return self._assembler.place(match)

    def _item(self, reader: TopicReader, message: Message) -> Item | None:
        try:
            if isinstance(reader, TransformReader) and self.motion is not None:
                reader.take_in(message, self.motion.buffer)
                return None
            return reader.item(message)
        except UnusableObservation as error:
            self.faults.add("messages could not be used", str(error))
            return None

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
