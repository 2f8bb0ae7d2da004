"""Rules over the cues' probabilities: mean, product and maximum."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray

from placecue import (
    DataError,
    Evidence,
    Probabilities,
    Scores,
    UsageError,
    check_choice,
    check_flag,
    check_number,
)
from placecue_integrators.agreement import common_classes
from placecue_integrators.calibrated import Calibration, class_evidence
from placecue_integrators.fixed_rule import FixedRule, told

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
PRIORS = ("equal", "training")


class ProbabilityRule(FixedRule):
    """A rule over the probabilities of the cues that are there; its rows sum to one.

    Parameters
    ----------
    calibrate : bool
        Whether cues with other scores than probabilities are taken too: their scores become
        probabilities by what is learned from the samples that the rule is fitted on
        (:class:`placecue_integrators.calibrated.Calibration`). False: they are refused.
    penalty : float
        Draws slope and biases of the calibration to 0, as a normal prior of variance
        1 / ``penalty`` on standardised scores would; above 0.

    Attributes
    ----------
    calibrated_ : list of str
        The k cues whose scores are calibrated, in the order of what follows.
    slopes_, scales_ : ndarray of float64, shape (k,)
        Of each cue's calibration.
    biases_ : ndarray of float64, shape (k, M)
        The same.

    References
    ----------
    Kittler, Hatef, Duin and Matas, On combining classifiers, PAMI 20(3), 1998, sections 2 and 3.
    """

    def __init__(self, calibrate: bool = False, penalty: float = 1.0) -> None:
        self.calibrate = calibrate
        self.penalty = penalty

    def check_parameters(self) -> None:  # noqa: D102
        check_flag("calibrate", self.calibrate)
        check_number("penalty", self.penalty, above=0, below=np.inf)

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the probabilities of n observations, shape (n, M)."""
        here = self._here(evidence)
        layout = Probabilities(common_classes(evidence, here))
        each = np.stack([self._probabilities(cue, evidence.scores(cue)) for cue in here])
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
        self.calibrated_ = [
            cue for cue in self.cues_ if not isinstance(evidence.layout(cue), Probabilities)
        ]
        if self.calibrated_ and not self.calibrate:
            _refuse(self.calibrated_[0], evidence.layout(self.calibrated_[0]).name)
        each = [self._calibration(cue, evidence.scores(cue), codes) for cue in self.calibrated_]
        m = len(evidence.layout(self.cues_[0]).classes)
        self.slopes_ = np.array([float(one.slope) for one in each])
        self.scales_ = np.array([float(one.scale) for one in each])
        self.biases_ = np.array([one.bias for one in each]).reshape(len(each), m)

    def _calibration(self, cue: str, scores: Scores, codes: NDArray[np.int64]) -> Calibration:
        rows = np.flatnonzero(scores.available())
        if len(np.unique(codes[rows])) < 2:
            raise DataError(
                f"the scores of cue '{cue}' cannot be calibrated: of the {len(rows)} held-out "
                "samples that have them none or all are of one class"
            )
        return Calibration.fit(class_evidence(scores[rows]), codes[rows], self.penalty)

    def _probabilities(self, cue: str, scores: Scores) -> Matrix:
        """Return the probabilities by one cue, shape (n, M); NaN where it is missing."""
        if cue not in self.calibrated_:
            return np.asarray(scores.values)
        at = self.calibrated_.index(cue)
        learned = Calibration(float(self.slopes_[at]), float(self.scales_[at]), self.biases_[at])
        rows = np.flatnonzero(scores.available())
        values = np.full((len(scores), self.biases_.shape[1]), np.nan)
        if rows.size:
            values[rows] = np.exp(learned.log_probabilities(class_evidence(scores[rows])))
        return values

    def summary(self) -> str:
        """Return which cues' scores are calibrated."""
        return f"calibrated: {', '.join(self.calibrated_)}" if self.calibrated_ else ""

    def check_learned(self) -> None:
        """Raise ValueError if what a model folder says does not fit together."""
        k, m = np.shape(self.biases_)
        if len(self.calibrated_) != k or {np.shape(self.slopes_), np.shape(self.scales_)} != {(k,)}:
            raise ValueError(
                f"{len(self.calibrated_)} calibrated cues, slopes {np.shape(self.slopes_)}, scales "
                f"{np.shape(self.scales_)}, biases {(k, m)}"
            )


def _refuse(cue: str, layout: str) -> None:
    raise UsageError(
        f"cue '{cue}' gives {layout} scores, and this integrator joins probabilities: set "
        f"integrator.calibrate=true, or cues.{cue}.classifier.probability=sigmoid for an SVM, "
        f"cues.{cue}.classifier.output=probability for AdaBoost, or choose an integrator that "
        "takes any scores, such as integrator=vote"
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
    calibrate, penalty
        See :class:`ProbabilityRule`.

    Attributes
    ----------
    priors_ : ndarray of float64, shape (M,)
        The p(k) in use.
    """

    def __init__(
        self, priors: str = "equal", calibrate: bool = False, penalty: float = 1.0
    ) -> None:
        super().__init__(calibrate, penalty)
        self.priors = priors

    def check_parameters(self) -> None:  # noqa: D102
        super().check_parameters()
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
