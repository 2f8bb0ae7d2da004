"""Sums over the bins that two sparse samples share, by the inverted index of one batch."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import sparse

from placecue.kernel import Gram

from .inverted_index import InvertedIndex

#: Starts, indices and values of compressed rows or columns.
Arrays: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]]
Places: TypeAlias = NDArray[np.int32]


class Term(IntEnum):
    """What is summed over the shared bins x_k, y_k; both must not be negative."""

    HARMONIC = 0  # x y / (x + y)
    SMALLER = 1  # min(x, y)


def shared_between(rows: sparse.csr_array, index: InvertedIndex, term: Term) -> Gram:
    """Return the sums of n canonical rows against the m indexed ones, shape (n, m)."""
    postings, places, common = _arrays(index.postings), index.common_places, index.common
    return np.asarray(_between(_arrays(index.place(rows)), postings, places, common, int(term)))


def shared_within(index: InvertedIndex, term: Term) -> Gram:
    """Return the sums of the indexed rows among themselves, shape (n, n), with a 0 diagonal."""
    postings, places, common = _arrays(index.postings), index.common_places, index.common
    return np.asarray(_within(_arrays(index.rows), postings, places, common, int(term)))


def _arrays(rows: sparse.csr_array | sparse.csc_array) -> Arrays:
    """Return starts, indices and values, of the types that the compiled loops are made for."""
    starts = rows.indptr.astype(np.int64, copy=False)
    return starts, rows.indices.astype(np.int32, copy=False), rows.data


# error_model: no test for a division by zero in the inner loops, where x + y is above 0.
@njit(cache=True, nogil=True, error_model="numpy")
def _meet_all(row: NDArray[Any], x: float, values: NDArray[Any], term: int) -> None:
    """Add the terms to ``row`` for a column that is stored whole."""
    if term == 0:
        for q in range(len(row)):
            y = values[q]
            row[q] += x * y / (x + y)
    else:
        for q in range(len(row)):
            row[q] += min(x, values[q])


@njit(cache=True, nogil=True, error_model="numpy")
def _meet_some(
    row: NDArray[Any],
    x: float,
    rows: NDArray[Any],
    values: NDArray[Any],
    terms: NDArray[Any],
    term: int,
) -> None:
    """Add the terms to ``row`` for the samples in a column's postings."""
    # Two loops: the divisions go several at a time when nothing is scattered between them.
    if term == 0:
        for q in range(len(rows)):
            y = values[q]
            terms[q] = x * y / (x + y)
    else:
        for q in range(len(rows)):
            terms[q] = min(x, values[q])
    for q in range(len(rows)):
        row[rows[q]] += terms[q]


@njit(cache=True, nogil=True)
def _between(rows: Arrays, postings: Arrays, places: Places, common: Gram, term: int) -> Gram:
    """Return the sums of n rows against m indexed ones, shape (n, m)."""
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
                _meet_all(shared[i], x, common[places[column]], term)
            else:
                here = slice(post_starts[column], post_starts[column + 1])
                _meet_some(shared[i], x, post_rows[here], post_values[here], terms, term)
    return shared


@njit(cache=True, nogil=True)
def _within(rows: Arrays, postings: Arrays, places: Places, common: Gram, term: int) -> Gram:
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
                _meet_all(shared[i, i + 1 :], x, common[places[column], i + 1 :], term)
            else:
                here = slice(after[column], post_starts[column + 1])
                _meet_some(shared[i], x, post_rows[here], post_values[here], terms, term)
        for j in range(i):
            shared[i, j] = shared[j, i]
    return shared
