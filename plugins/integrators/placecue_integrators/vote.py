"""The majority vote of the cues."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from placecue import Evidence, Layout, Rows, Scores, UsageError, check_number, choices
from placecue_integrators.agreement import common_classes
from placecue_integrators.fixed_rule import FixedRule, told
from placecue_integrators.votes import Votes


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
        layout = Votes(common_classes(evidence, self.cues_))
        n, m = len(evidence), len(layout.classes)
        votes, points, total = np.zeros((n, m)), np.zeros((n, m)), np.zeros((n, 1))
        steps = np.arange(m - 1, -1, -1) / (m - 1)
        for weight, rows, ranking in self._ballots(evidence):
            votes[rows, ranking[:, 0]] += weight
            points[rows[:, None], ranking] += weight * steps
            total[rows] += weight
        shares = np.hstack([votes, points]) / np.where(total > 0, total, 1)
        return Scores(told(shares, total[:, 0] > 0), layout)

    def _ballots(self, evidence: Evidence) -> Iterator[tuple[float, Rows, NDArray[np.int64]]]:
        """Yield the weight of each cue that counts, where it is there, and its rankings there."""
        counting = [cue for cue, weight in self.weights_.items() if weight > 0]
        scores = {cue: evidence.scores(cue) for cue in counting}
        # Cues of one layout decide together: for one sample a call costs more than its sums.
        for layout, cues in _alike({cue: each.layout for cue, each in scores.items()}):
            rows = [np.flatnonzero(scores[cue].available()) for cue in cues]
            there = [scores[cue].values[some] for cue, some in zip(cues, rows, strict=True)]
            ranking = Scores(np.concatenate(there), layout).decide().ranking
            ends = np.cumsum([len(some) for some in rows])
            for cue, some, of_cue in zip(cues, rows, np.split(ranking, ends[:-1]), strict=True):
                yield self.weights_[cue], some, of_cue

    def _learn(self, evidence: Evidence, codes: NDArray[np.int64]) -> None:
        self.check_cues(self.cues_)
        given = self.weights or {}
        self.weights_ = {cue: float(given.get(cue, 1)) for cue in self.cues_}


def _alike(layouts: Mapping[str, Layout]) -> list[tuple[Layout, list[str]]]:
    """Return the cues of each layout."""
    groups: list[tuple[Layout, list[str]]] = []
    for cue, layout in layouts.items():
        same = next((cues for other, cues in groups if other == layout), None)
        if same is None:
            groups.append((layout, [cue]))
        else:
            same.append(cue)
    return groups
