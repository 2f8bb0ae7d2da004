"""A kernel for each part of features in parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from placecue.checks import check_choice
from placecue.errors import UsageError
from placecue.features import FeatureBatch, FeatureKind, FeatureParts, kind_of
from placecue.kernel import Gram, Kernel

from .chi2 import Chi2
from .composite import PRODUCT, SUM, Composite, Operations, fitted_copy
from .match import Match
from .rbf import RBF

JOINS: dict[str, Operations] = {"sum": SUM, "product": PRODUCT}


def suited_to(part: FeatureBatch) -> Kernel:
    """Return what a part gets where no kernels are given.

    That is chi2 for sparse histograms, match for sets of descriptors, and for dense vectors rbf
    with a gamma of 1 over the sum of the columns' variances, as scikit-learn's ``scale``.
    """
    if kind_of(part) is FeatureKind.DENSE:
        spread = float(np.var(np.asarray(part, dtype=np.float64), axis=0).sum())
        return RBF(1 / spread if spread > 0 else 1.0)
    return Chi2() if kind_of(part) is FeatureKind.SPARSE else Match()


class OfParts(Composite):
    """A kernel for each part of features in parts, joined into one.

    Attributes
    ----------
    kernels_ : dict of str to Kernel
        The kernels by part, fitted on training features.
    gammas_ : dict of str to float
        Those that were learned, of ``rbf`` by default; there only where no kernels are given.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.PARTS})
    kernels: Mapping[str, Kernel] | None
    kernels_: dict[str, Kernel]

    def check_parameters(self) -> None:  # noqa: D102
        for name, kernel in self._by_name(self.kernels).items():
            if not isinstance(kernel, Kernel) or "__" in name:
                raise UsageError(
                    f"kernel {self._name} takes kernels by the names of parts, such as "
                    f"kernels={{crfh: chi2, laser: rbf}}, got {kernel!r} for {name!r}"
                )

    def check(self, *batches: FeatureBatch | None) -> None:
        """Raise UsageError unless the features have a part for each kernel, of a kind it takes."""
        for batch in batches:
            if batch is None:
                continue
            if not isinstance(batch, FeatureParts):
                raise self._wrong_kind(str(kind_of(batch)))
            if self._in_use:
                self._check_kernels(batch)

    @property
    def positive_definite(self) -> bool:  # type: ignore[override]
        """Whether every Gram matrix is positive semi-definite; not before kernels are chosen."""
        return bool(self._in_use) and super().positive_definite

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> list[Any]:
        """Return what the kernels share each."""
        self.check(a, b)
        return super().shared(a, b)

    def _grams(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Iterable[Gram]:
        self.check(a, b)
        return super()._grams(a, b)

    def _check_kernels(self, batch: FeatureParts) -> None:
        if self._in_use.keys() != batch.parts.keys():
            raise UsageError(
                f"kernel {self._name} has kernels for the parts {', '.join(self._in_use)}, and the "
                f"features have the parts {', '.join(batch.parts)}: give one for each of these"
            )
        for name, kernel in self._in_use.items():
            try:
                kernel.check(batch.parts[name])
            except UsageError as error:
                raise UsageError(f"part '{name}': {error}") from error

    def _by_name(self, kernels: Any) -> dict[str, Kernel]:
        return dict(kernels or {})

    def _fitted(self, features: FeatureBatch, labels: Any) -> dict[str, Kernel]:
        self.check(features)
        assert isinstance(features, FeatureParts)
        kernels = self._by_name(self.kernels)
        if not kernels:
            kernels = {name: suited_to(part) for name, part in features.parts.items()}
            self.gammas_ = {n: each.gamma for n, each in kernels.items() if isinstance(each, RBF)}
        parts = features.parts
        return {name: fitted_copy(each, parts[name], labels) for name, each in kernels.items()}

    def _seen(self, batch: FeatureBatch, name: str) -> FeatureBatch:
        assert isinstance(batch, FeatureParts)
        return batch.parts[name]

    def _checked_weights(self, names: Sequence[str]) -> list[float]:
        if not names:
            raise UsageError(
                f"kernel {self._name} chooses its kernels in training: fit it first, or give them, "
                "such as kernels={crfh: chi2, laser: rbf}"
            )
        return super()._checked_weights(names)


class Parts(OfParts):
    """A kernel for each part of features in parts, in a weighted sum or product.

    The product of ``rbf`` over all parts is ``rbf`` on the joined vector, with a gamma a part.

    Parameters
    ----------
    kernels : mapping of str to Kernel, optional
        One for each part, by its name; by default those that :func:`suited_to` returns.
    weights : mapping of str to float, optional
        One for each part, not negative; by default all are 1. In a product they are powers, for
        kernels whose powers are kernels: chi2 and rbf, for which they multiply gamma.
    join : {"sum", "product"}
        How the kernels are joined.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 6.4 (low-level integration).
    """

    def __init__(
        self,
        kernels: Mapping[str, Kernel] | None = None,
        weights: Mapping[str, float] | None = None,
        join: str = "sum",
    ) -> None:
        self.kernels = kernels
        self.weights = weights
        self.join = join

    def check_parameters(self) -> None:  # noqa: D102
        check_choice("kernel.join", self.join, tuple(JOINS))
        super().check_parameters()
        if self.kernels and self.weights is not None:
            self._checked_weights(list(self.kernels))

    @property
    def _operations(self) -> Operations:
        return JOINS[self.join]

    def _ordered_weights(self, names: Sequence[str]) -> list[float]:
        if self.weights.keys() != {*names}:
            raise UsageError(
                f"kernel parts has kernels for the parts {', '.join(names)}, and weights for "
                f"{', '.join(self.weights)}: give one for each of them"
            )
        return [self.weights[name] for name in names]
