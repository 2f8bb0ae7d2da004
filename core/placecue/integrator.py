"""An integrator: from the scores of all cues to one set of scores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Self

from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, clone

from placecue.errors import UsageError
from placecue.evidence import Evidence
from placecue.folds import Rows
from placecue.scores import Scores


class Integrator(BaseEstimator, ABC):  # type: ignore[misc]
    """Joins the cues' scores; a scikit-learn estimator over evidence.

    It is fitted on scores of samples that the single-cue models have not seen.

    Attributes
    ----------
    version : str
        Changes when the results do, so that a model does not meet another integrator unawares.
    """

    version: ClassVar[str] = "1"

    @abstractmethod
    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Learn how to join the cues.

        Parameters
        ----------
        evidence : Evidence
            Scores of n samples that the single-cue models were not trained on.
        labels : array of str, shape (n,)
            The classes of the samples.
        stamps : array of int, shape (n,), optional
            Their times, ns.
        """

    @abstractmethod
    def integrate(self, evidence: Evidence, rows: Rows | None = None) -> Scores:
        """Return the integrated scores of the given rows (all by default).

        Only the cues asked for through ``evidence.scores`` are extracted.
        """

    def chosen(self) -> Self:
        """Return an unfitted copy with what a parameter search found as fixed parameters.

        Decisions on held-out samples are made with it, so that a search runs once and not once a
        fold; see :meth:`placecue.classifier.Classifier.chosen`.
        """
        copy: Any = clone(self)
        return copy  # type: ignore[no-any-return]


class OnlyCue(Integrator):
    """Stands where there is one cue and nothing to integrate: passes its scores on."""

    def fit(  # noqa: D102
        self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        self._only(evidence)
        return self

    def integrate(self, evidence: Evidence, rows: Rows | None = None) -> Scores:  # noqa: D102
        return evidence.scores(self._only(evidence), rows)

    @staticmethod
    def _only(evidence: Evidence) -> str:
        if len(evidence.cues) != 1:
            raise UsageError(
                f"{len(evidence.cues)} cues ({', '.join(evidence.cues)}) and no integrator: "
                "choose one, such as integrator=svm_das"
            )
        return evidence.cues[0]
