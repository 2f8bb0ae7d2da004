"""A scaling."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import NDArray

from placecue import Scaling


class Median(Scaling):
    """Less the median, by the mean deviation from it."""

    def __init__(self, floor: float = 1e-3) -> None:
        self.floor = floor

    def fit(self, features: NDArray[np.float64]) -> Self:
        """Learn from training samples, shape (n, d)."""
        self.median_ = np.median(features, axis=0)
        self.deviation_ = np.abs(features - self.median_).mean(axis=0)
        return self

    def transform(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the samples scaled, shape (n, d)."""
        return np.asarray((features - self.median_) / np.maximum(self.deviation_, self.floor))
