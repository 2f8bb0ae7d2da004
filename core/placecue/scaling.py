"""Scalings of dense vectors, learned on training samples and kept as plain arrays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Self

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices

Matrix = NDArray[np.float64]


class Scaling(ABC):
    """Maps each column of a matrix by what was learned from training samples."""

    @abstractmethod
    def fit(self, features: Matrix) -> Self:
        """Learn from training samples, shape (n, d)."""

    @abstractmethod
    def transform(self, features: Matrix) -> Matrix:
        """Return the samples scaled, shape (n, d)."""


class RangeScaling(Scaling):
    """To [-1, 1] by the training minimum and maximum, not clipped; a constant column becomes 0.

    What the paper's group does before an SVM (the ``scaling`` files of its trained models).
    """

    def fit(self, features: Matrix) -> Self:  # noqa: D102
        low, high = features.min(axis=0), features.max(axis=0)
        half = (high - low) / 2
        self.center_ = (high + low) / 2
        self.scale_ = np.where(half > 0, half, np.inf)
        return self

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        return np.asarray((features - self.center_) / self.scale_)


class StandardScaling(Scaling):
    """To zero mean and unit variance; a constant column becomes 0."""

    def fit(self, features: Matrix) -> Self:  # noqa: D102
        deviation = features.std(axis=0)
        self.center_ = features.mean(axis=0)
        self.scale_ = np.where(deviation > 0, deviation, np.inf)
        return self

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        return np.asarray((features - self.center_) / self.scale_)


class QuantileScaling(Scaling):
    """To the training quantiles, in [-1, 1]; values outside the training range are clipped."""

    n_quantiles = 100

    def fit(self, features: Matrix) -> Self:  # noqa: D102
        self.quantiles_ = np.quantile(features, np.linspace(0, 1, self.n_quantiles), axis=0)
        return self

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        levels = np.linspace(-1, 1, len(self.quantiles_))
        scaled = np.empty(features.shape)
        for column, quantiles in enumerate(self.quantiles_.T):
            # The mean of both directions puts ties in the middle of their plateau.
            up = np.interp(features[:, column], quantiles, levels)
            down = -np.interp(-features[:, column], -quantiles[::-1], levels)
            scaled[:, column] = (up + down) / 2
        return scaled


SCALINGS: dict[str, type[Scaling]] = {
    "range": RangeScaling,
    "standard": StandardScaling,
    "quantiles": QuantileScaling,
}


def scaling(name: str) -> Scaling:
    """Return an unfitted scaling by name.

    Raises
    ------
    UsageError
        If there is none of that name.
    """
    if name not in SCALINGS:
        raise UsageError(f"unknown scaling '{name}'; {choices(name, SCALINGS)}, or null for none")
    return SCALINGS[name]()
