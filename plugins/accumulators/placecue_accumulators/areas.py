"""The areas found so far, and which nodes of the navigation graph belong to each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from placecue.semantic_map import UNKNOWN, Area
from placecue_accumulators.histogram import BinSums, Key
from placecue_accumulators.judging import Judge, Judgement

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
    frame : str
        The frame of its positions.
    judged : Judgement
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
    frame: str = "odom"
    judged: Judgement = field(default_factory=Judgement)
    evidence: BinSums = field(default_factory=BinSums)
    way: Way = field(default_factory=dict)
    nodes: list[int] = field(default_factory=list)

    def judge(self, sums: BinSums, judge: Judge) -> bool:
        """Judge accumulated scores; a label once given stays until another one is sure enough.

        Its probability is told as it is, so that a label in doubt is seen to be.

        Parameters
        ----------
        sums : BinSums
            Scores summed over bins; at least one bin.
        judge : Judge
            How.

        Returns
        -------
        bool
            Whether the label changed.
        """
        made, before = judge.judge(sums), self.judged.label
        if made.label == UNKNOWN != before:
            made = replace(made, label=before, probability=made.probabilities[before])
        self.judged = made
        return made.label != before

    def absorb(self, other: AreaRecord) -> None:
        """Take over the nodes, way and evidence of another area, and its label if weightier."""
        weightier = other.judged.label != UNKNOWN and other.evidence.bins > self.evidence.bins
        if self.judged.label == UNKNOWN or weightier:
            self.judged = other.judged
        self.start, self.end = min(self.start, other.start), max(self.end, other.end)
        self.evidence = self.evidence + other.evidence
        self.way.update(other.way)
        self.nodes += other.nodes

    def to_area(self) -> Area:
        """Return the area as it stands, for a map."""
        return Area(
            id=self.number,
            label=self.judged.label,
            confidence=self.judged.probability,
            margin=self.judged.margin,
            probabilities=dict(self.judged.probabilities),
            scores=dict(self.judged.scores),
            start=self.start,
            end=self.end,
            frame=self.frame,
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
        self.priors: dict[int, BinSums] = {}
        self._made = 0

    def begin(self, stamp: int, frame: str = "odom") -> AreaRecord:
        """Make a new, empty area."""
        record = AreaRecord(self._made, start=stamp, end=stamp, frame=frame)
        self.records[record.number] = record
        self._made += 1
        return record

    def assign(self, node: int, area: int) -> None:
        """Say that a new node belongs to an area."""
        self.area_of[node] = area
        self.records[area].nodes.append(node)

    def store(self, node: int, sums: BinSums) -> None:
        """Add what was seen at a node to what is stored there, and to its area's evidence."""
        before = self.priors.get(node, BinSums())
        after = before.limited(self.prior_bins) + sums
        self.priors[node] = after
        record = self.records[self.area_of[node]]
        record.evidence = record.evidence - before + after

    def move(self, nodes: Iterable[int], to: AreaRecord) -> None:
        """Take nodes, and what is stored there, from their areas into another."""
        for node in nodes:
            left, prior = self.records[self.area_of[node]], self.priors.get(node, BinSums())
            left.nodes.remove(node)
            left.evidence = left.evidence - prior
            to.evidence = to.evidence + prior
            self.assign(node, to.number)

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
