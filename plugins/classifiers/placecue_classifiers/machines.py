"""Binary support vector machines on a precomputed Gram matrix, joined to several classes.

LIBSVM (through scikit-learn) solves each binary problem; the Gram matrix is computed once and
shared by all of them. It stops after a number of iterations that ordinary problems stay far
below, and Ctrl-C is heard while it works. A search, which only asks how good a cost is, has the
machines of pairs from a solver that goes from one cost to the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import combinations
from typing import Literal

import numpy as np
import sklearn
from numpy.typing import NDArray
from sklearn.svm import SVC

from placecue.interrupting import interruptible
from placecue_classifiers.convergence import Parted, iteration_limit, note
from placecue_classifiers.smo import Path, Runs, block, path

Matrix = NDArray[np.float64]
Codes = NDArray[np.int64]
Weights = Literal["balanced"] | NDArray[np.float64] | None
#: Iterations a sample after which a search leaves a machine to LIBSVM, which handles what is hard
#: better: ordinary ones take 1 to 40.
SOON = 100


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
        problem = _Problem.of(gram, codes, weights, classes)
        taken, finished = _by_libsvm(problem, C, machines, column)
        iterations = max(iterations, taken)
        if not finished:
            unfinished.append(classes)
    note(C, len(parted), unfinished, iterations)
    return machines


def one_against_one_at(
    gram: Matrix, codes: Codes, costs: Sequence[float], weights: Weights
) -> list[Machines]:
    """Train the machines of :func:`one_against_one` with each of some costs, for a search.

    What converges soon is trained by :func:`placecue_classifiers.smo.path`, the rest by LIBSVM:
    scikit-learn would take longer to hand over so many small problems than LIBSVM to solve them.
    Outputs differ from LIBSVM's by about its tolerance.
    """
    parted = list(combinations(range(int(codes.max()) + 1), 2))
    return interruptible(partial(_along_costs, gram, codes, costs, weights, parted))


def _along_costs(
    gram: Matrix, codes: Codes, costs: Sequence[float], weights: Weights, parted: Sequence[Parted]
) -> list[Machines]:
    order = sorted(set(costs))
    found = {C: Machines(np.zeros((len(codes), len(parted))), np.zeros(len(parted))) for C in order}
    unfinished: dict[float, list[Parted]] = {C: [] for C in order}
    iterations = dict.fromkeys(order, 0)
    for column, classes in enumerate(parted):
        problem = _Problem.of(gram, codes, weights, classes)
        along = problem.along(np.array(order))
        for k, C in enumerate(order):
            if along.finished[k]:
                found[C].coefficients[problem.rows, column] = along.coefficients[k]
                found[C].intercepts[column] = along.intercepts[k]
                continue
            taken, finished = _by_libsvm(problem, C, found[C], column)
            iterations[C] = max(iterations[C], taken)
            if not finished:
                unfinished[C].append(classes)
    for C in order:
        note(C, len(parted), unfinished[C], iterations[C])
    return [found[C] for C in costs]


@dataclass(frozen=True)
class _Problem:
    """What one machine is trained on: k of n samples, of two sides, of which one is positive."""

    whole: Matrix
    rows: Codes
    sides: Codes
    first: int
    weights: Matrix

    @classmethod
    def of(cls, gram: Matrix, codes: Codes, weights: Weights, classes: Parted) -> _Problem:
        """Take the samples of a pair of classes, or all of them for one against the rest."""
        if len(classes) == 1:
            rows = np.arange(len(codes))
        else:
            rows = np.flatnonzero((codes == classes[0]) | (codes == classes[1]))
        first = codes[rows] == classes[0]
        sides = codes[rows] if len(classes) == 2 else np.where(first, classes[0], -1)
        return cls(gram, rows, sides, classes[0], _of_samples(weights, first, codes[rows]))

    @cached_property
    def gram(self) -> Matrix:
        """The kernel between the k samples, shape (k, k)."""
        if len(self.rows) == len(self.whole):
            return self.whole
        found: Matrix = block(self.whole, self.rows, self.rows)
        return found

    def along(self, costs: Matrix) -> Path:
        """Train the machine with each of some costs, in increasing order, as far as it is easy."""
        runs = self._runs()
        gram = self.gram if runs is None else self.whole
        return path(gram, self.signs, self.weights, costs, self.soon, runs)

    def _runs(self) -> Runs | None:
        """Return where the samples lie in the whole, if they do so in two runs at most."""
        breaks = np.flatnonzero(np.diff(self.rows) != 1) + 1
        if not len(self.rows) or len(breaks) > 1:
            return None
        length = int(breaks[0]) if len(breaks) else len(self.rows)
        second = int(self.rows[length]) if len(breaks) else 0
        return Runs(int(self.rows[0]), length, second)

    @property
    def signs(self) -> Matrix:
        """1 for the samples of the first side, -1 for the others, shape (k,)."""
        return np.where(self.sides == self.first, 1.0, -1.0)

    @property
    def soon(self) -> int:
        """After how many iterations a machine is left to LIBSVM; at once where a side is empty."""
        if np.count_nonzero(self.sides == self.first) in (0, len(self.rows)):
            return 0
        return min(SOON * len(self.rows), iteration_limit(len(self.rows)))


def _by_libsvm(problem: _Problem, C: float, machines: Machines, column: int) -> tuple[int, bool]:
    """Set one column of some machines; return the iterations, and whether they were enough."""
    svc = _SVC(kernel="precomputed", C=C, max_iter=iteration_limit(len(problem.rows)))
    # The Gram matrix has been looked at once; a search would have it looked at thousands of times.
    with sklearn.config_context(assume_finite=True, skip_parameter_validation=True):
        svc.fit(problem.gram, problem.sides, problem.weights)
    # scikit-learn's second class is positive.
    sign = 1.0 if svc.classes_[1] == problem.first else -1.0
    machines.coefficients[problem.rows[svc.support_], column] = sign * svc.dual_coef_[0]
    machines.intercepts[column] = sign * svc.intercept_[0]
    return int(svc.n_iter_.max()), not svc.fit_status_


def _of_samples(weights: Weights, first: NDArray[np.bool_], codes: Codes) -> Matrix:
    """Return the weight of each sample, shape (k,).

    LIBSVM multiplies C by it, as by that of a class, which scikit-learn takes longer to work out
    than LIBSVM to train a small machine.
    """
    if weights is None:
        return np.ones(len(codes))
    if not isinstance(weights, str):
        return np.asarray(weights[codes], dtype=np.float64)
    count = np.count_nonzero(first)
    return np.where(first, len(first) / (2 * count), len(first) / (2 * (len(first) - count)))


class _SVC(SVC):
    def _warn_from_fit_status(self) -> None:
        """Say nothing: what is left unfinished is told once a training."""
