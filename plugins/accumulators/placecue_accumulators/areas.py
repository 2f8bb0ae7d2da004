"""The areas found so far, and which nodes of the navigation graph belong to each."""

from __future__ import annotations

from dataclasses import dataclass, field

from placecue.scores import Layout
from placecue.semantic_map import UNKNOWN, Area
from placecue_accumulators.histogram import BinSums, Key

Way = dict[Key, tuple[float, float]]


@dataclass(slots=True)
class AreaRecord:
    """One area while it grows.

    Parameters
    ----------
    number : int
        Number of the area.
    start, end : int
        Stamps of its first and last observation, ns.
    label, confidence, scores
        What the accumulated belief said when it last was sure enough.
    evidence : BinSums
        Sum of the stored priors of its nodes.
    way : dict of bin to (float, float)
        Positions that the robot passed, m, one a bin.
    nodes : list of int
        Its nodes, gateways included.
    """

    number: int
    start: int
    end: int
    label: str = UNKNOWN
    confidence: float = 0.0
    scores: dict[str, float] = field(default_factory=dict)
    evidence: BinSums = field(default_factory=BinSums)
    way: Way = field(default_factory=dict)
    nodes: list[int] = field(default_factory=list)

    def judge(self, sums: BinSums, layout: Layout, threshold: float) -> bool:
        """Decide on accumulated scores by the layout's own rule.

        A label once given stays until another one is sure enough.

        Parameters
        ----------
        sums : BinSums
            Scores summed over bins; at least one bin.
        layout : Layout
            What the scores are.
        threshold : float
            Least confidence to give a label, in the unit of the scores.

        Returns
        -------
        bool
            Whether the label changed.
        """
        mean = sums.mean()
        decision = layout.decide(mean[None])
        label, confidence = str(decision.labels[0]), float(decision.confidence[0])
        sure = confidence >= threshold
        if not sure and self.label not in (UNKNOWN, label):
            return False
        self.scores = dict(zip(layout.columns, mean.tolist(), strict=True))
        if not sure and self.label == UNKNOWN:
            return False
        changed = self.label != label
        self.label, self.confidence = label, confidence
        return changed

    def absorb(self, other: AreaRecord) -> None:
        """Take over the nodes, way and evidence of another area, and its label if weightier."""
        weightier = other.label != UNKNOWN and other.evidence.bins > self.evidence.bins
        if self.label == UNKNOWN or weightier:
            self.label, self.confidence = other.label, other.confidence
            self.scores = other.scores
        self.start, self.end = min(self.start, other.start), max(self.end, other.end)
        self.evidence = self.evidence + other.evidence
        self.way.update(other.way)
        self.nodes += other.nodes

    def to_area(self) -> Area:
        """Return the area as it stands, for a map."""
        return Area(
            id=self.number,
            label=self.label,
            confidence=self.confidence,
            scores=dict(self.scores),
            start=self.start,
            end=self.end,
            trajectory=tuple(self.way.values()),
        )


class Areas:
    """All areas, the nodes of each, and the evidence stored at the nodes.

    Parameters
    ----------
    prior_bins : float
        What a node has stored counts as at most this many bins when more is added.
    """

    def __init__(self, prior_bins: float = 20.0) -> None:
        self.prior_bins = prior_bins
        self.records: dict[int, AreaRecord] = {}
        self.area_of: dict[int, int] = {}
        self._priors: dict[int, BinSums] = {}
        self._made = 0

    def begin(self, stamp: int) -> AreaRecord:
        """Make a new, empty area."""
        record = AreaRecord(self._made, start=stamp, end=stamp)
        self.records[record.number] = record
        self._made += 1
        return record

    def assign(self, node: int, area: int) -> None:
        """Say that a new node belongs to an area."""
        self.area_of[node] = area
        self.records[area].nodes.append(node)

    def store(self, node: int, sums: BinSums) -> None:
        """Add what was seen at a node to what is stored there, and to its area's evidence."""
        before = self._priors.get(node, BinSums())
        after = before.limited(self.prior_bins) + sums
        self._priors[node] = after
        record = self.records[self.area_of[node]]
        record.evidence = record.evidence - before + after

    def merge(self, one: int, other: int) -> AreaRecord:
        """Join two areas under the smaller number."""
        kept = self.records[min(one, other)]
        gone = self.records.pop(max(one, other))
        self.area_of.update(dict.fromkeys(gone.nodes, kept.number))
        kept.absorb(gone)
        return kept

    def to_areas(self) -> tuple[Area, ...]:
        """Return all areas as they stand, by number."""
        return tuple(self.records[number].to_area() for number in sorted(self.records))
