"""Hidden Markov models: the likeliest sequence of places, and the probability of each place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

Values = NDArray[np.float64]


def staying(classes: int, step: float, lasts: float) -> Values:
    """Return the logarithm of the transitions of places that last so long on average.

    Parameters
    ----------
    classes : int
        M.
    step : float
        Way from one observation to the next, m.
    lasts : float
        Mean way within a place, m. It is left for each other with equal probability.

    Returns
    -------
    ndarray of float64, shape (M, M)
        From row to column.
    """
    stay = np.exp(-step / lasts)
    others = (1 - stay) / (classes - 1)
    return np.asarray(np.log(np.where(np.eye(classes, dtype=bool), stay, others)))


def forward(likelihoods: Values, transitions: Values) -> Values:
    """Return the probability of each class at each step by what was seen up to there.

    Parameters
    ----------
    likelihoods : ndarray of float64, shape (T, M)
        Log-likelihood of each class by what was seen at each step.
    transitions : ndarray of float64, shape (M, M)
        Logarithm, from row to column. The first place is any with equal probability.

    Returns
    -------
    ndarray of float64, shape (T, M)
        Logarithms, normalised.
    """
    alpha = np.empty_like(likelihoods)
    for t, seen in enumerate(likelihoods):
        before = logsumexp(alpha[t - 1][:, None] + transitions, axis=0) if t else 0.0
        alpha[t] = before + seen
        alpha[t] -= logsumexp(alpha[t])
    return alpha


def smoothed(likelihoods: Values, transitions: Values) -> Values:
    """Return the probability of each class at each step by all that was seen, shape (T, M)."""
    alpha = forward(likelihoods, transitions)
    beta = np.zeros_like(likelihoods)
    for t in range(len(likelihoods) - 2, -1, -1):
        beta[t] = logsumexp(transitions + likelihoods[t + 1] + beta[t + 1], axis=1)
        beta[t] -= logsumexp(beta[t])
    both = alpha + beta
    return np.asarray(np.exp(both - logsumexp(both, axis=1, keepdims=True)))


def viterbi(likelihoods: Values, transitions: Values) -> NDArray[np.int64]:
    """Return the likeliest sequence of classes, shape (T,); see :func:`forward`."""
    n = len(likelihoods)
    came_from = np.zeros(likelihoods.shape, dtype=np.int64)
    best = np.zeros(likelihoods.shape[1])
    for t, seen in enumerate(likelihoods):
        ways = best[:, None] + transitions if t else np.diag(best)
        came_from[t] = ways.argmax(axis=0)
        best = (ways.max(axis=0) if t else best) + seen
    path = np.zeros(n, dtype=np.int64)
    if n:
        path[-1] = best.argmax()
    for t in range(n - 1, 0, -1):
        path[t - 1] = came_from[t, path[t]]
    return path
