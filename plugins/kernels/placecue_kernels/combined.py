"""Sums and products of kernels."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from functools import reduce
from typing import Any, Self

import numpy as np

from placecue.errors import UsageError, choices
from placecue.estimator import clone
from placecue.features import FeatureBatch, FeatureKind
from placecue.kernel import DistanceKernel, Gram, Kernel


class Combined(Kernel):
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

    @property
    def positive_definite(self) -> bool:  # type: ignore[override]
        """Whether every Gram matrix is positive semi-definite."""
        return all(each.positive_definite for each in self.kernels)

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the parameters; also those of each kernel, as ``kernels__0__NAME``, if deep."""
        found: dict[str, Any] = super().get_params(deep=False)
        if deep:
            for number, kernel in enumerate(self.kernels):
                inner = kernel.get_params().items()
                found |= {f"kernels__{number}__{name}": value for name, value in inner}
        return found

    def set_params(self, **parameters: Any) -> Self:
        """Set parameters by the names of :meth:`get_params`."""
        for name, value in parameters.items():
            known = self.get_params()
            if name not in known:
                raise ValueError(f"{type(self).__name__} has no '{name}'; {choices(name, known)}")
            if "__" not in name:
                super().set_params(**{name: value})
                continue
            _, number, inner = name.split("__", 2)
            for kernels in (self.kernels, getattr(self, "kernels_", ())):
                for kernel in kernels[int(number) : int(number) + 1]:
                    kernel.set_params(**{inner: value})
        return self

    @property
    def light_parameters(self) -> tuple[str, ...]:
        """The weights, and those of each kernel, as ``kernels__0__NAME``.

        None in a class with a :meth:`gram` of its own, unless :meth:`from_shared` goes with it.
        """
        own = type(self)
        if own.gram is not Combined.gram and own.from_shared is Combined.from_shared:
            return ()
        inside = (
            f"kernels__{number}__{name}"
            for number, kernel in enumerate(self.kernels)
            for name in kernel.light_parameters
        )
        return ("weights", *inside)

    def check(self, *batches: FeatureBatch | None) -> None:
        """Raise UsageError if a batch is of a kind that one of the kernels cannot take."""
        for kernel in self.kernels:
            kernel.check(*batches)

    def fit(self, features: FeatureBatch) -> Self:
        """Fit a copy of every kernel on training features."""
        self.kernels_ = [clone(kernel).fit(features) for kernel in self.kernels]
        return self

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> list[Any]:
        """Return what the kernels share each."""
        return [kernel.shared(a, b) for kernel in self._in_use]

    def from_shared(self, shared: Sequence[Any]) -> Gram:
        """Return the combined kernel, shape (n, m), from what its kernels share."""
        return self._joined(k.from_shared(s) for k, s in zip(self._in_use, shared, strict=True))

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the combined kernel, shape (n, m).

        Raises
        ------
        UsageError
            If there is no kernel, the weights do not go with the kernels, or one of these cannot
            take the features.
        """
        return self._joined(kernel.gram(a, b) for kernel in self._in_use)

    @property
    def _in_use(self) -> Sequence[Kernel]:
        return getattr(self, "kernels_", self.kernels)

    def _joined(self, grams: Iterable[Gram]) -> Gram:
        weights = self._checked_weights()
        # One after the other: each may be large.
        return reduce(self._join, map(self._weighted, grams, weights))

    @abstractmethod
    def _weighted(self, gram: Gram, weight: float) -> Gram:
        """Return a kernel under its weight, and leave the kernel as it is."""

    @abstractmethod
    def _join(self, one: Gram, other: Gram) -> Gram:
        """Return two weighted kernels joined."""

    def _checked_weights(self) -> Sequence[float]:
        name = type(self).__name__.lower()
        if not len(self.kernels):
            raise UsageError(
                f"kernel {name} needs kernels, such as kernels=[{{plugin: chi2}}, {{plugin: hi}}]"
            )
        weights = [1.0] * len(self.kernels) if self.weights is None else self.weights
        if len(weights) != len(self.kernels) or not min(weights) >= 0:
            raise UsageError(
                f"kernel {name} has {len(self.kernels)} kernels and needs as many weights, none "
                f"negative, got {list(weights)}"
            )
        return weights


class Sum(Combined):
    """K(x, y) = sum_i weight_i K_i(x, y), which says whether any kernel finds samples alike."""

    def _weighted(self, gram: Gram, weight: float) -> Gram:
        return np.multiply(gram, weight)

    def _join(self, one: Gram, other: Gram) -> Gram:
        return np.add(one, other)


class Product(Combined):
    """K(x, y) = prod_i K_i(x, y)**weight_i, which says whether all kernels find samples alike.

    Weights other than 1 are for kernels whose powers are kernels: chi2 and rbf, for which they
    multiply gamma.
    """

    @property
    def positive_definite(self) -> bool:  # type: ignore[override]
        """Whether every Gram matrix is positive semi-definite."""
        powers = zip(self.kernels, self._checked_weights(), strict=True)
        safe = (isinstance(k, DistanceKernel) or float(power).is_integer() for k, power in powers)
        return super().positive_definite and all(safe)

    def _weighted(self, gram: Gram, weight: float) -> Gram:
        return np.power(gram, weight)

    def _join(self, one: Gram, other: Gram) -> Gram:
        return np.multiply(one, other)
