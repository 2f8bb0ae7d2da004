"""SVM-DAS: a support vector machine on the outputs of all cues."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone

from placecue.classifier import Classifier
from placecue.errors import UsageError
from placecue.evidence import Evidence
from placecue.folds import Rows
from placecue.integrator import Integrator
from placecue.scaling import RangeScaling
from placecue.scores import Scores


class SVMDAS(Integrator):
    """Discriminative accumulation by a support vector machine.

    The outputs of all cues, each scaled to [-1, 1] by its range on the fitting data, are joined
    into one vector, and a classifier learns to decide on it. Cues may have outputs of any layout.

    Parameters
    ----------
    classifier : Classifier
        Decides on the joined outputs; in the paper a one-against-one SVM with a linear, RBF or
        histogram-intersection kernel.

    Attributes
    ----------
    cues_ : list of str
        The cues, in the order in which their outputs are joined.
    scaling_ : RangeScaling
        Range of each output on the fitting data.
    classifier_ : Classifier
        The fitted classifier.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 4.2.
    """

    def __init__(self, classifier: Classifier | None = None) -> None:
        self.classifier = classifier

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Learn from scores that the single-cue models have not been trained on.

        See :meth:`placecue.integrator.Integrator.fit`.
        """
        if self.classifier is None:
            raise UsageError("svm_das needs a classifier, such as classifier={plugin: svm}")
        self.cues_ = list(evidence.cues)
        joined = self._joined(evidence)
        self.scaling_ = RangeScaling().fit(joined)
        self.classifier_ = clone(self.classifier)
        self.classifier_.fit(self.scaling_.transform(joined), labels, stamps)
        return self

    def integrate(self, evidence: Evidence, rows: Rows | None = None) -> Scores:
        """Return the classifier's outputs on the joined scores, in its own layout."""
        joined = self.scaling_.transform(self._joined(evidence, rows))
        scores: Scores = self.classifier_.scores(joined)
        return scores

    def chosen(self) -> Self:
        """Return an unfitted copy whose classifier has the parameters that its search found."""
        copy: Self = super().chosen()
        return copy.set_params(classifier=self.classifier_.chosen())  # type: ignore[no-any-return]

    def _joined(self, evidence: Evidence, rows: Rows | None = None) -> NDArray[np.float64]:
        return np.hstack([evidence.scores(cue, rows).values for cue in self.cues_])
