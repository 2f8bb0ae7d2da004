"""An MCAP log as a source of observations."""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from inspect import signature
from math import isnan
from pathlib import Path
from typing import Any

from placecue.errors import (
    DataError,
    UnusableObservation,
    UsageError,
)
from placecue.faults import Faults
from placecue.logs.joining import clocks, depth, topics
from placecue.logs.joining.feed import Feed
from placecue.logs.joining.frames import readers_of
from placecue.logs.joining.items import APART, TopicReader
from placecue.logs.joining.labels import Intervals, Seen
from placecue.logs.joining.log_frames import LogFrames
from placecue.logs.joining.pose_choice import choose_pose
from placecue.logs.joining.poses import Motion, PoseReader
from placecue.logs.joining.reading import Reading
from placecue.logs.joining.scan_limit import OneLimit
from placecue.logs.joining.silence import Silence, silence_of
from placecue.logs.joining.topics import Choice
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.options import LogOptions
from placecue.observation import PARTS, LaserScan, Observation, Part

log = logging.getLogger(__name__)


class McapLog(LogOptions):
    """One MCAP file: ROS 1, ROS 2 or Foxglove messages, joined to observations by time.

    Each image makes an observation, or each scan where there are no images, with the nearest
    scan, the pose interpolated to its time, and the label in force. Times are those of the
    message headers; where one has no stamp its log time stands in, and labels without stamps go
    by the log times of what they label. Where that clock jumps back,
    observations go on at the earlier time. Topics are chosen by schema; where there is no laser,
    a depth camera gives virtual scans.
    Nothing is decoded that is not asked for, and memory does not grow with the log.

    Its parameters are those of :class:`LogOptions`.
    """

    _faults_told = False
    _clocks_told = False

    # What the log is, looked up on first use.

    @cached_property
    def file(self) -> LogFile:
        """The file and what it holds."""
        return LogFile(self.path)

    @cached_property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """Conditions of the recording, from the metadata record ``placecue``."""
        return self.file.contents.metadata.get("placecue", {})

    @cached_property
    def topics(self) -> list[Topic]:
        """The topics of the log."""
        return depth.marked(self.file)

    @cached_property
    def choices(self) -> dict[Part, Choice]:
        """Which topic gives which part.

        Raises
        ------
        UsageError
            If a topic must be chosen, or a chosen one is not there.
        DataError
            If there is neither an image nor a scan topic.
        """
        wanted = topics.check_parts(PARTS if self.parts is None else self.parts)
        chosen = {part: self.choose(part) for part in wanted}
        makers = [part for part in wanted if part in ("image", "scan")]
        if not any(chosen[part].topics for part in makers):
            raise DataError(
                f"{self.path} holds no {' and no '.join(makers)} that can be read; its topics: "
                f"{', '.join(map(_described, self.topics)) or 'none'}"
            )
        return chosen

    def choose(self, part: Part) -> Choice:
        """Choose what gives one part.

        Raises
        ------
        UsageError, DataError
            See :attr:`choices`.
        """
        if part == "label" and self.labels is not None:
            return Choice(part, (), f"intervals of {self.labels}")
        name, where = getattr(self, f"{part}_topic"), str(self.path)
        if part != "pose":
            return topics.choose(part, self.topics, name, where)
        frames = self.frames
        found = choose_pose(
            self.topics, name, where, frames.driver, frames.moving_topics, frames.may_be_fixed
        )
        lost = not found.topics and not found.others and frames.unplaced is not None
        return replace(found, reason=frames.unplaced or "") if lost else found

    @property
    def driver(self) -> Part:
        """The part that makes an observation: image, or scan where there is no image topic."""
        image = self.choices.get("image")
        return "image" if image is not None and image.topics else "scan"

    @cached_property
    def camera_silence(self) -> Silence | None:
        """When the camera counts as silent, so that scans make the observations; None for never."""
        scans = self.choices.get("scan")
        if self.driver == "scan" or self.silence is None or scans is None or not scans.topics:
            return None
        camera = self.choices["image"].topic
        assert camera is not None  # or it would not drive
        return silence_of(self.file, camera, self.silence, self.start_time)

    @cached_property
    def intervals(self) -> Intervals | None:
        """The labels beside the log."""
        return None if self.labels is None else Intervals.from_csv(self.labels)

    @cached_property
    def frames(self) -> LogFrames:
        """The frames of reference."""
        return LogFrames(self)

    @cached_property
    def behind(self) -> dict[str, int]:
        """How far the headers of the chosen topics are behind the recorder's clock, ns."""
        chosen = [reader for part in self.choices for reader in self._plain_readers(part)]
        placed = "pose" in self.choices or "scan" in self.choices
        moved = [each for each in self.frames.readers if not each.static] if placed else []
        found = clocks.measured(self.file, [*chosen, *moved])
        return {**found, **self._labels_behind(found.get(self._driver.name, 0))}

    def _labels_behind(self, own: int) -> dict[str, int]:
        """Return the same of labels with stamps, where those can never meet the drivers' clock."""
        stamped = [t for t in self._read("label") if not t.schema.endswith("String")]
        found = clocks.measured(self.file, [TopicReader(self.file, topic) for topic in stamped])
        length = self.file.contents.end - self.start_time
        return {name: each for name, each in found.items() if abs(each - own) > length + APART}

    @property
    def start_time(self) -> int:
        """Log time of the first message that was recorded with a clock, ns."""
        start = self.file.contents.start
        if start > 0:
            return start
        return next(
            (m.log_time for m in self.file.messages(self.file.contents.channels) if m.log_time > 0),
            start,
        )

    @cached_property
    def _scan_limit(self) -> float | None:
        """The limit of the first scan that makes sense, m; None where there is none."""
        scans = self.choices["scan"].topic
        assert scans is not None  # asked only where scans are read
        reader = TopicReader(self.file, scans)
        for message in self.file.messages(scans.channels):
            try:
                item = reader.item(message)
                first: LaserScan | None = None if item is None else item.value()
            except UnusableObservation:
                continue  # counted when the scans are read
            if first is not None:
                return self.range_max if isnan(first.range_max) else first.range_max
        return None

    @cached_property
    def _limits_told(self) -> set[str]:
        return set()

    def _under_one_limit(
        self, scans: Topic, place: Callable[[LaserScan, int], LaserScan]
    ) -> Callable[[LaserScan, int], LaserScan]:
        if self._scan_limit is None:
            return place
        where = f"{self.path}, {scans.name}"
        return OneLimit(self._scan_limit, place, where, self._limits_told)

    # The observations.

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations in order of time.

        Raises
        ------
        UsageError, DataError
            See :attr:`choices`; or the labels beside the log cannot be read.
        """
        reading = self._reading()
        if not self._faults_told:
            self._tell_taken()
        if self.intervals is None or reading.feed.recorded:
            yield from reading.observations()
        else:
            yield from self._meeting(self.intervals, reading.observations())
        if not self._faults_told:
            reading.feed.faults.report()
            self._faults_told = True

    def _meeting(
        self, intervals: Intervals, observations: Iterator[Observation]
    ) -> Iterator[Observation]:
        """Yield observations; refuse labels of another clock, and tell where none meets the log."""
        seen = Seen()
        for observation in observations:
            seen.add(observation.stamp)
            if len(seen) == 1:
                length = self.file.contents.end - self.file.contents.start
                intervals.check_clock(observation.stamp, length, str(self.path))
            yield observation
        if not self._faults_told:
            intervals.tell_apart(seen, str(self.path))

    def _tell_taken(self) -> None:
        """Say what is read, where there was something to choose between."""
        left = {each for choice in self.choices.values() for each in choice.others}
        if any(topics.role_of(topic) != "transform" for topic in left):
            log.info(f"{self.path}: {self.taken()}")
        pose = self.choices.get("pose")
        if pose is not None and not pose.topics and pose.reason == self.frames.unplaced:
            log.warning(f"{self.path}: no pose: {pose.reason}")

    def taken(self) -> str:
        """Return in one line which topics and frames are read, and what else there was."""
        return "; ".join(
            f"{part} {', '.join(topic.name for topic in choice.topics) or 'none'} "
            f"({told(choice, self.frames)})"
            for part, choice in self.choices.items()
        )

    def trail(self) -> Iterator[Observation]:
        """Yield the observations with nothing but pose and label, decoding nothing else."""
        return self._reading().trail()

    def digest(self) -> str:
        """Return a SHA-256 of the file, and of the options where they are not the default ones.

        Which parts are read does not count, unless it decides what makes an observation.
        """
        return self._digest

    def count(self) -> int | None:
        """Return the number of images, or of scans where there are no images, if it is known."""
        topic = self.choices[self.driver].topic
        whole = self.start is None and self.end is None and self.camera_silence is None
        return topic.count if topic is not None and whole else None

    # How.

    @cached_property
    def _digest(self) -> str:
        content = self.file.digest()
        options = {
            name: getattr(self, name)
            for name, default in defaults_of(type(self)).items()
            if name != "parts" and getattr(self, name) != default
        }
        if self.labels is not None:
            options["labels"] = hashlib.sha256(repr(self.intervals).encode()).hexdigest()
        images = any(topics.role_of(each) == "image" for each in self.topics)
        if images and self.driver == "scan":
            options["driver"] = "scan"  # another choice of parts would have taken the images
        if self.camera_silence is not None:
            options["silence"] = self.silence  # another choice of parts has images alone
        if not options:
            return content
        return hashlib.sha256((content + json.dumps(options, sort_keys=True)).encode()).hexdigest()

    def _read(self, part: Part) -> tuple[Topic, ...]:
        choice = self.choices.get(part)
        return () if choice is None else choice.topics

    def feed(self) -> Feed:
        """Return what takes messages of these topics, one at a time, and gives observations.

        Topics, frames and clocks are what a look at the log found.
        """
        faults = Faults(str(self.path))
        motion = self.frames.motion(faults)
        readers = [r for part in self.choices for r in self._readers(part, motion, faults)]
        readers += readers_of(self.file, self.frames.taken_in(motion))
        clocks.set_clocks(readers, self.behind, self._driver.name)
        if not self._clocks_told:
            clocks.tell(readers, self.behind, self._driver.name, str(self.path))
            self._clocks_told = True
        return Feed(
            self.driver,
            readers,
            self.intervals,
            self.tolerance,
            self.window,
            self.pose_gap,
            silence=self.camera_silence,
            motion=motion,
            recorded=self._labels_recorded(),
            faults=faults,
        )

    def _reading(self) -> Reading:
        return Reading(self.file, self.feed(), *self._span())

    @property
    def _driver(self) -> Topic:
        topic = self.choices[self.driver].topic
        assert topic is not None  # or there would be no choices
        return topic

    def _labels_recorded(self) -> bool:
        """Tell whether the labels beside the log meet it by the recorder's clock alone."""
        behind = self.behind.get(self._driver.name, 0)
        if self.intervals is None or abs(behind) < APART:
            return False
        start, end = self.start_time, self.file.contents.end
        recorded = self.intervals.meets(start, end)
        if not recorded or self.intervals.meets(start - behind, end - behind):
            return False
        log.warning(
            f"{self.path}: the intervals of {self.labels} are read on the recorder's clock, for "
            "they do not meet the stamps of the headers"
        )
        return True

    def _plain_readers(self, part: Part) -> list[TopicReader]:
        found = [topic for topic in self._read(part) if topics.role_of(topic) != "transform"]
        return [TopicReader(self.file, topic) for topic in found if part != "label"]

    def _readers(self, part: Part, motion: Motion, faults: Faults) -> list[TopicReader]:
        chosen = self._read(part)
        if part == "pose":
            found = [topic for topic in chosen if topics.role_of(topic) != "transform"]
            carrier = motion if self.frames.carries(motion) else None
            return [PoseReader(self.file, topic, carrier, faults) for topic in found]
        if part == "scan" and chosen:
            place = self.frames.mountings(motion, faults).place
            if chosen[0].depth:
                return [depth.DepthReader(self.file, chosen[0], self.file.topics(), place)]
            placed = self._under_one_limit(chosen[0], place)
            return [TopicReader(self.file, topic, placed) for topic in chosen]
        return [TopicReader(self.file, topic) for topic in chosen]

    def _span(self) -> tuple[int | None, int | None]:
        first = 0 if self.start is None and self.end is None else self.start_time
        since = None if self.start is None else first + round(self.start * 1e9)
        until = None if self.end is None else first + round(self.end * 1e9)
        return since, until


