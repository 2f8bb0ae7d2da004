"""One cue's scores, of any layout, as calibrated log probabilities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from placecue import DecisionList, OneAgainstOne, Probabilities, Scores, call
from placecue_integrators.log_linear import fitted_weights, log_softmax

Matrix = NDArray[np.float64]
#: The least probability of which a logarithm is taken.
_LEAST = 1e-12
#: Scores may lie this many deviations from the mean; far more than data do, far from overflow.
_FARTHEST = 1e6


def class_evidence(scores: Scores) -> Matrix:
    """Return how much n scores speak for each class, shape (n, M), less the mean over classes.

    Logarithms of probabilities; for one-against-one the smallest margin of a class over the others,
    the paper's confidence asked of each class; the outputs of a decision list, whose ranks say
    nothing of how sure they are; of every other layout its preference, which for one-against-all is
    the outputs and for modified one-against-all minus the distances.
    """
    layout, values = scores.layout, scores.values
    if isinstance(layout, Probabilities):
        speaks = np.log(values.clip(_LEAST, 1))
    elif isinstance(layout, OneAgainstOne):
        margins = layout.margins(values)
        itself = np.arange(margins.shape[1])
        margins[:, itself, itself] = np.inf
        speaks = margins.min(axis=2)
    elif isinstance(layout, DecisionList):
        speaks = values
    else:
        speaks = call(layout, "preference", values)
    return np.asarray(speaks - speaks.mean(axis=1, keepdims=True))


@dataclass(frozen=True)
class Calibration:
    """Temperature scaling with a bias for each class.

    log p(k) = slope e_k / scale + bias_k - const, where e_k is the :func:`class_evidence`. The
    order of the classes is kept but for the biases; a cue worse than chance gets the slope 0.

    Parameters
    ----------
    slope : float, or ndarray of float64 of shape (T, 1, 1) for T cues at once
        At least 0; of evidence that is divided by ``scale``.
    scale : the same
        Deviation of the evidence on the fitting data.
    bias : ndarray of float64, shape (M,) or (T, 1, M)
        One a class.

    References
    ----------
    Guo, Pleiss, Sun and Weinberger, On calibration of modern neural networks, ICML 2017
    (temperature); Alexandari, Kundaje and Shrikumar, ICML 2020 (with biases).
    """

    slope: float | Matrix
    scale: float | Matrix
    bias: Matrix

    @classmethod
    def fit(cls, evidence: Matrix, codes: NDArray[np.int64], penalty: float) -> Self:
        """Learn from scores that the cue's model has not been trained on, by log loss.

        Parameters
        ----------
        evidence : ndarray of float64, shape (n, M)
            The :func:`class_evidence` of n samples.
        codes : ndarray of int64, shape (n,)
            Their classes.
        penalty : float
            See :func:`fitted_weights`.
        """
        n, m = evidence.shape
        scale = float(np.sqrt(np.mean(evidence**2))) or 1.0
        biases = np.broadcast_to(np.eye(m), (n, m, m))
        terms = np.concatenate([(evidence / scale)[:, None], biases], axis=1)
        least = np.array([0.0, *[-np.inf] * m])
        slope, *bias = fitted_weights(terms, codes, np.zeros(m + 1), least, penalty)
        return cls(float(slope), scale, np.array(bias))

    def log_probabilities(self, evidence: Matrix) -> Matrix:
        """Return calibrated log probabilities, shape (n, M) or (T, n, M) as the evidence."""
        standard = (evidence / self.scale).clip(-_FARTHEST, _FARTHEST)
        return log_softmax(self.slope * standard + self.bias)


def certainty(logs: Matrix) -> Matrix:
    """Return 1 - entropy / log M of log probabilities (…, M): 0 knows nothing, 1 is certain."""
    entropy = -(np.exp(logs) * logs).sum(axis=-1)
    return np.asarray((1 - entropy / np.log(logs.shape[-1])).clip(0, 1))
