"""Confidence-based integration: a further cue only where those so far are not sure enough."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue import (
    DataError,
    Evidence,
    HeldOut,
    Integrator,
    Rows,
    Schemes,
    Scores,
    UsageError,
    check_number,
    choices,
    clone,
    sets_of,
)
from placecue_integrators.stages import ALWAYS, Stages, balanced

Cues = tuple[str, ...]
#: So many points of the curve of accuracy over cost.
POINTS = 40

log = logging.getLogger(__name__)


class Confidence(Integrator):
    """Integrates cues one after the other, until the decision is sure enough.

    Decides on the first cue; where the confidence of that is below a threshold the next cue is
    asked, all so far are integrated, and so on. A cue that is not asked is not extracted. There is
    a scheme of integration for every set of cues, and thresholds for every set that may be there.

    Thresholds are found on out-of-fold scores of the schemes: the smallest that keep the highest
    recognition rate (balanced accuracy), or a wanted one, or the best for a budget.

    Parameters
    ----------
    integrator : Integrator
        Joins the cues so far, such as G-DAS or SVM-DAS.
    order : list of str, optional
        The cues in the order in which they are asked; by default the cheapest first, as measured
        in training, or as they stand where nothing was measured.
    accuracy : float, optional
        Keep this balanced accuracy, in (0, 1], rather than the highest.
    budget : float, optional
        Spend no more than this in the mean, ms a sample, on the samples that it is fitted on.

    Attributes
    ----------
    cues_ : list of str
        The cues in the order in which they are asked.
    costs_ : dict of str to float
        What each cue takes, ms a sample; 1 where that was not measured.
    sets_ : list of list of str
        The sets of cues that there are thresholds for.
    fitted_sets_ : list of list of str
        Those that there is a scheme of integration for.
    schemes_ : list of Integrator
        The scheme of each of these.
    layout_ : Layout or None
        That of the integrated scores, in which a cue alone is told.
    thresholds_ : ndarray of float64, shape (sets, cues - 1)
        For each set the confidence that is enough after the first, second ... of its cues; NaN
        beyond its last but one.
    trade_off_ : dict of str to list
        A curve over thresholds, on out-of-fold scores with all cues there: ``cost`` (ms a sample),
        ``balanced_accuracy``, ``used CUE`` (share of the samples), and ``chosen`` (bool).

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 4.3; Pronobis and Caputo, Confidence-based cue
    integration for visual place recognition, IROS 2007. Thresholds from out-of-fold scores, one
    after the other from the last back, are our choice.
    """

    gaps = True
    wants_costs = True
    stops_early = True

    def __init__(
        self,
        integrator: Integrator | None = None,
        order: list[str] | None = None,
        accuracy: float | None = None,
        budget: float | None = None,
    ) -> None:
        self.integrator = integrator
        self.order = order
        self.accuracy = accuracy
        self.budget = budget

    def check_parameters(self) -> None:
        """Raise UsageError if a parameter cannot be what it is."""
        if self.accuracy is not None:
            check_number("confidence accuracy", self.accuracy, above=0, most=1)
        if self.budget is not None:
            check_number("confidence budget", self.budget, above=0)
        if isinstance(self.integrator, Confidence):
            raise UsageError(
                "confidence cannot stand inside itself: give it an integrator that joins cues, "
                "such as gdas"
            )
        if self.accuracy is not None and self.budget is not None:
            raise UsageError("confidence takes an accuracy or a budget, not both: leave one out")

    def check_cues(self, cues: Sequence[str]) -> None:
        """Raise UsageError if the order is not of the cues."""
        if self.integrator is not None:
            self.integrator.check_cues(cues)
        if self.order is None:
            return
        for cue in self.order:
            if cue not in cues:
                raise UsageError(f"confidence order names '{cue}'; {choices(str(cue), cues)}")
        if sorted(self.order) != sorted(cues):
            raise UsageError(
                f"confidence order must name each of the cues once ({', '.join(cues)}), got "
                f"{', '.join(self.order)}"
            )

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Learn from scores that the single-cue models have not been trained on.

        See :meth:`placecue.Integrator.fit`.
        """
        times = None if stamps is None else np.asarray(stamps)
        return self.train(HeldOut(evidence, np.asarray(labels), times))

    def train(self, held_out: HeldOut) -> Self:
        """Fit a scheme for every set of cues, and find thresholds.

        Where ``held_out.whole``, for those sets alone that are asked when no cue is missing.

        Raises
        ------
        UsageError
            If a parameter cannot be what it is, or the order is not of the cues.
        DataError
            If no sample has all cues.
        """
        self.check_parameters()
        if self.integrator is None:
            raise UsageError("confidence needs an integrator, such as integrator={plugin: gdas}")
        self._order(held_out)
        ordered = held_out.only(self.cues_)
        stages = [tuple(self.cues_[:n]) for n in range(len(self.cues_), 0, -1)]
        sets = stages if held_out.whole else sets_of(self.cues_, stages)
        base = clone(self.integrator)
        schemes = Schemes.fit(base, ordered, sets)
        # Of many cues there are not all sets; a set needs schemes for its own beginnings.
        staged = [s for s in sets if all(s[:n] in sets for n in range(1, len(s)))]
        self.sets_ = [list(cues) for cues in staged]
        self.fitted_sets_ = [list(cues) for cues in schemes.by_cues]
        self.schemes_ = list(schemes.by_cues.values())
        self.layout_ = schemes.layout
        unseen = self._out_of_fold(ordered, base, sets)
        self.thresholds_ = np.full((len(staged), max(len(self.cues_) - 1, 1)), np.nan)
        for row, cues in enumerate(staged):
            decided = self._stages(unseen, ordered.labels, cues)
            found = self._thresholds(decided, full=row == 0)
            self.thresholds_[row, : len(found)] = found
            if row == 0:
                self.trade_off_ = _trade_off(decided, cues, found)
        return self

    def summary(self) -> str:
        """Return for which share of the samples each cue is used, and what that costs."""
        curve = self.trade_off_
        at = curve["chosen"].index(True)
        told = ", ".join(
            f"{cue} ({self.costs_[cue]:.3g} ms) {100 * curve[f'used {cue}'][at]:.0f} %"
            for cue in self.cues_
        )
        return (
            f"cues used for {told}; {curve['cost'][at]:.3g} ms a sample, where all take "
            f"{sum(self.costs_.values()):.3g}; {100 * curve['balanced_accuracy'][at]:.1f} % on "
            "held-out samples"
        )

    # ------------------------------------------------------------------ training

    def _order(self, held_out: HeldOut) -> None:
        cues, costs = held_out.evidence.cues, held_out.costs
        if costs is None and self.budget is not None:
            raise UsageError("confidence needs measured costs for a budget: give HeldOut its costs")
        self.costs_ = {cue: 1.0 if costs is None else float(costs[cue]) for cue in cues}
        self.check_cues(cues)
        cheapest = sorted(cues, key=lambda cue: self.costs_[cue])
        self.cues_ = cheapest if self.order is None else list(self.order)

    def _out_of_fold(
        self, held_out: HeldOut, fitted: Integrator, sets: Sequence[Cues]
    ) -> dict[Cues, Scores]:
        """Return the scores by the scheme of each set, fitted on other folds; NaN where none."""
        every: dict[Cues, Scores] = {}
        for rows, unseen in held_out.split():
            copies = Schemes.fit(fitted.best(), held_out.take(rows), sets)
            part = held_out.take(unseen).evidence
            for cues in sets:
                scores, _ = copies.integrate(part.only(cues))
                there = part.only(cues).known().all(axis=1)
                whole = every.setdefault(cues, scores[:0].spread(unseen[:0], len(held_out)))
                whole.values[unseen[there]] = scores.values[there]
        return every

    def _stages(self, unseen: dict[Cues, Scores], labels: NDArray[np.str_], cues: Cues) -> Stages:
        """Return what is decided after each of some cues, of the samples that have them all."""
        steps = [unseen[cues[: n + 1]] for n in range(len(cues))]
        rows = np.flatnonzero(np.logical_and.reduce([each.available() for each in steps]))
        if not rows.size:
            raise DataError(f"no sample has held-out scores of all cues ({', '.join(cues)})")
        decided = [each[rows].decide() for each in steps]
        return Stages(
            right=np.array([each.labels == labels[rows] for each in decided]),
            confidence=np.array([each.confidence for each in decided]),
            weights=balanced(labels[rows]),
            costs=[self.costs_[cue] for cue in cues],
        )

    def _thresholds(self, stages: Stages, *, full: bool) -> list[float]:
        best = stages.rate([np.inf] * (len(stages.costs) - 1))
        if self.budget is not None:
            return self._within(stages, best, full=full)
        if self.accuracy is None:
            return stages.thresholds()
        if full and self.accuracy > best:
            log.warning(
                f"confidence accuracy is {self.accuracy:g}, and all cues together reach "
                f"{best:.3f} on held-out scores: that is kept"
            )
        return stages.thresholds(min(self.accuracy, best))

    def _within(self, stages: Stages, best: float, *, full: bool) -> list[float]:
        """Return the thresholds of the highest rate that the budget allows."""
        assert self.budget is not None
        if full and stages.costs[0] > self.budget:
            raise UsageError(
                f"confidence budget is {self.budget:g} ms a sample, and the first cue alone takes "
                f"{stages.costs[0]:.3g}: give more"
            )
        for rate in _rates(stages, best):
            found = stages.thresholds(rate)
            if stages.cost(found) <= self.budget:
                return found
        return [ALWAYS] * (len(stages.costs) - 1)

    # ------------------------------------------------------------------ integration

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the scores of the cues that it took to be sure; NaN where no cue is there."""
        by_cues = zip(map(tuple, self.fitted_sets_), self.schemes_, strict=True)
        schemes = Schemes(dict(by_cues), self.layout_)
        found: list[tuple[Rows, Scores]] = []
        pending = list(self._parted(evidence))
        while pending:
            rows, asked, rest = pending.pop()
            part = _part(evidence, rows)
            has = part.scores(rest[0]).available()
            if not has.all():  # unusable after all
                pending += self._without(rows[~has], asked, rest[1:], evidence, schemes, found)
                rows = rows[has]
            if rows.size:
                asked, rest = (*asked, rest[0]), rest[1:]
                scores = _joined(schemes, evidence, rows, asked)
                sure = self._sure(scores, asked, rest)
                if sure.any():
                    found.append((rows[sure], scores[sure]))
                if not sure.all():
                    pending.append((rows[~sure], asked, rest))
        return _placed(found, evidence)

    def _parted(self, evidence: Evidence) -> Iterator[tuple[Rows, Cues, Cues]]:
        """Yield observations that have the same cues, with these, in order."""
        known = np.stack([evidence.available(cue) for cue in self.cues_], axis=1)
        alike = bool((known == known[:1]).all())  # as nearly always
        for pattern in known[:1] if alike else np.unique(known, axis=0):
            there = tuple(cue for cue, has in zip(self.cues_, pattern, strict=True) if has)
            if there:
                yield np.flatnonzero((known == pattern).all(axis=1)), (), there

    def _without(
        self,
        rows: Rows,
        asked: Cues,
        rest: Cues,
        evidence: Evidence,
        schemes: Schemes,
        found: list[tuple[Rows, Scores]],
    ) -> list[tuple[Rows, Cues, Cues]]:
        """Go on without a cue; decide on those that were asked where it was the last."""
        if rest:
            return [(rows, asked, rest)]
        if asked:
            found.append((rows, _joined(schemes, evidence, rows, asked)))
        return []

    def _sure(self, scores: Scores, asked: Cues, rest: Cues) -> NDArray[np.bool_]:
        """Tell where a decision is sure enough; the last always is."""
        there = scores.available()
        if not rest:
            return np.ones(len(there), dtype=bool)
        threshold = self._threshold((*asked, *rest), len(asked))
        sure = np.zeros(len(there), dtype=bool)
        if there.any():
            some = scores if there.all() else scores[there]
            sure[there] = some.decide().confidence >= threshold
        return sure

    def _threshold(self, cues: Cues, asked: int) -> float:
        """Return the confidence that is enough after so many of the given cues."""
        if list(cues) in self.sets_:
            return float(self.thresholds_[self.sets_.index(list(cues)), asked - 1])
        # Of a set without a scheme: as if all were there.
        return float(self.thresholds_[0, asked - 1])


def _joined(schemes: Schemes, evidence: Evidence, rows: Rows, cues: Cues) -> Scores:
    return schemes.join(_part(evidence, rows).only(cues))


def _part(evidence: Evidence, rows: Rows) -> Evidence:
    return evidence if len(rows) == len(evidence) else evidence.take(rows)


def _placed(found: Sequence[tuple[Rows, Scores]], evidence: Evidence) -> Scores:
    if not found:
        layout = evidence.layout(evidence.cues[0])
        return Scores(np.full((len(evidence), len(layout.columns)), np.nan), layout)
    first = found[0][1]
    values = np.full((len(evidence), first.values.shape[1]), np.nan)
    for rows, scores in found:
        values[rows] = scores.values
    return Scores(values, first.layout)


def _rates(stages: Stages, best: float) -> NDArray[np.float64]:
    """Return rates from that of all cues down to that of the first alone."""
    first = stages.rate([ALWAYS] * (len(stages.costs) - 1))
    return np.linspace(best, min(first, best), POINTS)


def _worth(
    stages: Stages, points: Sequence[Sequence[float]], chosen: Sequence[float]
) -> list[list[float]]:
    """Return the points that no cheaper one is as good as, those of all cues and the chosen."""
    kept: list[list[float]] = []
    best = -1.0
    never = [np.inf] * len(chosen)
    for each in sorted(map(list, points), key=lambda p: (stages.cost(p), -stages.rate(p))):
        better = stages.rate(each) > best + 1e-12
        if (better or each in (never, list(chosen))) and each not in kept:
            kept.append(each)
        best = max(best, stages.rate(each))
    same = [k for k in kept if k != list(chosen) and stages.cost(k) == stages.cost(chosen)]
    return [each for each in kept if each not in same]


def _trade_off(stages: Stages, cues: Cues, chosen: Sequence[float]) -> dict[str, list[Any]]:
    """Return the curve of accuracy over cost, with the chosen thresholds among its points."""
    never = [np.inf] * (len(cues) - 1)
    points = [stages.thresholds(rate) for rate in _rates(stages, stages.rate(never))]
    points = [never, *points, list(chosen), [ALWAYS] * (len(cues) - 1)]
    worth = _worth(stages, points, chosen)
    unique = sorted(worth, key=stages.cost)
    shares = [stages.shares(each) for each in unique]
    return {
        "cost": [stages.cost(each) for each in unique],
        "balanced_accuracy": [stages.rate(each) for each in unique],
        **{f"used {cue}": [float(s[n]) for s in shares] for n, cue in enumerate(cues)},
        "chosen": [each == list(chosen) for each in unique],
    }
