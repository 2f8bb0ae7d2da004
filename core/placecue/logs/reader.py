"""An MCAP log as a source of observations."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from inspect import signature
from pathlib import Path
from typing import Any

from placecue.errors import (
    ComponentError,
    ContractError,
    DataError,
    UnusableObservation,
    UsageError,
)
from placecue.guard import call
from placecue.logs.adapters import contract
from placecue.logs.joining import depth, mounting, topics
from placecue.logs.joining.items import TopicReader
from placecue.logs.joining.labels import Intervals, Seen
from placecue.logs.joining.mounting import Mounting
from placecue.logs.joining.reading import Reading
from placecue.logs.joining.scan_limit import OneLimit
from placecue.logs.joining.silence import Silence, silence_of
from placecue.logs.joining.topics import Choice
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.messages.geometry import TransformTree
from placecue.logs.options import LogOptions
from placecue.observation import PARTS, LaserScan, Observation, Part


class McapLog(LogOptions):
    """One MCAP file: ROS 1, ROS 2 or Foxglove messages, joined to observations by time.

    Each image makes an observation, or each scan where there are no images, with the nearest
    scan, the pose interpolated to its time, and the label in force. Times are those of the
    message headers; the log time stands in where a header has none. Where that clock jumps back,
    observations go on at the earlier time. Topics are chosen by schema; where there is no laser,
    a depth camera gives virtual scans.
    Nothing is decoded that is not asked for, and memory does not grow with the log.

    Its parameters are those of :class:`LogOptions`.
    """

    _faults_told = False

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
        available = self.topics
        wanted = topics.check_parts(PARTS if self.parts is None else self.parts)
        chosen: dict[Part, Choice] = {}
        for part in wanted:
            if part == "label" and self.labels is not None:
                chosen[part] = Choice(part, (), f"intervals of {self.labels}")
            else:
                name = getattr(self, f"{part}_topic")
                chosen[part] = topics.choose(part, available, name, str(self.path))
        makers = [part for part in wanted if part in ("image", "scan")]
        if not any(chosen[part].topics for part in makers):
            raise DataError(
                f"{self.path} holds no {' and no '.join(makers)} that can be read; its topics: "
                f"{', '.join(map(_described, available)) or 'none'}"
            )
        return chosen

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
        return silence_of(self.file, camera, self.silence)

    @cached_property
    def intervals(self) -> Intervals | None:
        """The labels beside the log."""
        return None if self.labels is None else Intervals.from_csv(self.labels)

    @cached_property
    def mounting(self) -> Mounting:
        """Where the laser sits on the robot."""
        scans = self.choices["scan"].topic
        assert scans is not None  # asked only where scans are read
        laser = self.laser_frame or self._frame_of_first(scans)
        tree = self._tree(laser)
        if scans.depth and tree.transforms:
            tree.add(depth.looking_ahead(laser))
            laser = depth.looking_ahead(laser).child
        return mounting.find_mounting(tree, laser, self.base_frame, self.range_max, str(self.path))

    @cached_property
    def _place_under_one_limit(self) -> Callable[[LaserScan], LaserScan]:
        scans = self.choices["scan"].topic
        assert scans is not None  # asked only where scans are read
        place = self.mounting.place
        reader = TopicReader(self.file, scans, place)
        for message in self.file.messages(scans.channels):
            try:
                item = reader.item(message)
                first: LaserScan | None = None if item is None else item.value()
            except UnusableObservation:
                continue  # counted when the scans are read
            if first is not None:
                return OneLimit(first.range_max, place, f"{self.path}, {scans.name}")
        return place

    # The observations.

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations in order of time.

        Raises
        ------
        UsageError, DataError
            See :attr:`choices`; or the labels beside the log cannot be read.
        """
        reading = self._reading()
        seen = Seen()
        for observation in reading.observations():
            seen.add(observation.stamp)
            if self.intervals is not None and len(seen) == 1:
                length = self.file.contents.end - self.file.contents.start
                self.intervals.check_clock(observation.stamp, length, str(self.path))
            yield observation
        if self.intervals is not None and not self._faults_told:
            self.intervals.tell_apart(seen, str(self.path))
        if not self._faults_told:
            reading.faults.report()
            self._faults_told = True

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

    def _reading(self) -> Reading:
        readers = [reader for part in self.choices for reader in self._readers(part)]
        spans = (self.tolerance, self.window, self.pose_gap)
        span, silence = self._span(), self.camera_silence
        return Reading(
            self.file, self.driver, readers, self.intervals, *spans, *span, silence=silence
        )

    def _readers(self, part: Part) -> list[TopicReader]:
        chosen = self._read(part)
        if part == "pose" and chosen and topics.role_of(chosen[0]) == "transform":
            tree = self._tree(None)
            return mounting.pose_readers(self.file, chosen, tree, self.base_frame, self.pose_frame)
        if part == "scan" and chosen and chosen[0].depth:
            return [
                depth.DepthReader(self.file, chosen[0], self.file.topics(), self.mounting.place)
            ]
        finish = self._place_under_one_limit if part == "scan" and chosen else None
        return [TopicReader(self.file, topic, finish) for topic in chosen]

    def _span(self) -> tuple[int | None, int | None]:
        first = self.file.contents.start
        since = None if self.start is None else first + round(self.start * 1e9)
        until = None if self.end is None else first + round(self.end * 1e9)
        return since, until

    def _frame_of_first(self, topic: Topic) -> str:
        reader = TopicReader(self.file, topic)
        for message in self.file.messages(topic.channels):
            try:
                decoded = reader.decoded(message)
                frame: str = call(reader.adapter, "frame", decoded, check=contract.text)
                return frame
            except ContractError:
                raise
            except (UnusableObservation, ComponentError):
                continue  # counted when the scans are read
        return ""

    def _tree(self, laser: str | None) -> TransformTree:
        moving = topics.transforms(self.file.topics())
        wanted = None
        if laser is not None:
            wanted = (self.base_frame or mounting.BASE_FRAMES[0], laser)
        return mounting.read_tree(self.file, moving, wanted, self.transform_horizon)


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
