"""A classifier on the joined outputs of all cues: what SVM-DAS and stacking have in common."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.classifier import Classifier
from placecue.errors import DataError, UsageError
from placecue.estimator import clone
from placecue.evidence import Evidence
from placecue.folds import Rows
from placecue.held_out import HeldOut
from placecue.integrator import Integrator
from placecue.scaling import Scaling
from placecue.scores import Scores
from placecue.training_set import TrainingSet
from placecue_integrators.agreement import check_layouts


class JoinedScores(Integrator):
    """Joins the outputs of all cues into one vector, on which a classifier decides.

    Cues may have outputs of any layout, and of different classes.

    Parameters
    ----------
    classifier : Classifier
        Decides on the joined outputs.

    Attributes
    ----------
    cues_ : list of str
        The cues, in the order in which their outputs are joined.
    layouts_ : list of Layout
        Those of the outputs.
    scaling_ : Scaling or None
        Learned on the joined outputs of the fitting data.
    classifier_ : Classifier
        The fitted classifier.
    """

    #: How the outputs are scaled before they reach the classifier.
    scaled_by: ClassVar[type[Scaling] | None] = None
    #: What to say where there is no classifier.
    needs: ClassVar[str]

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
            If no sample has scores of every cue, or none of those that do is of a class that the
            cues tell apart.
        """
        if self.classifier is None:
            raise UsageError(self.needs)
        self.cues_ = list(held_out.evidence.cues)
        self.layouts_ = [held_out.evidence.layout(cue) for cue in self.cues_]
        joined, rows = self._joined(held_out.evidence)
        if rows.size == 0:
            raise DataError(f"no sample has scores of all cues ({', '.join(self.cues_)})")
        complete = held_out.take(rows)
        self._check_classes(complete)
        self.scaling_ = None if self.scaled_by is None else self.scaled_by().fit(joined)
        training = TrainingSet(
            self._scaled(joined),
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
        check_layouts(evidence, self.cues_, self.layouts_)
        joined, rows = self._joined(evidence)
        layout = self.classifier_.layout_
        values = np.full((len(evidence), len(layout.columns)), np.nan)
        if rows.size:
            values[rows] = self.classifier_.scores(self._scaled(joined)).values
        return Scores(values, layout)

    def best(self) -> Self:
        """Return an unfitted copy with the parameters that the classifier's search found."""
        copy: Self = clone(self)
        copy.set_params(classifier=self.classifier_.best())
        return copy

    def _check_classes(self, complete: HeldOut) -> None:
        """Raise DataError if a class of any cue is missing: it would never be named."""
        known = {name for layout in self.layouts_ for name in layout.classes}
        foreign = sorted(set(map(str, complete.labels)) - known)
        if foreign:
            raise DataError(
                f"there are held-out samples of '{foreign[0]}', which no cue tells apart: leave "
                "them out"
            )
        missing = sorted(known - set(map(str, complete.labels)))
        if missing:
            raise DataError(
                f"no sample of {', '.join(missing)} has scores of all cues "
                f"({', '.join(self.cues_)}), so it would never be named: give some of every class"
            )

    def _scaled(self, joined: NDArray[np.float64]) -> NDArray[np.float64]:
        return joined if self.scaling_ is None else self.scaling_.transform(joined)

    def _joined(self, evidence: Evidence) -> tuple[NDArray[np.float64], Rows]:
        """Return the outputs of all cues, shape (k, V), and which observations have them."""
        joined = np.hstack([evidence.scores(cue).values for cue in self.cues_])
        rows = np.flatnonzero(~np.isnan(joined).any(axis=1))
        return joined[rows], rows
