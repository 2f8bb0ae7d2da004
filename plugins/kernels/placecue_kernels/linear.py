"""The linear kernel between vectors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy import sparse

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import Gram, Kernel

from .columns import as_csr, check_same_width, compress, restrict


class Linear(Kernel):
    """K(x, y) = sum_k x_k y_k between dense or sparse vectors."""

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.SPARSE, FeatureKind.DENSE})

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the dot products, shape (n, m).

        Raises
        ------
        UsageError
            If a batch is a set of descriptors, or the two differ in their columns.
        DataError
            If a feature is NaN.
        """
        self.check(a, b)
        b = a if b is None else b
        check_same_width(a, b)
        products = self._products(a, b)
        if np.isnan(products).any():
            raise DataError("the linear kernel multiplies numbers, got NaN")
        return products

    @staticmethod
    def _products(a: FeatureBatch, b: FeatureBatch) -> Gram:
        if not sparse.issparse(a) and not sparse.issparse(b):
            return np.asarray(a, dtype=np.float64) @ np.asarray(b, dtype=np.float64).T
        # The transpose of a sparse batch would hold a pointer for each of perhaps 28**6 columns.
        right, columns = compress(as_csr(b))
        left = right if a is b else restrict(as_csr(a), columns)
        return np.asarray((left @ right.T).toarray())
