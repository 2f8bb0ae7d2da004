"""Scalings of dense vectors, learned on training samples and kept as plain arrays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue import contracts
from placecue.checks import check_number, check_whole
from placecue.errors import UsageError, choices
from placecue.estimator import Estimator, clone
from placecue.guard import call

Matrix = NDArray[np.float64]

#: Rows that are mapped to quantiles at a time.
_ROWS = 64


class Scaling(Estimator, ABC):
    """Maps each column of a matrix by what was learned from training samples.

    What is learned is plain arrays, or scalings, under names that end in ``_``.

    Attributes
    ----------
    takes_sparse : bool
        Whether it takes sparse matrices (``scipy.sparse.csr_array``) too, and leaves them sparse.
    """

    takes_sparse: ClassVar[bool] = False

    @abstractmethod
    def fit(self, features: Matrix) -> Self:
        """Learn from training samples, shape (n, d)."""

    def train(self, features: Matrix, families: Sequence[str] | None = None) -> Self:
        """Learn from training samples whose columns belong to families; what a classifier calls.

        Override it where that matters. The default calls :meth:`fit`.

        Parameters
        ----------
        features : ndarray of float64, shape (n, d)
        families : sequence of d names, optional
            The family of each column; see :attr:`placecue.Cue.families`.
        """
        return self.fit(features)

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


class _AfterAnother(Scaling):
    """Scales what another scaling, if any, has made of dense columns."""

    def __init__(self, scaling: Scaling | None = None) -> None:
        self.scaling = scaling

    def check_parameters(self) -> None:
        if self.scaling is not None and not isinstance(self.scaling, Scaling):
            raise UsageError(f"scaling.scaling must be a Scaling or None, got {self.scaling!r}")

    def fit(self, features: Matrix) -> Self:
        return self.train(features)

    def train(self, features: Matrix, families: Sequence[str] | None = None) -> Self:
        """Learn from training samples; see :meth:`Scaling.train`."""
        self.check_parameters()
        self.scaling_ = None
        if self.scaling is not None and not sparse.issparse(features):
            self.scaling_ = clone(self.scaling)
            call(self.scaling_, "train", features, families)
        return self

    def _columns(self, features: Matrix) -> Matrix:
        if self.scaling_ is None:
            return features
        check = partial(contracts.scaled, shape=features.shape)
        scaled: Matrix = call(self.scaling_, "transform", features, check=check)
        return scaled


class UnitLength(_AfterAnother):
    """Every sample to unit Euclidean length, after another scaling; one that is 0 stays so.

    What is left is the direction of a vector, which for the outputs of networks says more than how
    strong they are all together.

    Parameters
    ----------
    scaling : Scaling, optional
        Scales the columns first; none by default.

    Attributes
    ----------
    scaling_ : Scaling or None
        The fitted one.
    """

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        return unit_length(self._columns(features))


def unit_length(rows: Matrix) -> Matrix:
    """Return rows of unit Euclidean length, shape (n, d); a row of zeros stays."""
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(rows / np.where(lengths > 0, lengths, 1.0))


class UnitSpread(_AfterAnother):
    """Divides all columns by one number, so that their variances sum to one.

    The mean squared distance between samples is then 2, whatever the features are. Of features in
    parts that are joined to one vector each part so has the same say, sparse histograms too.

    Parameters
    ----------
    scaling : Scaling, optional
        Scales the columns of dense features first; none by default.

    Attributes
    ----------
    scaling_ : Scaling or None
        The fitted one.
    spread_ : ndarray of float64, shape (1,)
        What columns are divided by: the root of the sum of their variances; 1 where nothing varies.
    """

    takes_sparse: ClassVar[bool] = True

    def train(self, features: Matrix, families: Sequence[str] | None = None) -> Self:
        """Learn from training samples; see :meth:`Scaling.train`."""
        super().train(features, families)
        columns = self._columns(features)
        spread, rounding = np.sqrt(_total_variance(columns)), 1e-12 * abs(columns).max()
        self.spread_ = np.array([spread if spread > rounding else 1.0])
        return self

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        scaled: Matrix = self._columns(features) / self.spread_[0]
        return scaled


def _total_variance(features: Any) -> float:
    """Return the sum of the variances of the columns, of a sparse matrix too."""
    if not sparse.issparse(features):
        return float(features.var(axis=0).sum())
    # A CRFH has hundreds of millions of columns, of which few hold anything.
    held, n = features.tocoo(), features.shape[0]
    _, column, stored = np.unique(held.col, return_inverse=True, return_counts=True)
    means = np.bincount(column, held.data) / n
    of_stored = np.square(held.data - means[column]).sum()
    return float((of_stored + (n - stored) @ np.square(means)) / n)


class FamilyScaling(Scaling):
    """Gives every family of features the same weight, however many features it has.

    Another scaling first maps the columns to like ranges; each is then multiplied by sqrt(w / k),
    k the number of columns in its family and w the family's weight. So a family's part of a
    squared distance is a mean over its columns, not a sum. Columns without families are scaled as
    the other scaling does.

    Parameters
    ----------
    scaling : Scaling, optional
        Scales the columns first; the training quantiles by default.
    weights : mapping of str to float, optional
        Weights of families in a squared distance, such as ``{"fourier": 0.5}``; 1 where it says
        nothing, and 0 leaves a family out.

    Attributes
    ----------
    scaling_ : Scaling
        The fitted one.
    weights_ : ndarray of float64, shape (d,)
        What the scaled columns are multiplied by.
    """

    def __init__(
        self, scaling: Scaling | None = None, weights: Mapping[str, float] | None = None
    ) -> None:
        self.scaling = scaling
        self.weights = weights

    def check_parameters(self) -> None:  # noqa: D102
        if self.scaling is not None and not isinstance(self.scaling, Scaling):
            raise UsageError(f"scaling.scaling must be a Scaling or None, got {self.scaling!r}")
        if self.weights is not None and not isinstance(self.weights, Mapping):
            raise UsageError(
                f"scaling.weights must be numbers by family, such as {{fourier: 0.5}}, or None, "
                f"got {self.weights!r}"
            )
        for family, weight in (self.weights or {}).items():
            check_number(f"scaling.weights.{family}", weight, least=0)

    def fit(self, features: Matrix) -> Self:  # noqa: D102
        return self.train(features)

    def train(self, features: Matrix, families: Sequence[str] | None = None) -> Self:
        """Learn from training samples; see :meth:`Scaling.train`.

        Raises
        ------
        UsageError
            If a weight is for a family that is not there.
        """
        self.check_parameters()
        inner = QuantileScaling() if self.scaling is None else clone(self.scaling)
        call(inner, "train", features, families)
        self.scaling_ = inner
        self.weights_ = np.ones(features.shape[1])
        if families is not None:
            self.weights_ = self._weights_of(families)
        elif self.weights:
            raise UsageError(
                f"scaling.weights names {', '.join(self.weights)}, and the features are in no "
                "families: choose scaling.weights=null for this cue"
            )
        return self

    def transform(self, features: Matrix) -> Matrix:  # noqa: D102
        check = partial(contracts.scaled, shape=features.shape)
        scaled: Matrix = call(self.scaling_, "transform", features, check=check)
        return scaled * self.weights_

    def _weights_of(self, families: Sequence[str]) -> Matrix:
        """Return the factor of each column, shape (d,)."""
        names, of, sizes = np.unique(families, return_inverse=True, return_counts=True)
        given = self.weights or {}
        for family in given:
            if family not in names:
                known = choices(family, names.tolist())
                raise UsageError(f"scaling.weights has no family '{family}' to weigh; {known}")
        weights = np.array([given.get(name, 1.0) for name in names.tolist()], dtype=np.float64)
        return np.asarray(np.sqrt(weights / sizes)[of])
