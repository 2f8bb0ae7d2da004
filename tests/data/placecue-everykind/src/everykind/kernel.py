"""A kernel."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from placecue import FeatureBatch, FeatureKind, Gram, Kernel


class Laplace(Kernel):
    """exp(-gamma |a - b|_1) between dense vectors."""

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.DENSE})

    def __init__(self, gamma: float = 0.5) -> None:
        self.gamma = gamma

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel between every sample of ``a`` and of ``b``, shape (n, m)."""
        self.check(a, b)
        first = np.asarray(a)
        second = first if b is None else np.asarray(b)
        distances = np.abs(first[:, None] - second[None]).sum(axis=2)
        return np.asarray(np.exp(-self.gamma * distances))
