"""The Gaussian kernel between vectors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy import sparse

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import DistanceKernel, Gram

from .columns import as_csr, products
from .pieces import sum_over_pieces


class RBF(DistanceKernel):
    """K(x, y) = exp(-gamma ||x - y||**2) between vectors: dense, sparse, or in parts that are.

    Parameters
    ----------
    gamma : float
        How fast likeness falls with distance. For the 182 laser features in [-1, 1] the paper's
        group came out between 0.018 and 0.1.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset(
        {FeatureKind.SPARSE, FeatureKind.DENSE, FeatureKind.PARTS}
    )

    def __init__(self, gamma: float = 0.05) -> None:
        super().__init__(gamma)

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the squared Euclidean distances, shape (n, m).

        Raises
        ------
        UsageError
            If a batch is a set of descriptors, or the two differ in their columns.
        DataError
            If a feature is NaN or infinite.
        """
        self.check(a, b)
        return sum_over_pieces(_squared, a, b)


def _squared(a: FeatureBatch, b: FeatureBatch | None, _: str) -> Gram:
    if sparse.issparse(a) or sparse.issparse(b):
        return _squared_sparse(as_csr(a), None if b is None else as_csr(b))
    # One sample after another comes by here, so scikit-learn's checks are left out.
    x = np.asarray(a, dtype=np.float64)
    y = x if b is None else np.asarray(b, dtype=np.float64)
    with np.errstate(over="ignore", invalid="ignore"):  # whoever asked says what is too large
        squared: Gram = x @ y.T
        squared *= -2
        squared += np.einsum("ij,ij->i", x, x)[:, None]
        squared += np.einsum("ij,ij->i", y, y)
    if not np.isfinite(squared).all() and not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise DataError("the rbf kernel cannot compare vectors that hold NaN or infinity")
    np.maximum(squared, 0, out=squared)
    if b is None:
        np.fill_diagonal(squared, 0)
    return squared


def _squared_sparse(a: sparse.csr_array, b: sparse.csr_array | None) -> Gram:
    of_b = a if b is None else b
    if not (np.isfinite(a.data).all() and np.isfinite(of_b.data).all()):
        raise DataError("the rbf kernel cannot compare these histograms: they hold NaN or infinity")
    lengths = [np.asarray(each.multiply(each).sum(axis=1)).ravel() for each in (a, of_b)]
    squared = np.add.outer(*lengths) - 2 * products(a, b)
    if b is None:
        np.fill_diagonal(squared, 0)
    return np.asarray(np.maximum(squared, 0, out=squared))
