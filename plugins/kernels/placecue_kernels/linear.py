"""The linear kernel between vectors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from placecue.errors import DataError
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import Gram, Kernel

from .columns import products
from .pieces import sum_over_pieces


class Linear(Kernel):
    """K(x, y) = sum_k x_k y_k between vectors: dense, sparse, or in parts that are."""

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset(
        {FeatureKind.SPARSE, FeatureKind.DENSE, FeatureKind.PARTS}
    )

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
        found = sum_over_pieces(lambda one, other, _: products(one, other), a, b)
        if np.isnan(found).any():
            raise DataError("the linear kernel multiplies numbers, got NaN")
        return found
