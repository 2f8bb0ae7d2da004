"""An MCAP log as a source of observations."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from inspect import signature
from itertools import chain
from pathlib import Path
from typing import Any

from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.logs import mounting, topics
from placecue.logs.container import LogFile, Topic
from placecue.logs.faults import Faults
from placecue.logs.geometry import TransformTree
from placecue.logs.items import Item, TopicReader
from placecue.logs.labels import Intervals
from placecue.logs.mounting import Mounting
from placecue.logs.synchronise import Match, Synchroniser, interpolate
from placecue.logs.topics import Choice
from placecue.observation import PARTS, LaserScan, Observation, Part, Pose2D
from placecue.source import Source


class McapLog(Source):
    """One MCAP file: ROS 2 (CDR) or Foxglove JSON messages, joined to observations by time.

    Each image makes an observation, or each scan where there are no images, with the nearest
    scan, the pose interpolated to its time, and the label in force. Times are those of the
    message headers; the log time stands in where a header has none. Topics are chosen by schema.
    Nothing is decoded that is not asked for, and memory does not grow with the log.

    Parameters
    ----------
    path : str
        The file.
    image_topic, scan_topic, pose_topic, label_topic : str, optional
        Topics to take; needed where several could give a part.
    labels : str, optional
        CSV file with the columns start, end, label (see :class:`Intervals`); it takes the place
        of a label topic.
    parts : list of str, optional
        What to read, of image, scan, pose and label; all by default. Topics of other parts are
        neither read nor asked about.
    tolerance : float
        How far apart an image and its scan, or a lone pose, may be, s.
    window : float
        How late a message may be written against others of the same time, s.
    pose_gap : float
        How far apart two poses may be to interpolate between them, s.
    base_frame : str, optional
        The robot's own frame; base_link, base_footprint or base by default.
    laser_frame : str, optional
        The laser's frame, where the scans name a wrong one.
    pose_frame : str, optional
        The fixed frame, where poses come from transforms; odom, map or world by default.
    range_max : float
        The scanner's limit where messages do not say it (Foxglove's do not), m.
    transform_horizon : float
        How much of the beginning is searched for transforms that are not static, s.
    start, end : float, optional
        The part of the log to read, s from its first message by log time.
    """

    def __init__(
        self,
        path: str,
        image_topic: str | None = None,
        scan_topic: str | None = None,
        pose_topic: str | None = None,
        label_topic: str | None = None,
        labels: str | None = None,
        parts: Sequence[str] | None = None,
        tolerance: float = 0.1,
        window: float = 1.0,
        pose_gap: float = 1.0,
        base_frame: str | None = None,
        laser_frame: str | None = None,
        pose_frame: str | None = None,
        range_max: float = 30.0,
        transform_horizon: float = 10.0,
        start: float | None = None,
        end: float | None = None,
    ) -> None:
        self.path = path
        self.image_topic = image_topic
        self.scan_topic = scan_topic
        self.pose_topic = pose_topic
        self.label_topic = label_topic
        self.labels = labels
        self.parts = parts
        self.tolerance = tolerance
        self.window = window
        self.pose_gap = pose_gap
        self.base_frame = base_frame
        self.laser_frame = laser_frame
        self.pose_frame = pose_frame
        self.range_max = range_max
        self.transform_horizon = transform_horizon
        self.start = start
        self.end = end
        self.name = Path(path).name
        self._faults_told = False

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
    def choices(self) -> dict[Part, Choice]:
        """Which topic gives which part.

        Raises
        ------
        UsageError
            If a topic must be chosen, or a chosen one is not there.
        DataError
            If there is neither an image nor a scan topic.
        """
        available = self.file.topics()
        wanted = topics.check_parts(PARTS if self.parts is None else self.parts)
        chosen: dict[Part, Choice] = {}
        for part in wanted:
            if part == "label" and self.labels is not None:
                chosen[part] = Choice(part, (), f"intervals of {self.labels}")
            else:
                name = getattr(self, f"{part}_topic")
                chosen[part] = topics.choose(part, available, name, str(self.path))
        if not any(chosen[part].topics for part in wanted if part in ("image", "scan")):
            raise DataError(
                f"{self.path} holds no {' and no '.join(p for p in wanted if p in ('image', 'scan'))}"
                f" that can be read; its topics: {', '.join(map(_described, available)) or 'none'}"
            )
        return chosen

    @property
    def driver(self) -> Part:
        """The part that makes an observation: image, or scan where there is no image topic."""
        image = self.choices.get("image")
        return "image" if image is not None and image.topics else "scan"

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
        return mounting.find_mounting(tree, laser, self.base_frame, self.range_max, str(self.path))

    # The observations.

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations in order of time.

        Raises
        ------
        UsageError, DataError
            See :attr:`choices`; or the labels beside the log cannot be read.
        """
        faults = Faults(str(self.path))
        for match in self.matches(faults):
            observation = self._observation(match, faults)
            if observation is not None:
                yield observation
        if not self._faults_told:
            faults.report()
            self._faults_told = True

    def matches(self, faults: Faults) -> Iterator[Match]:
        """Yield the messages that make each observation, undecoded, in order of time.

        Parameters
        ----------
        faults : Faults
            Takes what goes wrong.
        """
        followers: list[Part] = [
            part for part in ("scan", "pose") if part != self.driver and self._read(part)
        ]
        synchroniser = Synchroniser(
            self.driver,
            followers,
            *(round(seconds * 1e9) for seconds in (self.tolerance, self.window, self.pose_gap)),
        )
        for item in self._items(faults):
            yield from synchroniser.push(item)
        yield from synchroniser.finish()
        if synchroniser.late:
            kind = f"{self.driver} messages came more than {self.window:g} s late and were left out"
            faults.add(kind, "raise source.window to keep them", synchroniser.late)

    def digest(self) -> str:
        """Return a SHA-256 of the file, and of the options where they are not the default ones."""
        return self._digest

    def count(self) -> int | None:
        """Return the number of images, or of scans where there are no images, if it is known."""
        topic = self.choices[self.driver].topic
        whole = self.start is None and self.end is None
        return topic.count if topic is not None and whole else None

    # How.

    @cached_property
    def _digest(self) -> str:
        content = self.file.digest()
        options = {
            key: value
            for key, value in self._options().items()
            if value != _DEFAULTS[key] and key != "labels"
        }
        if self.labels is not None:
            options["labels"] = hashlib.sha256(Path(self.labels).read_bytes()).hexdigest()
        if not options:
            return content
        return hashlib.sha256((content + json.dumps(options, sort_keys=True)).encode()).hexdigest()

    def _options(self) -> dict[str, Any]:
        return {key: getattr(self, key) for key in _DEFAULTS}

    def _read(self, part: Part) -> tuple[Topic, ...]:
        choice = self.choices.get(part)
        return () if choice is None else choice.topics

    def _readers(self) -> dict[int, TopicReader]:
        finish: dict[Part, Callable[[LaserScan], LaserScan]] = {}
        if self._read("scan"):
            finish["scan"] = self.mounting.place
        readers: list[TopicReader] = []
        for part in self.choices:
            chosen = self._read(part)
            if part == "pose" and any(topics.role_of(each) == "transform" for each in chosen):
                readers += mounting.pose_readers(
                    self.file, chosen, self._tree(None), self.base_frame, self.pose_frame
                )
            else:
                readers += [TopicReader(self.file, each, finish.get(part)) for each in chosen]
        return {number: reader for reader in readers for number in reader.topic.channels}

    def _items(self, faults: Faults) -> Iterator[Item]:
        readers = self._readers()
        since, until = self._span()
        labels = [number for number, reader in readers.items() if reader.adapter.role == "label"]
        before = self.file.messages(labels, until=since) if labels and since is not None else ()
        for message in chain(before, self.file.messages(readers, since, until)):
            try:
                item = readers[message.channel_id].item(message)
            except UnusableObservation as error:
                faults.add("messages could not be used", str(error))
                continue
            if item is not None:
                yield item

    def _span(self) -> tuple[int | None, int | None]:
        first = self.file.contents.start
        since = None if self.start is None else first + round(self.start * 1e9)
        until = None if self.end is None else first + round(self.end * 1e9)
        return since, until

    def _observation(self, match: Match, faults: Faults) -> Observation | None:
        driver = _value(match.driver, faults)
        if driver is None:
            return None
        stamp = match.driver.stamp
        scan = driver if self.driver == "scan" else self._follower("scan", match, faults)
        return Observation(
            stamp,
            image=driver if self.driver == "image" else None,
            scan=scan,
            pose=self._follower("pose", match, faults),
            label=self._label(match, faults),
        )

    def _follower(self, part: Part, match: Match, faults: Faults) -> Any:
        if not self._read(part):
            return None
        stamp = match.driver.stamp
        found = (match.scan,) if part == "scan" else match.poses
        if not found or found[0] is None:
            faults.add(f"{self.driver}s have no {part} near enough in time", f"at stamp {stamp}")
            return None
        return _value(found[0], faults) if part == "scan" else _pose(match.poses, stamp, faults)

    def _label(self, match: Match, faults: Faults) -> str | None:
        if "label" not in self.choices:
            return None
        if self.intervals is not None:
            return self.intervals.at(match.driver.stamp)
        label: str | None = None if match.label is None else _value(match.label, faults)
        return label or None

    def _frame_of_first(self, topic: Topic) -> str:
        reader = TopicReader(self.file, topic)
        for message in self.file.messages(topic.channels):
            try:
                return reader.adapter.frame(reader.decoded(message))
            except (UnusableObservation, LookupError, AttributeError):
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
        Parameters of :class:`McapLog`.

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


def _value(item: Item, faults: Faults) -> Any:
    try:
        return item.value()
    except UnusableObservation as error:
        faults.add("messages could not be used", str(error))
        return None


def _pose(poses: tuple[Item, ...], stamp: int, faults: Faults) -> Pose2D | None:
    values: list[Pose2D] = [value for item in poses if (value := _value(item, faults)) is not None]
    if len(values) < 2:
        return values[0] if values else None
    first, second = (item.stamp for item in poses)
    return interpolate(*values, (stamp - first) / (second - first))


def _described(topic: Topic) -> str:
    count = "?" if topic.count is None else topic.count
    return f"{topic.name} ({topic.encoding} {topic.schema or 'without schema'}, {count} messages)"


_DEFAULTS: dict[str, Any] = {
    parameter.name: parameter.default
    for parameter in signature(McapLog).parameters.values()
    if parameter.default is not parameter.empty
}
