"""Binary support vector machines on a precomputed Gram matrix, joined to several classes.

LIBSVM (through scikit-learn) solves each binary problem; the Gram matrix is computed once and
shared by all of them. It stops after a number of iterations that ordinary problems stay far
below, and Ctrl-C is heard while it works.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Literal

import numpy as np
import sklearn
from numpy.typing import NDArray
from sklearn.svm import SVC

from placecue.interrupting import interruptible
from placecue_classifiers.convergence import Parted, iteration_limit, note

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
    parted = [(code,) for code in range(int(codes.max()) + 1)]
    return interruptible(partial(_trained, gram, codes, C, weights, parted))


def one_against_one(gram: Matrix, codes: Codes, C: float, weights: Weights) -> Machines:
    """Train one machine a pair of classes (i, j), i < j; positive means that i wins.

    Each machine sees the samples of its pair alone; balanced weights are n_pair / (2 n_i).
    Parameters and result are those of :func:`one_against_all`, with M (M - 1) / 2 functions.
    """
    # Given all classes at once LIBSVM has one weight of a class for all of its pairs.
    parted = list(combinations(range(int(codes.max()) + 1), 2))
    return interruptible(partial(_trained, gram, codes, C, weights, parted))


def _trained(
    gram: Matrix, codes: Codes, C: float, weights: Weights, parted: Sequence[Parted]
) -> Machines:
    """Train a machine for each class against the rest, or pair of classes; the first is positive.

    All of them in one call, so that one thread serves them all.
    """
    machines = Machines(np.zeros((len(codes), len(parted))), np.zeros(len(parted)))
    unfinished, iterations = [], 0
    for column, classes in enumerate(parted):
        rows, svc = _solved(gram, codes, C, weights, classes)
        # scikit-learn's second class is positive.
        sign = 1.0 if svc.classes_[1] == classes[0] else -1.0
        machines.coefficients[rows[svc.support_], column] = sign * svc.dual_coef_[0]
        machines.intercepts[column] = sign * svc.intercept_[0]
        iterations = max(iterations, int(svc.n_iter_.max()))
        if svc.fit_status_:
            unfinished.append(classes)
    note(C, len(parted), unfinished, iterations)
    return machines


def _solved(
    gram: Matrix, codes: Codes, C: float, weights: Weights, classes: Parted
) -> tuple[Codes, SVC]:
    """Return the rows that a machine is trained on, shape (k,), and the machine."""
    if len(classes) == 1:
        rows, block = np.arange(len(codes)), gram  # the whole matrix is not copied
        sides = np.where(codes == classes[0], classes[0], -1)
    else:
        rows = np.flatnonzero(np.isin(codes, classes))
        block, sides = gram[np.ix_(rows, rows)], codes[rows]
    svc = _SVC(kernel="precomputed", C=C, max_iter=iteration_limit(len(rows)))
    # The Gram matrix has been looked at once; a search would have it looked at thousands of times.
    with sklearn.config_context(assume_finite=True, skip_parameter_validation=True):
        return rows, svc.fit(block, sides, _of_samples(weights, sides == classes[0], codes[rows]))


def _of_samples(weights: Weights, first: NDArray[np.bool_], codes: Codes) -> Matrix | None:
    """Return the weight of each sample, shape (k,), or None.

    LIBSVM multiplies C by it, as by that of a class, which scikit-learn takes longer to work out
    than LIBSVM to train a small machine.
    """
    if weights is None:
        return None
    if not isinstance(weights, str):
        return np.asarray(weights[codes])
    count = np.count_nonzero(first)
    return np.where(first, len(first) / (2 * count), len(first) / (2 * (len(first) - count)))


class _SVC(SVC):
    def _warn_from_fit_status(self) -> None:
        """Say nothing: what is left unfinished is told once a training."""
