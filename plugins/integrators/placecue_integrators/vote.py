"""The majority vote of the cues."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from placecue import Evidence, Layout, Scores, UsageError, check_number, choices
from placecue_integrators.agreement import common_classes
from placecue_integrators.fixed_rule import FixedRule, told
from placecue_integrators.votes import Votes

Mask = NDArray[np.bool_]


class Vote(FixedRule):
    """Every cue that is there votes for the class that its own rule picks; the most votes win.

    With w_t the weight of cue t, class k has the share sum_t w_t [k is the first choice of t] /
    sum_t w_t of the votes. Ties go to the class that stands higher in the rankings of all cues
    (:class:`Votes`). Cues may have scores of any layout.

    Parameters
    ----------
    weights : mapping of str to float, optional
        What the vote of a cue counts, by its name; 1 for those left out. A cue that counts 0 is
        not extracted.

    Attributes
    ----------
    weights_ : dict of str to float
        What the vote of each cue counts.

    References
    ----------
    Kittler, Hatef, Duin and Matas, On combining classifiers, PAMI 20(3), 1998, section 3.4
    (majority vote rule); the weights and the tie-break, Borda's count, are our choice.
    """

    def __init__(self, weights: Mapping[str, float] | None = None) -> None:
        self.weights = weights

    def check_parameters(self) -> None:  # noqa: D102
        if self.weights is not None and not isinstance(self.weights, Mapping):
            raise UsageError(
                f"weights of votes must map cues to numbers, such as {{crfh: 2}}, got "
                f"{self.weights!r}"
            )
        for cue, weight in (self.weights or {}).items():
            check_number(f"weights.{cue}", weight, least=0, below=np.inf)

    def check_cues(self, cues: Sequence[str]) -> None:
        """Raise UsageError if a weight is of none of these cues, or all of them count 0."""
        given = self.weights or {}
        for name in given:
            if name not in cues:
                raise UsageError(f"weights of votes name cue '{name}'; {choices(name, cues)}")
        if not any(given.get(cue, 1) for cue in cues):
            raise UsageError(
                f"the votes of all cues ({', '.join(cues)}) count 0: give one of them a weight "
                "above 0"
            )

    def integrate(self, evidence: Evidence) -> Scores:
        """Return shares of votes and rank points, shape (n, 2 M), in the layout :class:`Votes`."""
        here = self._here(evidence)
        layout = Votes(common_classes(evidence, here))
        counting = {cue: self.weights_[cue] for cue in here if self.weights_[cue] > 0}
        if not counting:
            return Scores(np.full((len(evidence), len(layout.columns)), np.nan), layout)
        scores = [evidence.scores(cue) for cue in counting]
        there = np.stack([each.available() for each in scores])
        # Where each class stands in the ranking of each cue, 0 for first, shape (T, n, M).
        place = _rankings(scores, there, len(layout.classes)).argsort(axis=2)
        weights = np.array(list(counting.values()))[:, None] * there
        total = weights.sum(axis=0)
        votes = np.einsum("tn,tnm->nm", weights, place == 0)
        points = np.einsum("tn,tnm->nm", weights, 1 - place / (len(layout.classes) - 1))
        shares = np.hstack([votes, points]) / np.where(total > 0, total, 1)[:, None]
        return Scores(told(shares, total > 0), layout)

    def _learn(self, evidence: Evidence, codes: NDArray[np.int64]) -> None:
        self.check_cues(self.cues_)
        given = self.weights or {}
        self.weights_ = {cue: float(given.get(cue, 1)) for cue in self.cues_}


def _rankings(scores: Sequence[Scores], there: Mask, m: int) -> NDArray[np.int64]:
    """Return each cue's ranking of the classes, shape (T, n, M); anything where it is missing."""
    rankings = np.zeros((*there.shape, m), dtype=np.int64)
    for layout, numbers in _alike(scores):
        # Cues of one layout decide together: for one sample a call costs more than its sums.
        values = np.concatenate([scores[t].values[there[t]] for t in numbers])
        if len(values) == 0:
            continue
        decided, start = Scores(values, layout).decide().ranking, 0
        for t in numbers:
            end = start + int(np.count_nonzero(there[t]))
            rankings[t, there[t]] = decided[start:end]
            start = end
    return rankings


def _alike(scores: Sequence[Scores]) -> list[tuple[Layout, list[int]]]:
    """Return the numbers of the cues of each layout."""
    groups: list[tuple[Layout, list[int]]] = []
    for number, each in enumerate(scores):
        same = next((numbers for layout, numbers in groups if layout == each.layout), None)
        if same is None:
            groups.append((each.layout, [number]))
        else:
            same.append(number)
    return groups
