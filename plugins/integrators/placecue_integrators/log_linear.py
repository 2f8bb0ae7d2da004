"""Conditional logistic regression: a weighted sum of class-wise terms, fitted by log loss."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Matrix = NDArray[np.float64]


def log_softmax(logits: Matrix) -> Matrix:
    """Return log probabilities over the last axis."""
    shifted = logits - logits.max(axis=-1, keepdims=True)
    return np.asarray(shifted - np.log(np.exp(shifted).sum(axis=-1, keepdims=True)))


def fitted_weights(
    terms: Matrix, codes: NDArray[np.int64], prior: Matrix, least: Matrix, penalty: float
) -> Matrix:
    """Return the weights w that make the classes of n samples most likely.

    Minimises sum_s g_s (-log p_s(y_s)) + penalty / (2 n) |w - prior|^2 for w_j >= least_j, with
    p_s(k) in proportion to exp(sum_j w_j terms[s, j, k]). Every class that is there counts the
    same: g_s is one over the number of such classes and of the samples of y_s. The problem is
    convex, strictly so with a penalty, so there is one answer.

    Parameters
    ----------
    terms : ndarray of float64, shape (n, J, M)
        J terms that speak for each class.
    codes : ndarray of int64, shape (n,)
        Class y_s of each sample, 0 to M - 1.
    prior : ndarray of float64, shape (J,)
        Where the weights are drawn to; where the search begins.
    least : ndarray of float64, shape (J,)
        The least that each weight may be; -inf for any.
    penalty : float
        How strongly they are drawn there; 1 is a standard deviation of 1.

    Returns
    -------
    ndarray of float64, shape (J,)
    """
    n = len(codes)
    _, classes, counts = np.unique(codes, return_inverse=True, return_counts=True)
    shares = 1 / (len(counts) * counts[classes])
    of_class = terms[np.arange(n), :, codes]

    def loss(weights: Matrix) -> tuple[float, Matrix]:
        logs = log_softmax(np.einsum("j,njk->nk", weights, terms))
        expected = np.einsum("nk,njk->nj", np.exp(logs), terms)
        away = weights - prior
        value = -shares @ logs[np.arange(n), codes] + penalty / (2 * n) * (away @ away)
        return float(value), shares @ (expected - of_class) + penalty / n * away

    bounds = [(None if np.isneginf(each) else each, None) for each in least]
    exact = {"ftol": 1e-14, "gtol": 1e-9, "maxiter": 1000, "maxfun": 10_000}
    found = minimize(loss, prior, jac=True, method="L-BFGS-B", bounds=bounds, options=exact)
    return np.asarray(found.x, dtype=np.float64)
