"""Rules over the cues' probabilities: mean, product and maximum."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray

from placecue import Evidence, Probabilities, Scores, UsageError, check_choice
from placecue_integrators.agreement import common_classes
from placecue_integrators.fixed_rule import FixedRule, told

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
PRIORS = ("equal", "training")


class ProbabilityRule(FixedRule):
    """A rule over the probabilities of the cues that are there; its rows sum to one.

    References
    ----------
    Kittler, Hatef, Duin and Matas, On combining classifiers, PAMI 20(3), 1998, sections 2 and 3.
    """

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the probabilities of n observations, shape (n, M)."""
        here = self._here(evidence)
        layout = Probabilities(common_classes(evidence, here))
        each = np.stack([evidence.scores(cue).values for cue in here])
        there = np.asarray(~np.isnan(each).any(axis=2))
        joined = self._joined(np.where(there[:, :, None], each, 0).clip(0), there)
        total = joined.sum(axis=1, keepdims=True)
        equal = np.full(joined.shape, 1 / len(layout.classes))
        shares = np.divide(joined, total, out=equal, where=total > 0)
        return Scores(told(shares, np.asarray(there.any(axis=0))), layout)

    @abstractmethod
    def _joined(self, each: Matrix, there: Mask) -> Matrix:
        """Return what each class is worth, at least 0, shape (n, M).

        Parameters
        ----------
        each : ndarray of float64, shape (T, n, M)
            The probabilities by each cue, 0 where it is missing.
        there : ndarray of bool, shape (T, n)
            Which cues are there.
        """

    def _learn(self, evidence: Evidence, codes: NDArray[np.int64]) -> None:
        for cue in self.cues_:
            layout = evidence.layout(cue)
            if not isinstance(layout, Probabilities):
                raise UsageError(
                    f"cue '{cue}' gives {layout.name} scores, and this integrator joins "
                    f"probabilities: set cues.{cue}.classifier.probability=sigmoid for an SVM, "
                    f"cues.{cue}.classifier.output=probability for AdaBoost, or choose an "
                    "integrator that takes any scores, such as integrator=vote"
                )


class MeanProbability(ProbabilityRule):
    """The mean of the probabilities: p(k) = sum_t p_t(k) / T over the T cues that are there.

    The sum rule of Kittler et al. under equal priors: the least sensitive to a cue that errs.
    """

    def _joined(self, each: Matrix, there: Mask) -> Matrix:
        return np.asarray(each.sum(axis=0) / np.maximum(there.sum(axis=0), 1)[:, None])


class MaxProbability(ProbabilityRule):
    """The largest of the probabilities: p(k) in proportion to max_t p_t(k).

    The max rule of Kittler et al. under equal priors: the surest cue decides.
    """

    def _joined(self, each: Matrix, there: Mask) -> Matrix:
        return np.asarray(each.max(axis=0))


class ProductProbability(ProbabilityRule):
    """The product of the probabilities: p(k) in proportion to prod_t p_t(k) / p(k)^(T - 1).

    The product rule of Kittler et al.: Bayes' rule for cues that are independent given the class.
    A class that a cue calls impossible (probability 0) is out. Where every class is, the classes
    that the fewest cues call impossible stay, with the product over the other cues: what the rule
    tends to where a vanishing probability stands in place of 0.

    Parameters
    ----------
    priors : {"equal", "training"}
        p(k): equal, so that nothing is divided by, as suits the balanced accuracy that
        classifiers are trained for; or the share of each class in the samples it is fitted on,
        (n_k + 1) / (n + M), so that none is 0.

    Attributes
    ----------
    priors_ : ndarray of float64, shape (M,)
        The p(k) in use.
    """

    def __init__(self, priors: str = "equal") -> None:
        self.priors = priors

    def check_parameters(self) -> None:  # noqa: D102
        check_choice("priors", self.priors, PRIORS)

    def _learn(self, evidence: Evidence, codes: NDArray[np.int64]) -> None:
        super()._learn(evidence, codes)
        m = len(evidence.layout(self.cues_[0]).classes)
        counts = np.bincount(codes, minlength=m) if self.priors == "training" else np.zeros(m)
        self.priors_ = (counts + 1) / (counts.sum() + m)

    def _joined(self, each: Matrix, there: Mask) -> Matrix:
        possible = each > 0
        logs = np.log(each, out=np.zeros_like(each), where=possible).sum(axis=0)
        logs -= (there.sum(axis=0)[:, None] - 1) * np.log(self.priors_)
        vetoes = (~possible & there[:, :, None]).sum(axis=0)
        stays = vetoes == vetoes.min(axis=1, keepdims=True)
        logs = np.where(stays, logs, -np.inf)
        return np.asarray(np.exp(logs - logs.max(axis=1, keepdims=True)))