def open_log(path: str | Path, **options: Any) -> McapLog:
    """Open an MCAP log and choose its topics.

    Parameters
    ----------
    path : str or Path
        The file.
    **options
        Parameters of :class:`LogOptions`.

    Raises
    ------
    UsageError
        If a topic must be chosen, a chosen one is not there, or an option is not known.
    DataError
        If the file is missing, not MCAP, or holds nothing to observe.

    Examples
    --------
    >>> for observation in open_log("run1.mcap"):  # doctest: +SKIP
    ...     print(observation.stamp, observation.label)
    """
    unknown = set(options) - set(_DEFAULTS)
    if unknown:
        raise UsageError(
            f"open_log has no option {', '.join(sorted(unknown))}; it has: {', '.join(_DEFAULTS)}"
        )
    log = McapLog(str(path), **options)
    _ = log.choices  # errors come now and not in the middle of something
    return log


def told(choice: Choice, frames: LogFrames) -> str:
    """Return why a choice was made, its frames, and what else there was."""
    others = ", ".join(topic.name for topic in choice.others)
    frame = frames.told(choice)
    left = f"; not taken: {others}" if others else ""
    return f"{choice.reason}{f', {frame}' if frame else ''}{left}"


def _described(topic: Topic) -> str:
    count = "?" if topic.count is None else topic.count
    return f"{topic.name} ({topic.encoding} {topic.schema or 'without schema'}, {count} messages)"


def defaults_of(kind: type[McapLog]) -> dict[str, Any]:
    """Return the options of a kind of log with their defaults."""
    return {
        parameter.name: parameter.default
        for parameter in signature(kind).parameters.values()
        if parameter.default is not parameter.empty
    }


_DEFAULTS = defaults_of(McapLog)
