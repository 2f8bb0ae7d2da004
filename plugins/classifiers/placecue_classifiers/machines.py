"""Binary support vector machines on a precomputed Gram matrix, joined to several classes.

LIBSVM (through scikit-learn) solves each binary problem; the Gram matrix is computed once and
shared by all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
import sklearn
from numpy.typing import NDArray
from sklearn.svm import SVC

Matrix = NDArray[np.float64]
Codes = NDArray[np.int64]
Weights = Literal["balanced"] | NDArray[np.float64] | None


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


def one_against_all(gram: Matrix, codes: Codes, C: float, weights: Weights) -> Machines:
    """Train one machine a class against the rest.

    Parameters
    ----------
    gram : ndarray of float64, shape (n, n)
        Kernel between the training samples, finite.
    codes : ndarray of int64, shape (n,)
        Class of each sample, 0 to M - 1.
    C : float
        Cost of a margin violation.
    weights : "balanced", ndarray of float64 of shape (M,), or None
        Weights of the two sides by inverse frequency, of each class, or none.

    Returns
    -------
    Machines
        Of M discriminant functions, in order of class.
    """
    n_classes = int(codes.max()) + 1
    machines = Machines(np.zeros((len(codes), n_classes)), np.zeros(n_classes))
    for code in range(n_classes):
        svc = _trained(gram, np.where(codes == code, 1, -1), C, weights, codes)
        machines.coefficients[svc.support_, code] = svc.dual_coef_[0]
        machines.intercepts[code] = svc.intercept_[0]
    return machines


def one_against_one(gram: Matrix, codes: Codes, C: float, weights: Weights) -> Machines:
    """Train one machine a pair of classes (i, j), i < j; positive means that i wins.

    LIBSVM trains all pairs in one call; balanced weights are of the whole problem, n / (M n_i).
    Parameters and result are those of :func:`one_against_all`, with M (M - 1) / 2 functions.
    """
    n_classes = int(codes.max()) + 1
    svc = _trained(gram, codes, C, weights, codes)
    # With two classes scikit-learn turns LIBSVM's sign, so that the second class is positive.
    sign = -1.0 if n_classes == 2 else 1.0
    pairs = list(combinations(range(n_classes), 2))
    machines = Machines(np.zeros((len(codes), len(pairs))), sign * svc.intercept_)
    supports = np.split(svc.support_, np.cumsum(svc.n_support_)[:-1])
    duals = np.split(sign * svc.dual_coef_, np.cumsum(svc.n_support_)[:-1], axis=1)
    for column, (first, second) in enumerate(pairs):
        # A support vector of class i has M - 1 coefficients, one for each other class in order.
        machines.coefficients[supports[first], column] = duals[first][second - 1]
        machines.coefficients[supports[second], column] = duals[second][first]
    return machines


def _trained(gram: Matrix, sides: Codes, C: float, weights: Weights, codes: Codes) -> SVC:
    balanced = isinstance(weights, str)
    svc = SVC(kernel="precomputed", C=C, class_weight="balanced" if balanced else None)
    each = None if weights is None or isinstance(weights, str) else weights[codes]
    # The Gram matrix has been looked at once; a search would have it looked at thousands of times.
    with sklearn.config_context(assume_finite=True, skip_parameter_validation=True):
        return svc.fit(gram, sides, sample_weight=each)
