"""Numbers that sum up rows of values, finite for every input."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

#: Below this share of its natural size a quantity is rounding noise, and counts as zero.
NOISE = 1e-12
#: Lengths (m) and areas (m**2) below this count as zero: their squares vanish in a float.
TINY = 1e-150


def ratio(above: Matrix, below: Matrix, noise: Matrix | float = 0.0) -> Matrix:
    """Return above / below, and 0 where ``below`` is no larger than ``noise``."""
    above, below = np.broadcast_arrays(above, below)
    return np.divide(above, below, out=np.zeros(above.shape), where=np.abs(below) > noise)


def mean_std(values: Matrix) -> Matrix:
    """Return mean and standard deviation (by n) of each row, shape (n, 2); 0 for empty rows."""
    if values.shape[1] == 0:
        return np.zeros((len(values), 2))
    return np.column_stack([values.mean(axis=1), values.std(axis=1)])


def kurtosis(values: Matrix) -> Matrix:
    """Return m4 / std**4 of each row (not the excess), shape (n, 1); 0 where all are equal."""
    centred = values - values.mean(axis=1, keepdims=True)
    variance = np.mean(centred**2, axis=1, keepdims=True)
    noise = (NOISE * np.abs(values).max(axis=1, keepdims=True)) ** 2
    # Dividing before taking the fourth power keeps tiny and huge ranges representable.
    return np.asarray(np.mean(ratio(centred**2, variance, noise) ** 2, axis=1, keepdims=True))


def below(values: Matrix, thresholds: Sequence[float]) -> Matrix:
    """Return how many values of each row are less than each threshold, shape (n, thresholds)."""
    return _counts(values[:, None, :] < np.asarray(thresholds, dtype=np.float64)[:, None])


def above(values: Matrix, thresholds: Sequence[float]) -> Matrix:
    """Return how many values of each row are more than each threshold, shape (n, thresholds)."""
    return _counts(values[:, None, :] > np.asarray(thresholds, dtype=np.float64)[:, None])


def _counts(hits: NDArray[np.bool_]) -> Matrix:
    return np.asarray(np.count_nonzero(hits, axis=2), dtype=np.float64)
