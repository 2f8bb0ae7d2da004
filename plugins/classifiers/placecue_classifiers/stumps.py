"""Decision stumps: the best threshold on one of many single-valued features."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
CRITERIA = ("error", "gini")
#: A stump must be better than the best so far by more than sums of weights are rounded.
MARGIN = 1e-12


@dataclass(frozen=True, slots=True)
class Stump:
    """h(x) = left where x[feature] <= threshold, else right.

    Parameters
    ----------
    feature : int
        Column of the features.
    threshold : float
        In the feature's unit; minus infinity for a stump that says the same of everything.
    left, right : int
        -1 or 1.
    """

    feature: int
    threshold: float
    left: int
    right: int

    def __call__(self, features: Matrix) -> Matrix:
        """Return h for each row of features, shape (n,)."""
        below = features[:, self.feature] <= self.threshold
        return np.where(below, float(self.left), float(self.right))


@dataclass(frozen=True, slots=True)
class SortedFeatures:
    """n samples sorted by each of d features, once for all rounds and classes.

    Parameters
    ----------
    order : ndarray of int32, shape (d, n)
        The samples by increasing feature.
    values : ndarray of float64, shape (d, n)
        The features in that order.
    """

    order: NDArray[np.int32]
    values: Matrix

    @classmethod
    def of(cls, features: Matrix) -> SortedFeatures:
        """Sort features of shape (n, d)."""
        columns = np.ascontiguousarray(features.T)
        order = np.argsort(columns, axis=1, kind="stable")
        return cls(order.astype(np.int32), np.take_along_axis(columns, order, axis=1))

    def best(self, signs: Matrix, weights: Matrix, criterion: str = "error") -> Stump:
        """Return the best stump; of equals that of the first feature and lowest threshold.

        One pass over each feature, n additions.

        Parameters
        ----------
        signs : ndarray of float64, shape (n,)
            -1 or 1.
        weights : ndarray of float64, shape (n,)
            Not negative; they sum to one.
        criterion : {"error", "gini"}
            Least weighted error, over all thresholds and both directions; or least Gini impurity
            of the two sides, each of which then says what most of its weight says.
        """
        search = _least_error if criterion == "error" else _least_impurity
        feature, place, left, right = search(self.order, self.values, signs * weights, weights)
        if place < 0:
            return Stump(0, -np.inf, int(right), int(right))
        low, high = self.values[feature, place], self.values[feature, place + 1]
        threshold = low + (high - low) / 2
        # Between neighbouring numbers there is none, and half of the range may overflow.
        if not low <= threshold < high:
            threshold = low
        return Stump(int(feature), float(threshold), int(left), int(right))


@njit(cache=True, nogil=True)
def _least_error(
    order: NDArray[Any], values: NDArray[Any], signed: NDArray[Any], weights: NDArray[Any]
) -> tuple[int, int, int, int]:
    """Return feature, last place on the left, and what left and right say; -1 for no threshold."""
    d, n = order.shape
    total = signed.sum()
    # r = sum_i w_i y_i h(x_i) = 1 - 2 error; a threshold below everything gives +-total.
    best, feature, place, left = abs(total), 0, -1, -1 if total >= 0 else 1
    for j in range(d):
        below = 0.0
        for k in range(n - 1):
            below += signed[order[j, k]]
            if values[j, k] < values[j, k + 1]:
                r = 2 * below - total
                if abs(r) > best + MARGIN:
                    best, feature, place, left = abs(r), j, k, 1 if r > 0 else -1
    return feature, place, left, -left


@njit(cache=True, nogil=True)
def _least_impurity(
    order: NDArray[Any], values: NDArray[Any], signed: NDArray[Any], weights: NDArray[Any]
) -> tuple[int, int, int, int]:
    """Return what :func:`_least_error` does, for the least Gini impurity."""
    d, n = order.shape
    total, mass = signed.sum(), weights.sum()
    # Impurity is 1/2 (1 - s**2 / m) a side of mass m and signed mass s.
    best, feature, place = total * total / mass, 0, -1
    left = right = 1 if total > 0 else -1
    for j in range(d):
        below, mass_below = 0.0, 0.0
        for k in range(n - 1):
            below += signed[order[j, k]]
            mass_below += weights[order[j, k]]
            if values[j, k] < values[j, k + 1]:
                above, mass_above = total - below, mass - mass_below
                if mass_below <= 0 or mass_above <= 0:
                    continue
                purity = below * below / mass_below + above * above / mass_above
                if purity > best + MARGIN:
                    best, feature, place = purity, j, k
                    left, right = 1 if below > 0 else -1, 1 if above > 0 else -1
    return feature, place, left, right
