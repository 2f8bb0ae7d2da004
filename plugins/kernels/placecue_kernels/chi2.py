"""The chi-squared kernel between histograms."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import DistanceKernel, Gram

from .columns import as_csr, check_same_width
from .inverted_index import index_of
from .shared import Term, shared_between, shared_within


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

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
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
        if b is None:
            common = shared_within(index, Term.HARMONIC)
            return _without_diagonal(_from_common(common, index.totals, index.totals))
        check_same_width(a, b)
        rows = as_csr(a)
        _check_histograms(float(rows.data.min(initial=np.inf)))
        common = shared_between(rows, index, Term.HARMONIC)
        return _from_common(common, rows.sum(axis=1), index.totals)


def _check_histograms(smallest: float) -> None:
    if not smallest >= 0:
        raise DataError(
            f"the chi2 kernel compares histograms, got the value {smallest:g}: "
            "choose rbf or linear for features that may be negative"
        )


def _from_common(common: Gram, a: NDArray[np.float64], b: NDArray[np.float64]) -> Gram:
    """Return max(sum a + sum b - 4 common, 0), in the memory of ``common``."""
    common *= -4
    common += np.add.outer(a, b)  # one sum, so that a Gram matrix is symmetric to the last digit
    return np.maximum(common, 0, out=common)


def _without_diagonal(distances: Gram) -> Gram:
    """Set the distance of each sample from itself to an exact 0."""
    np.fill_diagonal(distances, 0)
    return distances
