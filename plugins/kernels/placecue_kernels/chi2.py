"""The chi-squared kernel between histograms."""

from __future__ import annotations

from typing import Any, ClassVar, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import sparse

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import DistanceKernel, Gram

from .columns import as_csr, check_same_width
from .inverted_index import index_of

#: Starts, indices and values of compressed rows or columns.
Arrays: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]]
Places: TypeAlias = NDArray[np.int32]


class Chi2(DistanceKernel):
    """K(x, y) = exp(-gamma sum_k (x_k - y_k)**2 / (x_k + y_k)), over bins where x_k + y_k > 0.

    Histograms are sparse or dense and not negative; for the usual gammas they sum to one, which
    makes the distance lie in [0, 2]. Only bins that two samples share are looked at, as the
    distance is sum x + sum y - 4 sum x y / (x + y).

    Parameters
    ----------
    gamma : float
        How fast likeness falls with distance; the paper's group searched 0.001 to 31.6.

    References
    ----------
    Chapelle, Haffner and Vapnik, Support vector machines for histogram-based image
    classification, IEEE Transactions on Neural Networks 10(5), 1999.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.SPARSE, FeatureKind.DENSE})

    def __init__(self, gamma: float = 2.0) -> None:
        super().__init__(gamma)

    def distances(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the chi-squared distances, shape (n, m).

        The index of ``b`` (of ``a`` without ``b``) is kept while that object lives, so that
        further calls with it are quick.

        Raises
        ------
        UsageError
            If a batch is of another kind, or the two differ in their columns.
        DataError
            If a histogram holds a negative number or NaN.
        """
        self.check(a, b)
        index = index_of(a if b is None else b)
        _check_histograms(index.smallest)
        postings, places, common = _arrays(index.postings), index.common_places, index.common
        if b is None:
            shared = _shared_within(_arrays(index.rows), postings, places, common)
            return _without_diagonal(_from_shared(shared, index.totals, index.totals))
        check_same_width(a, b)
        rows = as_csr(a)
        _check_histograms(float(rows.data.min(initial=np.inf)))
        shared = _shared_between(_arrays(index.place(rows)), postings, places, common)
        return _from_shared(shared, rows.sum(axis=1), index.totals)


def _check_histograms(smallest: float) -> None:
    if not smallest >= 0:
        raise DataError(
            f"the chi2 kernel compares histograms, got the value {smallest:g}: "
            "choose rbf or linear for features that may be negative"
        )


def _arrays(rows: sparse.csr_array | sparse.csc_array) -> Arrays:
    """Return starts, indices and values, of the types that the compiled loops are made for."""
    starts = rows.indptr.astype(np.int64, copy=False)
    return starts, rows.indices.astype(np.int32, copy=False), rows.data


def _from_shared(shared: Gram, a: NDArray[np.float64], b: NDArray[np.float64]) -> Gram:
    """Return max(sum a + sum b - 4 shared, 0), in the memory of ``shared``."""
    shared *= -4
    shared += a[:, None]
    shared += b[None, :]
    return np.maximum(shared, 0, out=shared)


def _without_diagonal(distances: Gram) -> Gram:
    """Set the distance of each sample from itself to an exact 0."""
    np.fill_diagonal(distances, 0)
    return distances


# error_model: no test for a division by zero in the inner loops, where x + y is above 0.
@njit(cache=True, nogil=True, error_model="numpy")
def _meet_all(row: NDArray[Any], x: float, values: NDArray[Any]) -> None:
    """Add x y / (x + y) to ``row`` for a column that is stored whole."""
    for q in range(len(row)):
        y = values[q]
        row[q] += x * y / (x + y)


@njit(cache=True, nogil=True, error_model="numpy")
def _meet_some(
    row: NDArray[Any], x: float, rows: NDArray[Any], values: NDArray[Any], terms: NDArray[Any]
) -> None:
    """Add x y / (x + y) to ``row`` for the samples in a column's postings."""
    # Two loops: the divisions go several at a time when nothing is scattered between them.
    for q in range(len(rows)):
        y = values[q]
        terms[q] = x * y / (x + y)
    for q in range(len(rows)):
        row[rows[q]] += terms[q]


@njit(cache=True, nogil=True)
def _shared_between(rows: Arrays, postings: Arrays, places: Places, common: Gram) -> Gram:
    """Return sum_k x_k y_k / (x_k + y_k) for n rows against m indexed ones, shape (n, m)."""
    starts, columns, values = rows
    post_starts, post_rows, post_values = postings
    n, m = len(starts) - 1, common.shape[1]
    shared, terms = np.zeros((n, m)), np.empty(m)
    for i in range(n):
        for p in range(starts[i], starts[i + 1]):
            x, column = values[p], columns[p]
            if x == 0.0:
                continue
            if places[column] >= 0:
                _meet_all(shared[i], x, common[places[column]])
            else:
                first, last = post_starts[column], post_starts[column + 1]
                _meet_some(shared[i], x, post_rows[first:last], post_values[first:last], terms)
    return shared


@njit(cache=True, nogil=True)
def _shared_within(rows: Arrays, postings: Arrays, places: Places, common: Gram) -> Gram:
    """Return the same for indexed rows among themselves: each pair once, mirrored; no diagonal."""
    starts, columns, values = rows
    post_starts, post_rows, post_values = postings
    n = len(starts) - 1
    shared, terms = np.zeros((n, n)), np.empty(n)
    after = post_starts[:-1].copy()
    for i in range(n):
        for p in range(starts[i], starts[i + 1]):
            x, column = values[p], columns[p]
            # Rows come in order, so this row is the first of the column's postings not yet met.
            after[column] += 1
            if x == 0.0:
                continue
            if places[column] >= 0:
                _meet_all(shared[i, i + 1 :], x, common[places[column], i + 1 :])
            else:
                first, last = after[column], post_starts[column + 1]
                _meet_some(shared[i], x, post_rows[first:last], post_values[first:last], terms)
        for j in range(i):
            shared[i, j] = shared[j, i]
    return shared
