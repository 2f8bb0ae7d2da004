"""Sequential minimal optimisation of one binary machine for several costs, one after the other.

The problem and the way to its solution are LIBSVM's (second-order choice of the working set, the
same tolerance), on a Gram matrix that is there: what a search gains is that the machine of one
cost begins where that of the next smaller one ended, and that nothing is checked or copied in
between.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

#: LIBSVM's: by how much the optimality conditions may be violated.
TOLERANCE = 1e-3
#: LIBSVM's: what takes the place of a curvature that is not positive.
_FLAT = 1e-12


@dataclass(frozen=True, slots=True)
class Path:
    """The machines of some costs.

    Parameters
    ----------
    coefficients : ndarray of float64, shape (costs, n)
        Signed dual coefficients.
    intercepts : ndarray of float64, shape (costs,)
    iterations : ndarray of int64, shape (costs,)
    finished : ndarray of bool, shape (costs,)
        Whether they converged.
    """

    coefficients: Matrix
    intercepts: Matrix
    iterations: NDArray[np.int64]
    finished: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Runs:
    """Which rows of a larger Gram matrix n samples are: two runs of them, used where they lie.

    Parameters
    ----------
    first : int
        Where the first run begins.
    length : int
        How long it is; all that are left of the n samples are the second.
    second : int
        Where that one begins.
    """

    first: int
    length: int
    second: int


def path(
    gram: Matrix,
    signs: Matrix,
    weights: Matrix,
    costs: Matrix,
    limit: int,
    runs: Runs | None = None,
) -> Path:
    """Train a machine for each cost.

    Parameters
    ----------
    gram : ndarray of float64, shape (n, n), or larger where ``runs`` says which rows count
        Kernel between the training samples.
    signs : ndarray of float64, shape (n,)
        1 and -1, each at least once.
    weights : ndarray of float64, shape (n,)
        What the cost of each sample is multiplied by.
    costs : ndarray of float64
        In increasing order.
    limit : int
        After so many iterations a machine is left unfinished, and so are those of larger costs.
    runs : Runs, optional
        Which rows and columns of ``gram`` the n samples are; all of them by default.

    References
    ----------
    Fan, Chen and Lin, Working set selection using second order information for training support
    vector machines, JMLR 6, 2005.
    """
    n, number = len(signs), len(costs)
    found = Path(
        np.zeros((number, n)),
        np.zeros(number),
        np.zeros(number, dtype=np.int64),
        np.zeros(number, dtype=np.bool_),
    )
    beta, error = np.zeros(n), signs.copy()
    of_all = np.diagonal(gram)
    runs = runs or Runs(0, n, 0)
    where = runs.first, runs.length, runs.second
    one, two = of_all[runs.first :][: runs.length], of_all[runs.second :][: n - runs.length]
    diagonal = np.concatenate([one, two])
    for k, cost in enumerate(costs):
        box = np.where(signs > 0, 0.0, -cost * weights), np.where(signs > 0, cost * weights, 0.0)
        iterations, intercept, finished = _solve(gram, *where, diagonal, *box, beta, error, limit)
        found.coefficients[k], found.intercepts[k] = beta, intercept
        found.iterations[k], found.finished[k] = iterations, finished
        if not finished:
            break
    return found


@njit(cache=True, nogil=True)
def block(gram: NDArray[Any], rows: NDArray[Any], columns: NDArray[Any]) -> Any:
    """Return ``gram[np.ix_(rows, columns)]``, the quicker the more of them lie side by side."""
    found = np.empty((len(rows), len(columns)))
    for i in range(len(rows)):
        row = gram[rows[i]]
        for j in range(len(columns)):
            found[i, j] = row[columns[j]]
    return found


@njit(cache=True, nogil=True)
def _solve(
    gram: NDArray[Any],
    first: int,
    length: int,
    second: int,
    diagonal: NDArray[Any],
    low: NDArray[Any],
    high: NDArray[Any],
    beta: NDArray[Any],
    error: NDArray[Any],
    limit: int,
) -> tuple[int, float, bool]:
    """Solve in place, from any feasible ``beta``; return iterations, intercept, whether finished.

    ``beta`` are the signed coefficients, within ``low`` and ``high``; ``error`` is the sign of
    each sample less sum_s K(., s) beta_s. At the optimum no sample that can go up has a larger
    error than one that can go down.
    """
    n = len(beta)
    one, two = slice(first, first + length), slice(second, second + n - length)
    for iteration in range(limit):
        up, largest, smallest = -1, -np.inf, np.inf
        for t in range(n):
            if beta[t] < high[t] and error[t] > largest:
                up, largest = t, error[t]
            if beta[t] > low[t] and error[t] < smallest:
                smallest = error[t]
        if largest - smallest < TOLERANCE:
            return iteration, _intercept(low, high, beta, error, largest, smallest), True
        row_up = gram[first + up if up < length else second + up - length]
        chosen = _down(row_up[one], 0, -1, -1.0, up, diagonal, low, beta, error)
        down, _ = _down(row_up[two], length, *chosen, up, diagonal, low, beta, error)
        lies = first + down if down < length else second + down - length
        curve = max(diagonal[up] + diagonal[down] - 2 * row_up[lies], _FLAT)
        step = (error[up] - error[down]) / curve
        room_up, room_down = high[up] - beta[up], beta[down] - low[down]
        step = min(step, min(room_up, room_down))
        beta[up] = high[up] if step == room_up else beta[up] + step
        beta[down] = low[down] if step == room_down else beta[down] - step
        row_down = gram[lies]
        _follow(error[:length], row_up[one], row_down[one], step)
        _follow(error[length:], row_up[two], row_down[two], step)
    return limit, 0.0, False


@njit(cache=True, nogil=True)
def _down(
    row_up: NDArray[Any],
    offset: int,
    down: int,
    gain: float,
    up: int,
    diagonal: NDArray[Any],
    low: NDArray[Any],
    beta: NDArray[Any],
    error: NDArray[Any],
) -> tuple[int, float]:
    """Return which of a run of samples gains most by going down, if more than one before, and it.

    The gain is that of the second-order approximation, with ``up`` going up.
    """
    for k in range(len(row_up)):
        t = offset + k
        if beta[t] > low[t] and error[t] < error[up]:
            ahead = error[up] - error[t]
            curve = max(diagonal[up] + diagonal[t] - 2 * row_up[k], _FLAT)
            if ahead * ahead > gain * curve:
                down, gain = t, ahead * ahead / curve
    return down, gain


@njit(cache=True, nogil=True)
def _follow(error: NDArray[Any], up: NDArray[Any], down: NDArray[Any], step: float) -> None:
    """Bring the errors of a run of samples up to date, several at a time."""
    for t in range(len(error)):
        error[t] -= step * (up[t] - down[t])


@njit(cache=True, nogil=True)
def _intercept(
    low: NDArray[Any],
    high: NDArray[Any],
    beta: NDArray[Any],
    error: NDArray[Any],
    largest: float,
    smallest: float,
) -> float:
    """Return the mean error of the samples off their bounds; without one the middle of the gap."""
    total, free = 0.0, 0
    for t in range(len(beta)):
        if low[t] < beta[t] < high[t]:
            total, free = total + error[t], free + 1
    return total / free if free else (largest + smallest) / 2
