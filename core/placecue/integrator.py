"""An integrator: from the scores of all cues to one set of scores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Self

from numpy.typing import ArrayLike

from placecue.errors import UsageError
from placecue.estimator import Estimator, clone
from placecue.evidence import Evidence
from placecue.held_out import HeldOut
from placecue.scores import Scores


class Integrator(Estimator, ABC):
    """Joins the cues' scores; a scikit-learn estimator over evidence.

    It is fitted on scores of samples that the single-cue models have not seen.

    Attributes
    ----------
    version : str
        Changes when the results do, so that a model does not meet another integrator unawares.
    gaps : bool
        Whether it copes itself where some samples lack a cue. If not, a copy of it is fitted for
        each set of cues, and sees only samples that have them all; see :class:`placecue.Schemes`.
    fits_alone : bool
        Whether a copy is fitted for each single cue, too; else a cue that is left alone is told in
        the layout of all as it is.
    wants_costs : bool
        Whether it is to be told what each cue costs (``held_out.costs``).
    stops_early : bool
        Whether it may leave cues unasked, so that none is to be extracted before it asks.
    trade_off_ : dict of str to list
        Of one that need not ask for all cues: a curve, for the training report. One entry a point
        in ``cost`` (ms a sample), ``balanced_accuracy``, ``used CUE`` (share of the samples) for
        each cue, and ``chosen`` (bool).
    """

    version: ClassVar[str] = "1"
    gaps: ClassVar[bool] = False
    fits_alone: ClassVar[bool] = False
    wants_costs: ClassVar[bool] = False
    stops_early: ClassVar[bool] = False

    def check_cues(self, cues: Sequence[str]) -> None:
        """Raise UsageError if a parameter names a cue that is not among these.

        A pipeline calls it with all of its cues before anything is trained; :meth:`fit` may be
        given the evidence of fewer. The default accepts all.
        """

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

    def train(self, held_out: HeldOut) -> Self:
        """Learn how to join the cues from held-out evidence; what a pipeline calls.

        Override it where :meth:`fit` needs more than evidence, labels and stamps: the groups of
        the samples, or how they are cut (``held_out.folds``). The default calls :meth:`fit`.
        """
        return self.fit(held_out.evidence, held_out.labels, held_out.stamps)

    @abstractmethod
    def integrate(self, evidence: Evidence) -> Scores:
        """Return the integrated scores of n observations, NaN for those that cannot be told.

        Only the cues asked for through ``evidence.scores`` are extracted; ``evidence.take`` asks
        for some of the observations only. The evidence may be of a cue or of all; scores are of
        one layout whichever it is.
        """

    def summary(self) -> str:
        """Return what it has learned in one line, for who trained it; empty by default."""
        return ""

    def unfitted(self) -> Self:
        """Return a copy that has learned nothing, with the same parameters."""
        copy: Self = clone(self)
        return copy

    def best(self) -> Integrator:
        """Return an unfitted copy with the parameters that its search found, where it searched.

        The default returns a copy that searches again.
        """
        return self.unfitted()


class OnlyCue(Integrator):
    """Stands where there is one cue and nothing to integrate: passes its scores on."""

    gaps = True

    def fit(  # noqa: D102
        self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        self._only(evidence)
        return self

    def integrate(self, evidence: Evidence) -> Scores:  # noqa: D102
        return evidence.scores(self._only(evidence))

    @staticmethod
    def _only(evidence: Evidence) -> str:
        if len(evidence.cues) != 1:
            raise UsageError(
                f"{len(evidence.cues)} cues ({', '.join(evidence.cues)}) and no integrator: "
                "choose one, such as integrator=svm_das"
            )
        return evidence.cues[0]
