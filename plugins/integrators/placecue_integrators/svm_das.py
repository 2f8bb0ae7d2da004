"""SVM-DAS: a support vector machine on the outputs of all cues."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.classifier import Classifier
from placecue.errors import DataError, UsageError
from placecue.estimator import clone
from placecue.evidence import Evidence
from placecue.folds import Rows
from placecue.held_out import HeldOut
from placecue.integrator import Integrator
from placecue.scaling import RangeScaling
from placecue.scores import Scores
from placecue.training_set import TrainingSet


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
        times = None if stamps is None else np.asarray(stamps)
        return self.train(HeldOut(evidence, np.asarray(labels), times))

    def train(self, held_out: HeldOut) -> Self:
        """Learn from held-out evidence; samples that lack a cue are left out.

        Raises
        ------
        UsageError
            If there is no classifier.
        DataError
            If no sample has scores of every cue.
        """
        if self.classifier is None:
            raise UsageError("svm_das needs a classifier, such as classifier={plugin: svm}")
        self.cues_ = list(held_out.evidence.cues)
        joined, rows = self._joined(held_out.evidence)
        if rows.size == 0:
            raise DataError(f"no sample has scores of all cues ({', '.join(self.cues_)})")
        complete = held_out.take(rows)
        self.scaling_ = RangeScaling().fit(joined)
        training = TrainingSet(
            self.scaling_.transform(joined),
            complete.labels,
            complete.stamps,
            complete.groups,
            folds=complete.folds,
            part=complete.part,
        )
        self.classifier_ = clone(self.classifier)
        self.classifier_.train(training)
        return self

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the classifier's outputs on the joined scores, in its own layout.

        NaN for observations that lack a cue.
        """
        joined, rows = self._joined(evidence)
        layout = self.classifier_.layout_
        values = np.full((len(evidence), len(layout.columns)), np.nan)
        if rows.size:
            values[rows] = self.classifier_.scores(self.scaling_.transform(joined)).values
        return Scores(values, layout)

    def best(self) -> SVMDAS:
        """Return an unfitted copy with the parameters that the classifier's search found."""
        copy: SVMDAS = clone(self)
        return copy.set_params(classifier=self.classifier_.best())

    def _joined(self, evidence: Evidence) -> tuple[NDArray[np.float64], Rows]:
        """Return the outputs of all cues, shape (k, V), and which observations have them."""
        joined = np.hstack([evidence.scores(cue).values for cue in self.cues_])
        rows = np.flatnonzero(~np.isnan(joined).any(axis=1))
        return joined[rows], rows
