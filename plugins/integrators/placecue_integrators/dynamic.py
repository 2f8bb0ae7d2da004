"""Log-linear pooling with a weight for each cue and sample, by how sure the cue is of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue import (
    DataError,
    Evidence,
    Integrator,
    Probabilities,
    Scores,
    check_flag,
    check_number,
)
from placecue_integrators.agreement import check_layouts, class_codes, common_classes
from placecue_integrators.calibrated import Calibration, certainty, class_evidence
from placecue_integrators.log_linear import fitted_weights, log_softmax

Matrix = NDArray[np.float64]


class Dynamic(Integrator):
    """Product of calibrated probabilities, each cue weighted by how sure it is of the sample.

    p(k | s) is in proportion to prod_t p_t(k | s)^w_t(s), where p_t are the probabilities of cue
    t, calibrated by a temperature and class biases from its scores of whatever layout, and ::

        w_t(s) = u_t (1 - c_t(s)) + v_t c_t(s),    u_t, v_t >= 0,

    with c_t(s) = 1 - H(p_t(. | s)) / log M, which is 0 where the cue knows nothing of the sample
    and 1 where it is certain. A camera in the dark is not sure, so that u, not v, says what it
    counts there. All weights 1 is the product rule; u_t = v_t are weights that do not depend on
    the sample. Calibration, then u and v, are fitted to held-out scores by log loss with classes
    weighted equally: two convex problems.

    For each set of cues that are there a scheme of its own is fitted (``gaps`` is False): what a
    cue should count depends on what stands beside it.

    Parameters
    ----------
    penalty : float
        Draws u and v to 1, and slope and biases of the calibration to 0, as a normal prior of
        variance 1 / ``penalty`` on standardised scores would; above 0.
    per_sample : bool
        False: u_t = v_t, one weight a cue.

    Attributes
    ----------
    cues_ : list of str
        The T cues, in the order of what follows.
    layouts_ : list of Layout
        Those of their scores.
    slopes_, scales_ : ndarray of float64, shape (T,)
        Of each cue's calibration; see :class:`placecue_integrators.calibrated.Calibration`.
    biases_ : ndarray of float64, shape (T, M)
        The same.
    weights_ : ndarray of float64, shape (T, 2)
        What each cue counts where it knows nothing (u) and where it is certain (v).

    References
    ----------
    Beyond the paper, our choice. Log-linear pooling: Genest and Zidek, Combining probability
    distributions, Statistical Science 1(1), 1986.
    """

    def __init__(self, penalty: float = 1.0, per_sample: bool = True) -> None:
        self.penalty = penalty
        self.per_sample = per_sample

    def check_parameters(self) -> None:  # noqa: D102
        check_number("penalty", self.penalty, above=0, below=np.inf)
        check_flag("per_sample", self.per_sample)

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Learn from scores that the single-cue models have not been trained on.

        Samples that lack a cue are left out.

        Raises
        ------
        DataError
            If the cues do not tell the same classes apart, the labels are of others, or samples
            with scores of every cue are not there or all of one class.
        """
        self.check_parameters()
        self.cues_ = list(evidence.cues)
        classes = common_classes(evidence, self.cues_)
        self.layouts_ = [evidence.layout(cue) for cue in self.cues_]
        codes = class_codes(labels, evidence, classes)
        speaks, rows = self._complete(evidence)
        codes = codes[rows]
        self._check_classes([classes[code] for code in np.unique(codes)], len(rows))
        each = [Calibration.fit(of_cue, codes, self.penalty) for of_cue in speaks]
        self.slopes_ = np.array([one.slope for one in each])
        self.scales_ = np.array([one.scale for one in each])
        self.biases_ = np.stack([one.bias for one in each])
        self.weights_ = self._weights(self._terms(speaks), codes)
        return self

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the probabilities of n observations, shape (n, M); NaN where a cue is missing."""
        check_layouts(evidence, self.cues_, self.layouts_)
        layout = Probabilities(self.layouts_[0].classes)
        speaks, rows = self._complete(evidence)
        values = np.full((len(evidence), len(layout.classes)), np.nan)
        if rows.size:
            # einsum adds in one order whatever the number of rows; BLAS does not.
            logits = np.einsum("j,njk->nk", self.weights_.ravel(), self._terms(speaks))
            values[rows] = np.exp(log_softmax(logits))
        return Scores(values, layout)

    def _weights(self, terms: Matrix, codes: NDArray[np.int64]) -> Matrix:
        """Return u and v of each cue, shape (T, 2)."""
        n, width, m = terms.shape
        if not self.per_sample:  # (1 - c) log p + c log p
            terms = terms.reshape(n, width // 2, 2, m).sum(axis=2)
        prior = np.ones(terms.shape[1])
        weights = fitted_weights(terms, codes, prior, np.zeros_like(prior), self.penalty)
        return np.repeat(weights, width // len(weights)).reshape(-1, 2)

    def summary(self) -> str:
        """Return the weights of each cue where it is unsure and where it is sure."""
        pairs = zip(self.cues_, self.weights_, strict=True)
        told = ", ".join(f"{cue} {unsure:.2f} to {sure:.2f}" for cue, (unsure, sure) in pairs)
        return f"weights where unsure to sure: {told}"

    def check_learned(self) -> None:
        """Raise ValueError if what a model folder says does not fit together."""
        t, m = np.shape(self.biases_)
        shapes = [np.shape(each) for each in (self.slopes_, self.scales_, self.weights_)]
        if shapes != [(t,), (t,), (t, 2)] or len(self.cues_) != t or m < 2:
            raise ValueError(
                f"{len(self.cues_)} cues, biases {(t, m)}, and the others of shapes {shapes}"
            )

    def _check_classes(self, names: Sequence[str], n: int) -> None:
        if len(names) < 2:
            raise DataError(
                "weights need held-out samples of two classes or more with scores of all cues "
                f"({', '.join(self.cues_)}), got {f'{n} of {names[0]}' if n else 'none'}"
            )

    def _complete(self, evidence: Evidence) -> tuple[Matrix, NDArray[np.int64]]:
        """Return what speaks for each class by each cue, (T, k, M), and which rows have all."""
        scores = [evidence.scores(cue) for cue in self.cues_]
        there = scores[0].available()
        for each in scores[1:]:
            there &= each.available()
        rows = np.flatnonzero(there)
        if rows.size == 0:  # layouts are asked about samples that are there
            return np.empty((len(scores), 0, 0)), rows
        return np.stack([class_evidence(each[rows]) for each in scores]), rows

    def _terms(self, speaks: Matrix) -> Matrix:
        """Return (1 - c_t) log p_t and c_t log p_t of each cue, shape (k, 2 T, M)."""
        # All cues at once: for one sample a call costs more than its sums.
        column = np.s_[:, None, None]
        learned = self.slopes_[column], self.scales_[column], self.biases_[:, None]
        logs = Calibration(*learned).log_probabilities(speaks)
        sure = certainty(logs)[..., None]
        pairs = np.stack([(1 - sure) * logs, sure * logs], axis=1)
        t, _, k, m = pairs.shape
        return np.ascontiguousarray(np.moveaxis(pairs.reshape(2 * t, k, m), 1, 0))
