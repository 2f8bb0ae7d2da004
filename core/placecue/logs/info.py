"""What is in a log, and what placecue would use of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from placecue.errors import PlacecueError
from placecue.logs import topics
from placecue.logs.container import Topic
from placecue.logs.reader import McapLog
from placecue.observation import PARTS, Part
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
        Observations by label; those without one under the empty text. Empty where labels were
        not counted.
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
    problem: str | None = None


def summarise(path: str, count_labels: bool = True, **options: Any) -> LogSummary:
    """Look at a log.

    Parameters
    ----------
    path : str
        The file.
    count_labels : bool
        Whether to go through the log for the labels of its observations; nothing but labels is
        decoded.
    **options
        Options of :class:`McapLog`, such as chosen topics.

    Returns
    -------
    LogSummary
        Also where a topic must be chosen; the summary then says so.

    Raises
    ------
    DataError
        If the file is missing or not MCAP.
    """
    log = McapLog(str(path), **options)
    contents = log.file.contents
    available = log.file.topics()
    duration = (contents.end - contents.start) * 1e-9
    parts = tuple(_part(log, part, available) for part in PARTS)
    problem, observations, labels = _observations(log, count_labels)
    used = {name for part in parts for name in part.topics}
    return LogSummary(
        path=str(path),
        size=log.file.size,
        start=contents.start,
        end=contents.end,
        duration=duration,
        whole=contents.damage is None,
        indexed=bool(contents.chunks),
        topics=tuple(_topic(topic, duration, topic.name in used) for topic in available),
        parts=parts,
        metadata=log.metadata,
        observations=observations,
        labels=labels,
        problem=problem,
    )


def _part(log: McapLog, part: Part, available: list[Topic]) -> PartSummary:
    if part == "label" and log.labels is not None:
        return PartSummary(part, (), f"intervals of {log.labels}", clear=True)
    try:
        choice = topics.choose(part, available, getattr(log, f"{part}_topic"), log.name)
    except PlacecueError as error:
        return PartSummary(part, (), str(error), clear=False)
    return PartSummary(part, tuple(topic.name for topic in choice.topics), choice.reason, True)


def _topic(topic: Topic, duration: float, used: bool) -> TopicSummary:
    rate = topic.count / duration if topic.count and duration > 0 else None
    gives = topics.role_of(topic) or "nothing"
    return TopicSummary(topic.name, topic.schema, topic.encoding, topic.count, rate, gives, used)


def _observations(log: McapLog, count_labels: bool) -> tuple[str | None, int | None, Counter[str]]:
    try:
        expected = log.count()
        if not count_labels:
            return None, expected, Counter()
        labels = Counter(
            label or "" for label in track(log.labels_only(), "counting labels", expected)
        )
    except PlacecueError as error:
        return str(error), None, Counter()
    return None, labels.total(), labels
