"""An integrator."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue import Classifier, Evidence, Integrator, Rows, Scores, UsageError, clone


class Stacked(Integrator):
    """A classifier on the scores of all cues, one after the other."""

    def __init__(self, classifier: Classifier | None = None) -> None:
        self.classifier = classifier

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Learn from scores that the single-cue models have not been trained on."""
        if self.classifier is None:
            raise UsageError("stacked needs a classifier, such as classifier={plugin: similar}")
        self.classifier_ = clone(self.classifier)
        self.classifier_.fit(self._joined(evidence, None), labels, stamps)
        return self

    def integrate(self, evidence: Evidence, rows: Rows | None = None) -> Scores:
        """Return the classifier's scores."""
        return self.classifier_.scores(self._joined(evidence, rows))

    def _joined(self, evidence: Evidence, rows: Rows | None) -> NDArray[np.float64]:
        joined = np.hstack([evidence.scores(cue).values for cue in evidence.cues])
        return joined if rows is None else joined[rows]
