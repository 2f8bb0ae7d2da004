"""Binary support vector machines on a precomputed Gram matrix, joined to several classes.

LIBSVM (through scikit-learn) solves each binary problem; the Gram matrix is computed once and
shared by all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import SVC

Matrix = NDArray[np.float64]
Codes = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Machines:
    """V discriminant functions D_v(x) = sum_i coefficients[i, v] K(x, x_i) + intercepts[v].

    Parameters
    ----------
    coefficients : ndarray of float64, shape (n, V)
        Signed dual coefficients of the training samples; 0 where a sample is no support vector.
    intercepts : ndarray of float64, shape (V,)
    """

    coefficients: Matrix
    intercepts: Matrix

    def decide(self, gram: Matrix) -> Matrix:
        """Return D_v for each row of a Gram block of shape (m, n), shape (m, V)."""
        return np.asarray(gram @ self.coefficients + self.intercepts)


def one_against_all(gram: Matrix, codes: Codes, C: float, balanced: bool) -> Machines:
    """Train one machine a class against the rest.

    Parameters
    ----------
    gram : ndarray of float64, shape (n, n)
        Kernel between the training samples.
    codes : ndarray of int64, shape (n,)
        Class of each sample, 0 to M - 1.
    C : float
        Cost of a margin violation.
    balanced : bool
        Weight the two sides by inverse frequency.

    Returns
    -------
    Machines
        Of M discriminant functions, in order of class.
    """
    n_classes = int(codes.max()) + 1
    machines = Machines(np.zeros((len(codes), n_classes)), np.zeros(n_classes))
    for code in range(n_classes):
        svc = SVC(kernel="precomputed", C=C, class_weight="balanced" if balanced else None)
        svc.fit(gram, np.where(codes == code, 1, -1))
        machines.coefficients[svc.support_, code] = svc.dual_coef_[0]
        machines.intercepts[code] = svc.intercept_[0]
    return machines


def one_against_one(gram: Matrix, codes: Codes, C: float, balanced: bool) -> Machines:
    """Train one machine a pair of classes (i, j), i < j; positive means that i wins.

    Weights are those of the whole problem, n / (M n_i), as LIBSVM applies them. Parameters and
    result are those of :func:`one_against_all`, with M (M - 1) / 2 functions.
    """
    counts = np.bincount(codes)
    weights = len(codes) / (len(counts) * counts) if balanced else np.ones(len(counts))
    pairs = list(combinations(range(len(counts)), 2))
    machines = Machines(np.zeros((len(codes), len(pairs))), np.zeros(len(pairs)))
    for column, (first, second) in enumerate(pairs):
        rows = np.concatenate([np.flatnonzero(codes == first), np.flatnonzero(codes == second)])
        side = np.where(codes[rows] == first, 1, -1)
        svc = SVC(kernel="precomputed", C=C, class_weight={1: weights[first], -1: weights[second]})
        svc.fit(gram[np.ix_(rows, rows)], side)
        machines.coefficients[rows[svc.support_], column] = svc.dual_coef_[0]
        machines.intercepts[column] = svc.intercept_[0]
    return machines
