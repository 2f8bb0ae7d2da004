"""What any source gives, found by a walk through it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from placecue.logs.writing.trail import Point, Trail
from placecue.observation import PARTS
from placecue.progress import track
from placecue.source import Source


@dataclass(frozen=True, slots=True)
class SourceSummary:
    """What a source gives.

    Parameters
    ----------
    path : str
        What it is called.
    observations : int
        How many it gives.
    start, end : int
        Stamps of the first and the last, ns; 0 where there are none.
    parts : mapping of str to int
        How many observations have each part.
    labels : mapping of str to int
        Observations by label; those without one under the empty text.
    metadata : mapping of str to str
        Conditions of the recording.
    trail : sequence of (x, y, label)
        The way of the robot, m.
    """

    path: str
    observations: int
    start: int
    end: int
    parts: Mapping[str, int]
    labels: Mapping[str, int]
    metadata: Mapping[str, str]
    trail: Sequence[Point] = ()

    @property
    def duration(self) -> float:
        """From the first to the last, s."""
        return (self.end - self.start) * 1e-9

    @property
    def coverage(self) -> float | None:
        """Share of the observations that have a label, in [0, 1]; None where there are none."""
        return 1.0 - self.labels.get("", 0) / self.observations if self.observations else None


def walk(source: Source) -> SourceSummary:
    """Read a source from end to end, decoding nothing that is not decoded anyway."""
    parts: Counter[str] = Counter()
    labels: Counter[str] = Counter()
    stamps: list[int] = []
    trail = Trail()
    for each in track(source, f"reading {source.name}", source.count()):
        parts.update(part for part in PARTS if each.has(part))
        labels[each.label or ""] += 1
        stamps = [min([*stamps, each.stamp]), max([*stamps, each.stamp])]
        trail.add(each)
    start, end = stamps or (0, 0)
    metadata = dict(source.metadata)
    return SourceSummary(
        source.name, labels.total(), start, end, parts, labels, metadata, trail.points
    )
