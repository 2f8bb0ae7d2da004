"""Scalings of dense vectors, learned on training samples and kept as plain arrays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Self

import numpy as np
from numpy.typing import NDArray

from placecue.checks import check_whole
from placecue.estimator import Estimator

Matrix = NDArray[np.float64]

#: Rows that are mapped to quantiles at a time.
_ROWS = 64


class Scaling(Estimator, ABC):
    """Maps each column of a matrix by what was learned from training samples.

    What is learned is plain arrays under names that end in ``_``.
    """

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
    """To the training quantiles, in [-1, 1]; values outside the training range are clipped.

    Parameters
    ----------
    n_quantiles : int
        How many quantiles are kept of each column, 2 or more.
    """

    def __init__(self, n_quantiles: int = 100) -> None:
        self.n_quantiles = n_quantiles

    def check_parameters(self) -> None:  # noqa: D102
        check_whole("scaling.n_quantiles", self.n_quantiles, least=2)

    def fit(self, features: Matrix) -> Self:  # noqa: D102
        self.check_parameters()
        self.quantiles_ = np.quantile(features, np.linspace(0, 1, self.n_quantiles), axis=0)
        return self

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        # All columns at once, few rows at a time: a robot asks for one after the other.
        scaled = [
            self._levels(features[first : first + _ROWS])
            for first in range(0, len(features), _ROWS)
        ]
        return np.concatenate(scaled) if scaled else np.empty(features.shape)

    def _levels(self, features: Matrix) -> Matrix:
        quantiles = self.quantiles_[:, None]
        below = (quantiles < features).sum(axis=0)
        up_to = (quantiles <= features).sum(axis=0)
        last = len(self.quantiles_) - 1
        left = np.clip(below - 1, 0, last - 1)
        low, high = (np.take_along_axis(self.quantiles_, each, 0) for each in (left, left + 1))
        step = np.divide(features - low, high - low, out=np.zeros(features.shape), where=high > low)
        between = np.where(below > last, last, left + np.clip(step, 0, 1))
        # A value that is a quantile, perhaps several, gets the middle of its plateau.
        place = np.where(up_to > below, (below + up_to - 1) / 2, between)
        return np.asarray(2 * place / last - 1)
