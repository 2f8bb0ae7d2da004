"""Means over pairs, first within each world, then over the worlds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.evaluation.results.result import Pair, Result


class Average(NamedTuple):
    """A mean over pairs, elementwise.

    Parameters
    ----------
    mean : ndarray of float64
        Over the worlds, of the means over the pairs of each; NaN where nothing is defined.
    deviation : ndarray of float64
        The mean over the worlds of the (unbiased) standard deviation over the pairs of each; NaN
        where no world has two.
    pairs : ndarray of int64
        How many pairs there are a value of.
    """

    mean: NDArray[np.float64]
    deviation: NDArray[np.float64]
    pairs: NDArray[np.int64]


class Number(NamedTuple):
    """A mean over pairs of one number; see :class:`Average`."""

    mean: float
    deviation: float
    pairs: int


def averaged(pairs: Sequence[Pair], values: ArrayLike) -> Average:
    """Average values over pairs; undefined ones (NaN) are left out.

    Parameters
    ----------
    pairs : sequence of n Pair
        Where the values come from.
    values : array_like of float, shape (n, ...)
        One number or array a pair.
    """
    table = np.asarray(values, dtype=np.float64)
    worlds = np.array([pair.world for pair in pairs], dtype=object)
    within = [table[worlds == world] for world in dict.fromkeys(worlds)]
    return Average(
        _mean(np.stack([_mean(each) for each in within])),
        _mean(np.stack([_deviation(each) for each in within])),
        np.asarray(np.isfinite(table).sum(axis=0)),
    )


def average_score(results: Sequence[Result]) -> Number:
    """Return the average balanced accuracy, %; NaN of none."""
    if not results:
        return Number(float("nan"), float("nan"), 0)
    found = averaged([each.pair for each in results], [100 * each.score for each in results])
    return Number(float(found.mean), float(found.deviation), int(found.pairs))


def average_confusion(
    results: Sequence[Result], classes: Sequence[str] | None = None
) -> tuple[list[str], Average]:
    """Return the classes of some results, and which share of each was taken for which, %.

    Parameters
    ----------
    results : sequence of Result
        At least one.
    classes : sequence of str, optional
        Every class there is, where others' results have more than these.

    Returns
    -------
    list of M str
        Every class of every result, sorted.
    Average
        Of shape (M, M + 1): rows are the truth, the last column is undecided. A class that a
        recording does not have counts for nothing there.
    """
    names = list(classes or sorted({name for each in results for name in each.classes}))
    shares = [_shares(each, names) for each in results]
    return names, averaged([each.pair for each in results], shares)


def _shares(result: Result, classes: Sequence[str]) -> NDArray[np.float64]:
    """Return the rows of the confusion matrix, %, in the order of more classes than its own."""
    at = [classes.index(name) for name in result.classes]
    counts = np.zeros((len(classes), len(classes) + 1))
    counts[np.ix_(at, [*at, len(classes)])] = result.confusion
    return 100 * _divided(counts, counts.sum(axis=1, keepdims=True))


def _mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
    there = np.isfinite(values)
    return _divided(np.where(there, values, 0).sum(axis=0), there.sum(axis=0))


def _deviation(values: NDArray[np.float64]) -> NDArray[np.float64]:
    there = np.isfinite(values)
    squares = np.where(there, values - _mean(values), 0) ** 2
    return np.asarray(np.sqrt(_divided(squares.sum(axis=0), there.sum(axis=0) - 1)))


def _divided(above: Any, below: Any) -> NDArray[np.float64]:
    """Divide; NaN where nothing is below."""
    above, below = np.broadcast_arrays(np.asarray(above, dtype=np.float64), below)
    shares: NDArray[np.float64] = np.full(above.shape, np.nan)
    np.divide(above, below, out=shares, where=below > 0)
    return shares
