"""Which samples of a batch occupy each column, so that a query meets only what it shares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.features import FeatureBatch

from .columns import Columns, as_csr, compress, restrict
from .remembered import Remembered

#: Share of the samples from which on a column is also stored whole (measured on images).
COMMON_SHARE = 0.4


@dataclass(frozen=True, slots=True)
class InvertedIndex:
    """The samples of a batch by column.

    Parameters
    ----------
    columns : ndarray of int, shape (k,)
        The columns that some sample occupies, sorted.
    rows : csr_array of shape (n, k)
        The samples over these columns.
    postings : csc_array of shape (n, k)
        The same by column; the samples of a column are in increasing order.
    common : ndarray of float64, shape (h, n)
        The h columns that so many samples occupy that they are quicker to go through whole.
    common_places : ndarray of int32, shape (k,)
        The row of each column in ``common``, or -1.
    totals : ndarray of float64, shape (n,)
        The sum of each sample.
    smallest : float
        The smallest value of all; NaN where there is one.
    """

    columns: Columns
    rows: sparse.csr_array
    postings: sparse.csc_array
    common: NDArray[np.float64]
    common_places: NDArray[np.int32]
    totals: NDArray[np.float64]
    smallest: float

    @classmethod
    def build(cls, batch: FeatureBatch) -> InvertedIndex:
        """Index a dense or sparse batch of shape (n, d)."""
        rows, columns = compress(as_csr(batch))
        postings = rows.tocsc()
        common, places = _common(postings)
        smallest = float(rows.data.min(initial=np.inf))
        return cls(columns, rows, postings, common, places, rows.sum(axis=1), smallest)

    def place(self, batch: sparse.csr_array) -> sparse.csr_array:
        """Return another batch over the columns of this one, shape (m, k)."""
        return restrict(batch, self.columns)


def _common(postings: sparse.csc_array) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    occupancy = np.diff(postings.indptr)
    chosen = np.flatnonzero(occupancy >= COMMON_SHARE * postings.shape[0])
    places = np.full(len(occupancy), -1, dtype=np.int32)
    places[chosen] = np.arange(len(chosen))
    return np.ascontiguousarray(postings[:, chosen].T.toarray()), places


_remembered = Remembered(InvertedIndex.build)


def index_of(batch: FeatureBatch) -> InvertedIndex:
    """Return the index of a batch, built once for as long as that very object lives.

    The batch must not be written to in between.
    """
    return _remembered(batch)
