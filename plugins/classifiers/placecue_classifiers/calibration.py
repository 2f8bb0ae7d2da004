"""Probabilities from the outputs of machines, learned on samples that these have not seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sklearn.isotonic import IsotonicRegression
from sklearn.linear_model import LogisticRegression

from placecue.scores import Layout, OneAgainstOne

Matrix = NDArray[np.float64]
Codes = NDArray[np.int64]
METHODS = ("sigmoid", "isotonic")


def calibrators(method: str, layout: Layout, values: Matrix, codes: Codes) -> list[Matrix]:
    """Learn what turns each output into a probability.

    Parameters
    ----------
    method : {"sigmoid", "isotonic"}
        Platt's sigmoid, or a monotonous step function, which needs more samples.
    layout : Layout
        What the outputs are.
    values : ndarray of float64, shape (n, V)
        Outputs for n samples that the machines have not been trained on.
    codes : ndarray of int64, shape (n,)
        Class of each sample, 0 to M - 1.

    Returns
    -------
    list of ndarray of float64
        For each output (slope, offset) of its sigmoid, or of shape (2, k) the k corners of its
        step function.
    """
    learn = _sigmoid if method == "sigmoid" else _isotonic

    def fit(outputs: Matrix, positive: NDArray[np.bool_]) -> Matrix:
        # Classes that no fold could hold out leave nothing to learn from: then a half.
        return learn(outputs, positive) if len(outputs) else _learned_nothing(method)

    if isinstance(layout, OneAgainstOne):
        of_pairs = []
        for column, pair in enumerate(layout.pairs):
            rows = np.isin(codes, pair)
            of_pairs.append(fit(values[rows, column], codes[rows] == pair[0]))
        return of_pairs
    outputs = layout.preference(values)
    return [fit(outputs[:, code], codes == code) for code in range(outputs.shape[1])]


def probabilities(method: str, learned: Sequence[Matrix], layout: Layout, values: Matrix) -> Matrix:
    """Return the probability of each class, shape (n, M); rows sum to one.

    One-against-one joins the probabilities of the pairs as Wu, Lin and Weng; the others divide
    those of the classes by their sum.
    """
    apply = _apply_sigmoid if method == "sigmoid" else _apply_isotonic
    pairwise = isinstance(layout, OneAgainstOne)
    outputs = values if pairwise else layout.preference(values)
    each = np.stack([apply(one, outputs[:, v]) for v, one in enumerate(learned)], axis=1)
    joined = coupled(layout, each) if isinstance(layout, OneAgainstOne) else each
    total = joined.sum(axis=1, keepdims=True)
    equal = np.full(joined.shape, 1 / len(layout.classes))
    return np.asarray(np.divide(joined, total, out=equal, where=total > 0))


def coupled(layout: OneAgainstOne, pairwise: Matrix) -> Matrix:
    """Return the class probabilities that agree best with those of pairs.

    Minimises sum_ij (r_ji p_i - r_ij p_j)**2 where the p sum to one.

    Parameters
    ----------
    layout : OneAgainstOne
        What the columns are.
    pairwise : ndarray of float64, shape (n, M (M - 1) / 2)
        Probability of i in each pair (i, j).

    Returns
    -------
    ndarray of float64, shape (n, M)

    References
    ----------
    Wu, Lin and Weng, Probability estimates for multi-class classification by pairwise coupling,
    JMLR 5, 2004, second approach; what LIBSVM does.
    """
    m = len(layout.classes)
    limit = 1e-7  # as LIBSVM: a probability of 0 or 1 would leave the system without solution
    # margins() holds v at (i, j) and -v at (j, i): shifted by a half, r_ij and 1 - r_ij.
    r = 0.5 + layout.margins(np.clip(pairwise, limit, 1 - limit) - 0.5)
    r[:, np.arange(m), np.arange(m)] = 0
    system = np.ones((len(r), m + 1, m + 1))
    system[:, :m, :m] = -np.swapaxes(r, 1, 2) * r
    system[:, np.arange(m), np.arange(m)] = (r**2).sum(axis=1)
    system[:, m, m] = 0
    wanted = np.zeros((len(r), m + 1, 1))
    wanted[:, m] = 1
    return np.asarray(np.linalg.solve(system, wanted)[:, :m, 0].clip(0))


def _learned_nothing(method: str) -> Matrix:
    return np.zeros(2) if method == "sigmoid" else np.array([[0.0], [0.5]])


def _sigmoid(outputs: Matrix, positive: NDArray[np.bool_]) -> Matrix:
    """Fit Platt's sigmoid: a logistic regression on targets drawn in from 0 and 1."""
    n_positive = int(positive.sum())
    high = (n_positive + 1) / (n_positive + 2)
    low = 1 / (len(positive) - n_positive + 2)
    target = np.where(positive, high, low)
    # Outputs of LIBSVM range over orders of magnitude; the solver's tolerance does not.
    scale = float(np.abs(outputs).max(initial=0)) or 1.0
    column = outputs[:, None] / scale
    regression = LogisticRegression(C=np.inf, tol=1e-8, max_iter=1000)
    regression.fit(
        np.concatenate([column, column]),
        np.repeat([1, 0], len(target)),
        sample_weight=np.concatenate([target, 1 - target]),
    )
    return np.array([regression.coef_[0, 0] / scale, regression.intercept_[0]])


def _apply_sigmoid(learned: Matrix, outputs: Matrix) -> Matrix:
    # tanh does not overflow.
    return np.asarray((1 + np.tanh((learned[0] * outputs + learned[1]) / 2)) / 2)


def _isotonic(outputs: Matrix, positive: NDArray[np.bool_]) -> Matrix:
    regression = IsotonicRegression(y_min=0, y_max=1, out_of_bounds="clip")
    regression.fit(outputs, positive.astype(np.float64))
    return np.stack([regression.X_thresholds_, regression.y_thresholds_])


def _apply_isotonic(learned: Matrix, outputs: Matrix) -> Matrix:
    return np.asarray(np.interp(outputs, learned[0], learned[1]), dtype=np.float64)
