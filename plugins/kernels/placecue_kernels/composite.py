"""Kernels made of kernels."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from typing import Any, Self, TypeAlias

import numpy as np

from placecue.errors import UsageError, choices
from placecue.estimator import clone
from placecue.features import FeatureBatch
from placecue.kernel import DistanceKernel, Gram, Kernel, fit_kernel

#: How a kernel is put under its weight, and how two weighted ones are joined.
Operations: TypeAlias = tuple[Callable[..., Gram], Callable[..., Gram]]
SUM: Operations = (np.multiply, np.add)
PRODUCT: Operations = (np.power, np.multiply)


class Composite(Kernel):
    """Several kernels, each with a name, joined into one.

    A subclass has the parameters ``kernels`` and ``weights`` and what is learned in ``kernels_``.
    """

    kernels: Any
    weights: Any

    @abstractmethod
    def _by_name(self, kernels: Any) -> dict[str, Kernel]:
        """Return kernels, as the parameter or what is learned holds them, by their names."""

    @abstractmethod
    def _fitted(self, features: FeatureBatch, labels: Any) -> Any:
        """Return fitted copies of the kernels, as ``kernels_`` holds them."""

    @abstractmethod
    def _seen(self, batch: FeatureBatch, name: str) -> FeatureBatch:
        """Return what the kernel of a name sees of a batch."""

    @abstractmethod
    def _ordered_weights(self, names: Sequence[str]) -> list[float]:
        """Return the weights of the named kernels, unchecked."""

    @property
    @abstractmethod
    def _operations(self) -> Operations:
        """How the kernels are joined."""

    @property
    def positive_definite(self) -> bool:  # type: ignore[override]
        """Whether every Gram matrix is positive semi-definite."""
        named = self._in_use
        if not all(each.positive_definite for each in named.values()):
            return False
        if self._operations is not PRODUCT or not named:
            return True
        powers = zip(named.values(), self._checked_weights(list(named)), strict=True)
        return all(
            isinstance(k, DistanceKernel) or float(power).is_integer() for k, power in powers
        )

    @property
    def wants_labels(self) -> bool:  # type: ignore[override]
        """Whether one of the kernels does."""
        return any(each.wants_labels for each in self._by_name(self.kernels).values())

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the parameters; also those of each kernel, as ``kernels__NAME__...``, if deep."""
        found: dict[str, Any] = super().get_params(deep=False)
        if deep:
            for name, kernel in self._by_name(self.kernels).items():
                inner = kernel.get_params().items()
                found |= {f"kernels__{name}__{parameter}": value for parameter, value in inner}
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
            _, kernel, inner = name.split("__", 2)
            for kernels in (self.kernels, getattr(self, "kernels_", None)):
                named = self._by_name(kernels)
                if kernel in named:
                    named[kernel].set_params(**{inner: value})
        return self

    @property
    def light_parameters(self) -> tuple[str, ...]:
        """The weights, and those of each kernel, as ``kernels__NAME__...``.

        None in a class with a :meth:`gram` of its own, unless :meth:`from_shared` goes with it.
        """
        own = type(self)
        if own.gram is not Composite.gram and own.from_shared is Composite.from_shared:
            return ()
        inside = (
            f"kernels__{name}__{parameter}"
            for name, kernel in self._by_name(self.kernels).items()
            for parameter in kernel.light_parameters
        )
        return ("weights", *inside)

    def fit(self, features: FeatureBatch, labels: Any = None) -> Self:
        """Fit a copy of every kernel on training features; labels are for those that want them."""
        self.kernels_ = self._fitted(features, labels)
        return self

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> list[Any]:
        """Return what the kernels share each."""
        return [each.shared(*self._pair(name, a, b)) for name, each in self._in_use.items()]

    def from_shared(self, shared: Sequence[Any]) -> Gram:
        """Return the composite kernel, shape (n, m), from what its kernels share."""
        kernels = self._in_use.values()
        return self._joined(k.from_shared(s) for k, s in zip(kernels, shared, strict=True))

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the composite kernel, shape (n, m).

        Raises
        ------
        UsageError
            If there is no kernel, the weights do not go with the kernels, or one of these cannot
            take the features.
        """
        return self._joined(self._grams(a, b))

    @property
    def _name(self) -> str:
        return type(self).__name__.lower()

    @property
    def _in_use(self) -> dict[str, Kernel]:
        return self._by_name(getattr(self, "kernels_", self.kernels))

    def _grams(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Iterable[Gram]:
        return (each.gram(*self._pair(name, a, b)) for name, each in self._in_use.items())

    def _pair(
        self, name: str, a: FeatureBatch, b: FeatureBatch | None
    ) -> tuple[FeatureBatch, FeatureBatch | None]:
        return self._seen(a, name), None if b is None else self._seen(b, name)

    def _joined(self, grams: Iterable[Gram]) -> Gram:
        weigh, join = self._operations
        weights = self._checked_weights(list(self._in_use))
        # One after the other: each may be large.
        return reduce(join, map(weigh, grams, weights))

    def _checked_weights(self, names: Sequence[str]) -> list[float]:
        if not names:
            raise UsageError(
                f"kernel {self._name} needs kernels, such as kernels=[{{plugin: chi2}}, "
                "{plugin: hi}]"
            )
        if self.weights is None:
            return [1.0] * len(names)
        weights = self._ordered_weights(names)
        if len(weights) != len(names) or not min(weights) >= 0:
            raise UsageError(
                f"kernel {self._name} has {len(names)} kernels and needs as many weights, none "
                f"negative, got {weights}"
            )
        return weights


def fitted_copy(kernel: Kernel, features: FeatureBatch, labels: Any = None) -> Kernel:
    """Return a copy of a kernel, fitted on n samples."""
    return fit_kernel(clone(kernel), features, labels)
