"""The histogram intersection kernel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind, kind_of
from placecue.kernel import Gram, Kernel

from .columns import as_csr, check_same_width
from .inverted_index import index_of
from .pieces import pieces, sum_over_pieces
from .shared import Term, shared_between, shared_within

Matrix: TypeAlias = NDArray[np.float64]


class HistogramIntersection(Kernel):
    """K(x, y) = sum_k min(x_k, y_k) between vectors: dense, sparse, or in parts that are.

    Only bins that two samples share are looked at, so values must not be negative. Dense vectors
    that may be (distances from hyperplanes, say) are shifted first: :meth:`fit` learns the
    minimum of each dimension over the training samples, and where it is negative it is
    subtracted; a value below it then counts as the minimum, which keeps the kernel positive
    semi-definite.

    Parameters
    ----------
    shift : bool
        Whether to shift dense vectors; sparse ones are never shifted, as 0 must stay 0.

    Attributes
    ----------
    minimum_ : ndarray of float64, shape (d,), or dict of str to such
        What is subtracted from each dimension, 0 or negative; of features in parts, by the names
        of the dense ones. Only where dense vectors were fitted.

    References
    ----------
    Barla, Odone and Verri, Histogram intersection kernel for image classification, ICIP 2003.
    The shift: our choice.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset(
        {FeatureKind.SPARSE, FeatureKind.DENSE, FeatureKind.PARTS}
    )

    def __init__(self, shift: bool = True) -> None:
        self.shift = shift

    def fit(self, features: FeatureBatch) -> Self:
        """Learn the minimum of each dimension of dense training features, shape (n, d)."""
        self.check(features)
        found = {
            name: np.minimum(np.asarray(piece, dtype=np.float64).min(axis=0), 0)
            for piece, _, name in pieces(features)
            if kind_of(piece) is FeatureKind.DENSE
        }
        if self.shift and found:
            self.minimum_ = found.get("", found)
        return self

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the intersections, shape (n, m).

        Raises
        ------
        UsageError
            If a batch is of another kind, or the two differ in their columns.
        DataError
            If a value is NaN, or negative and not shifted.
        """
        self.check(a, b)
        return sum_over_pieces(self._intersections, a, b)

    def _intersections(self, a: FeatureBatch, b: FeatureBatch | None, name: str) -> Gram:
        minimum = self._minimum(a, name)
        if minimum is not None:
            x = _shifted(a, minimum)
            return np.asarray(_smaller_sums(x, x if b is None else _shifted(b, minimum)))
        if b is None:
            index = index_of(a)
            _check(index.smallest)
            gram = shared_within(index, Term.SMALLER)
            np.fill_diagonal(gram, index.totals)
            return gram
        index, rows = index_of(b), as_csr(a)
        _check(index.smallest)
        _check(float(rows.data.min(initial=np.inf)))
        return shared_between(rows, index, Term.SMALLER)

    def _minimum(self, batch: FeatureBatch, name: str) -> Matrix | None:
        """Return what is to be subtracted, after which hardly a value is 0; None for nothing."""
        known = getattr(self, "minimum_", None)
        minimum: Matrix | None = known.get(name) if isinstance(known, Mapping) else known
        shifts = minimum is not None and kind_of(batch) is FeatureKind.DENSE and minimum.any()
        return minimum if shifts else None


def _shifted(batch: FeatureBatch, minimum: Matrix) -> Matrix:
    check_same_width(batch, minimum[None])
    shifted = np.maximum(np.asarray(batch, dtype=np.float64) - minimum, 0)
    _check(float(shifted.min(initial=np.inf)))
    return np.ascontiguousarray(shifted)


# reassoc: a sum in any order, so that several bins are added up at a time.
@njit(cache=True, nogil=True, fastmath={"reassoc"})
def _smaller_sums(a: Matrix, b: Matrix) -> Any:
    """Return sum_k min(a[i, k], b[j, k]), shape (n, m); neither holds NaN."""
    sums = np.empty((len(a), len(b)))
    for i in range(len(a)):
        for j in range(len(b)):
            total = 0.0
            for k in range(a.shape[1]):
                total += a[i, k] if a[i, k] < b[j, k] else b[j, k]
            sums[i, j] = total
    return sums


def _check(smallest: float) -> None:
    if not smallest >= 0:
        raise DataError(
            f"the hi kernel intersects histograms, got the value {smallest:g}: fit it on dense "
            "training features with shift on, or choose rbf or linear"
        )
