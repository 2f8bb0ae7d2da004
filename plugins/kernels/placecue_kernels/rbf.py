"""The Gaussian kernel between vectors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import DistanceKernel, Gram

from .columns import check_same_width


class RBF(DistanceKernel):
    """K(x, y) = exp(-gamma ||x - y||**2) between dense vectors.

    Parameters
    ----------
    gamma : float
        How fast likeness falls with distance. For the 182 laser features in [-1, 1] the paper's
        group came out between 0.018 and 0.1.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.DENSE})

    def __init__(self, gamma: float = 0.05) -> None:
        super().__init__(gamma)

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the squared Euclidean distances, shape (n, m).

        Raises
        ------
        UsageError
            If a batch is not dense, or the two differ in their columns.
        DataError
            If a feature is NaN or infinite.
        """
        self.check(a, b)
        if b is not None:
            check_same_width(a, b)
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
