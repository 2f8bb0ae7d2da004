"""Areas of a log without poses: windows of time."""

from __future__ import annotations

from placecue.accumulator import AreaUpdate
from placecue.semantic_map import SemanticMap
from placecue_accumulators.areas import AreaRecord
from placecue_accumulators.histogram import BinSums, Values, ViewpointHistogram
from placecue_accumulators.judging import Judge, Judgement

#: Length of a window, and of the moments that are averaged within it, ns.
WINDOW, MOMENT = 10_000_000_000, 1_000_000_000


class TimeWindows:
    """Gathers beliefs over windows of 10 s; consecutive ones of one label are one area.

    Within a second beliefs are averaged; over seconds they are summed.
    """

    def __init__(self) -> None:
        self.done: list[AreaRecord] = []
        self._open: AreaRecord | None = None
        self._seen = ViewpointHistogram(None)

    def __bool__(self) -> bool:
        return bool(self.done) or self._open is not None

    def add(self, stamp: int, values: Values, judge: Judge) -> AreaUpdate | None:
        """Take in the scores of a belief; return the area of a window that has just ended."""
        ended = None
        if self._open is not None and not 0 <= stamp - self._open.start < WINDOW:
            ended = self._close(judge)
        if self._open is None:
            self._open = AreaRecord(0, start=stamp, end=stamp)
        self._seen.add(((stamp - self._open.start) // MOMENT,), values)
        self._open.end = stamp
        return ended

    def semantic_map(self, judge: Judge) -> SemanticMap:
        """Return the areas so far; they have times, and no places."""
        records = [*self.done]
        if self._open is not None:
            records = self._with(self._open, self._seen.sums(), judge)
        return SemanticMap(
            areas=tuple(record.to_area() for record in records),
            nodes=(),
            edges=(),
            classes=judge.layout.classes,
        )

    def _close(self, judge: Judge) -> AreaUpdate | None:
        assert self._open is not None
        self.done = self._with(self._open, self._seen.sums(), judge)
        self._open = None
        self._seen.clear()
        last = self.done[-1]
        return AreaUpdate(last.number, last.judged.label, last.judged.probability, finished=True)

    def _with(self, window: AreaRecord, sums: BinSums, judge: Judge) -> list[AreaRecord]:
        """Return the areas with one more window: part of the last, or a new one."""
        made = AreaRecord(len(self.done), window.start, window.end, evidence=sums)
        made.judge(sums, judge)
        last = self.done[-1] if self.done else None
        if last is None or last.judged.label != made.judged.label:
            return [*self.done, made]
        joined = AreaRecord(last.number, last.start, window.end, judged=Judgement())
        joined.evidence = last.evidence + sums
        joined.judge(joined.evidence, judge)
        return [*self.done[:-1], joined]
