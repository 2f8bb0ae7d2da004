"""Sums and products of kernels on the same features."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import Kernel

from .composite import PRODUCT, SUM, Composite, Operations, fitted_copy


class Combined(Composite):
    """Several kernels on the same features, joined into one.

    Positive semi-definite if every one of them is.

    Parameters
    ----------
    kernels : sequence of Kernel
        The kernels; each must take the features.
    weights : sequence of float, optional
        One for each kernel, not negative; by default all are 1.

    Attributes
    ----------
    kernels_ : list of Kernel
        The kernels, fitted on training features.
    """

    def __init__(
        self, kernels: Sequence[Kernel] = (), weights: Sequence[float] | None = None
    ) -> None:
        self.kernels = kernels
        self.weights = weights

    @property
    def accepts(self) -> frozenset[FeatureKind]:  # type: ignore[override]
        """The kinds of features that every one of the kernels can take."""
        return frozenset(FeatureKind).intersection(*(each.accepts for each in self.kernels))

    def check(self, *batches: FeatureBatch | None) -> None:
        """Raise UsageError if a batch is of a kind that one of the kernels cannot take."""
        for kernel in self.kernels:
            kernel.check(*batches)

    def _by_name(self, kernels: Any) -> dict[str, Kernel]:
        return {str(number): each for number, each in enumerate(kernels or ())}

    def _fitted(self, features: FeatureBatch, labels: Any) -> list[Kernel]:
        return [fitted_copy(each, features, labels) for each in self.kernels]

    def _seen(self, batch: FeatureBatch, name: str) -> FeatureBatch:
        return batch

    def _ordered_weights(self, names: Sequence[str]) -> list[float]:
        return list(self.weights)


class Sum(Combined):
    """K(x, y) = sum_i weight_i K_i(x, y), which says whether any kernel finds samples alike."""

    @property
    def _operations(self) -> Operations:
        return SUM


class Product(Combined):
    """K(x, y) = prod_i K_i(x, y)**weight_i, which says whether all kernels find samples alike.

    Weights other than 1 are for kernels whose powers are kernels: chi2 and rbf, for which they
    multiply gamma.
    """

    @property
    def _operations(self) -> Operations:
        return PRODUCT
