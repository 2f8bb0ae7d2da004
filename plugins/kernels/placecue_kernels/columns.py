"""Batches over columns: sparse ones may run into billions, and only the occupied ones are kept."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.errors import UsageError
from placecue.features import FeatureBatch
from placecue.kernel import Gram

Columns = NDArray[np.integer]


def as_csr(batch: FeatureBatch) -> sparse.csr_array:
    """Return a dense or sparse batch as canonical float64 CSR, shape (n, d), copying if need be."""
    rows = sparse.csr_array(batch, dtype=np.float64)
    if not rows.has_canonical_format:
        rows = rows.copy()
        rows.sum_duplicates()
    return rows


def check_same_width(a: FeatureBatch, b: FeatureBatch) -> None:
    """Raise UsageError unless the samples of both batches have equally many columns."""
    if a.shape[1] != b.shape[1]:
        raise UsageError(
            f"a kernel between samples of {a.shape[1]} and of {b.shape[1]} columns: both batches "
            "must come from the same cue with the same parameters"
        )


def products(a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
    """Return the dot products of n and m dense or sparse vectors, shape (n, m).

    Without ``b`` those of ``a`` with itself.
    """
    b = a if b is None else b
    if not sparse.issparse(a) and not sparse.issparse(b):
        return np.asarray(a, dtype=np.float64) @ np.asarray(b, dtype=np.float64).T
    # The transpose of a sparse batch would hold a pointer for each of perhaps 28**6 columns.
    right, columns = compress(as_csr(b))
    left = right if a is b else restrict(as_csr(a), columns)
    return np.asarray((left @ right.T).toarray())


def compress(rows: sparse.csr_array) -> tuple[sparse.csr_array, Columns]:
    """Renumber the columns so that empty ones take no room.

    Parameters
    ----------
    rows : csr_array of shape (n, d)

    Returns
    -------
    csr_array of shape (n, k)
        The same rows over the k occupied columns.
    ndarray of int, shape (k,)
        The occupied columns, sorted.
    """
    occupied = np.unique(rows.indices)
    places = np.searchsorted(occupied, rows.indices).astype(np.int32)
    narrow = (rows.data, places, rows.indptr)
    return sparse.csr_array(narrow, shape=(rows.shape[0], len(occupied))), occupied


def restrict(rows: sparse.csr_array, columns: Columns) -> sparse.csr_array:
    """Return the given columns (sorted) of the rows, shape (n, len(columns)); drops the others."""
    places = np.searchsorted(columns, rows.indices)
    found = places < len(columns)
    found[found] = columns[places[found]] == rows.indices[found]
    before = np.concatenate([[0], np.cumsum(found)])
    kept = (rows.data[found], places[found].astype(np.int32), before[rows.indptr])
    return sparse.csr_array(kept, shape=(rows.shape[0], len(columns)))
