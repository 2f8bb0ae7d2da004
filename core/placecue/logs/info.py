"""What is in a log, and what placecue would use of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from placecue.errors import PlacecueError
from placecue.logs.joining import topics
from placecue.logs.joining.timing import Gap, largest_gaps
from placecue.logs.mcap.container import Topic
from placecue.logs.reader import McapLog, told
from placecue.logs.writing.trail import Point, Trail
from placecue.observation import PARTS, Observation, Part
from placecue.progress import track


@dataclass(frozen=True, slots=True)
class TopicSummary:
    """One topic of a log.

    Parameters
    ----------
    name, schema, encoding : str
        As the log has them.
    count : int or None
        Number of messages, where known.
    rate : float or None
        Messages a second over the whole log, where known.
    gap : Gap or None
        The longest time without a message; None where there are fewer than two.
    gives : str
        What it could give: image, scan, pose, label, transform, or nothing.
    used : bool
        Whether it would be used.
    """

    name: str
    schema: str
    encoding: str
    count: int | None
    rate: float | None
    gap: Gap | None
    gives: str
    used: bool


@dataclass(frozen=True, slots=True)
class PartSummary:
    """Where a part of the observations would come from.

    Parameters
    ----------
    part : {"image", "scan", "pose", "label"}
        The part.
    topics : tuple of str
        The topics used; none where the part is missing or must be chosen.
    reason : str
        Why, or what to type.
    clear : bool
        Whether nothing need be chosen.
    """

    part: Part
    topics: tuple[str, ...]
    reason: str
    clear: bool


@dataclass(frozen=True, slots=True)
class LogSummary:
    """What is in a log.

    Parameters
    ----------
    path : str
        The file.
    size : int
        Bytes.
    start, end : int
        Log times of the first and last message, ns.
    duration : float
        From the one to the other, s.
    whole : bool
        Whether the file has a good end.
    indexed : bool
        Whether it can be read by index.
    topics : tuple of TopicSummary
        In order of name.
    parts : tuple of PartSummary
        In the usual order.
    metadata : mapping of str to str
        Conditions of the recording.
    observations : int or None
        How many observations it makes, where known.
    labels : mapping of str to int
        Observations by label; those without one under the empty text.
    trail : sequence of (x, y, label)
        The way of the robot, m; empty where there are no poses.
    problem : str or None
        Why it cannot be read as it is.
    """

    path: str
    size: int
    start: int
    end: int
    duration: float
    whole: bool
    indexed: bool
    topics: tuple[TopicSummary, ...]
    parts: tuple[PartSummary, ...]
    metadata: Mapping[str, str] = field(default_factory=dict)
    observations: int | None = None
    labels: Mapping[str, int] = field(default_factory=dict)
    trail: Sequence[Point] = ()
    problem: str | None = None

    @property
    def coverage(self) -> float | None:
        """Share of the observations that have a label, in [0, 1]; None where there are none."""
        if not self.observations:
            return None
        return 1.0 - self.labels.get("", 0) / self.observations


def summarise(log: McapLog, label: Callable[[Observation], str | None] | None = None) -> LogSummary:
    """Look at a log: at its index, and at the poses and labels of its observations.

    Parameters
    ----------
    log : McapLog
        The log, perhaps with chosen topics.
    label : callable, optional
        Gives the label of an observation that has only pose and label; its own by default.

    Returns
    -------
    LogSummary
        Also where a topic must be chosen; the summary then says so.

    Raises
    ------
    DataError
        If the file is missing or not MCAP.
    """
    contents = log.file.contents
    duration = (contents.end - log.start_time) * 1e-9
    parts = tuple(_part(log, part) for part in PARTS)
    used = {name for part in parts for name in part.topics}
    gaps = largest_gaps(log.file, log.topics)
    problem, labels, trail = _observations(log, label or (lambda observation: observation.label))
    return LogSummary(
        path=str(log.path),
        size=log.file.size,
        start=log.start_time,
        end=contents.end,
        duration=duration,
        whole=contents.damage is None,
        indexed=bool(contents.chunks),
        topics=tuple(
            _topic(topic, duration, gaps.get(topic.name), topic.name in used)
            for topic in log.topics
        ),
        parts=parts,
        metadata=log.metadata,
        observations=None if problem else labels.total(),
        labels=labels,
        trail=trail,
        problem=problem,
    )


def _part(log: McapLog, part: Part) -> PartSummary:
    try:
        choice = log.choose(part)
        reason = told(choice, log.frames)
    except PlacecueError as error:
        return PartSummary(part, (), str(error), clear=False)
    return PartSummary(part, tuple(topic.name for topic in choice.topics), reason, True)


def _topic(topic: Topic, duration: float, gap: Gap | None, used: bool) -> TopicSummary:
    rate = topic.count / duration if topic.count and duration > 0 else None
    gives = topics.role_of(topic) or "nothing"
    schema, encoding = topic.schema, topic.encoding
    return TopicSummary(topic.name, schema, encoding, topic.count, rate, gap, gives, used)


def _observations(
    log: McapLog, label: Callable[[Observation], str | None]
) -> tuple[str | None, Counter[str], Sequence[Point]]:
    labels: Counter[str] = Counter()
    trail = Trail()
    try:
        for each in track(log.trail(), "reading poses and labels", log.count()):
            named = each.relabelled(label(each))
            labels[named.label or ""] += 1
            trail.add(named)
    except PlacecueError as error:
        return str(error), Counter(), ()
    return None, labels, trail.points
