"""Multiple kernel learning: the weights of the parts' kernels are learned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from placecue.checks import check_choice, check_number
from placecue.errors import UsageError
from placecue.features import FeatureBatch
from placecue.kernel import Gram, Kernel

from .alignment import aligned
from .composite import SUM, Operations
from .easy_mkl import by_margin
from .parts import OfParts

METHODS = ("alignment", "easymkl")


class MKL(OfParts):
    """A weighted sum of a kernel for each part, with weights learned from the classes.

    The weights are such that the sum has a mean diagonal of 1 on the training samples: they add up
    to 1 where the kernels have it too, as chi2, rbf and match do. Where no kernel tells the
    classes apart they are even. In the folds of a search or of an integrator they are learned from
    the fold's training samples only.

    Parameters
    ----------
    kernels : mapping of str to Kernel, optional
        One for each part, by its name; by default those that :func:`parts.suited_to` returns.
    method : {"alignment", "easymkl"}
        Centred alignment with the classes, or EasyMKL, which looks at margins.
    regularization : float
        EasyMKL's: above 0 up to 1, where it looks at the means of classes alone.

    Attributes
    ----------
    weights_ : dict of str to float
        By part.

    References
    ----------
    Cortes, Mohri and Rostamizadeh, JMLR 13, 2012; Aiolli and Donini, Neurocomputing 169, 2015.
    """

    def __init__(
        self,
        kernels: Mapping[str, Kernel] | None = None,
        method: str = "alignment",
        regularization: float = 0.1,
    ) -> None:
        self.kernels = kernels
        self.method = method
        self.regularization = regularization

    def check_parameters(self) -> None:  # noqa: D102
        check_choice("kernel.method", self.method, METHODS)
        check_number("kernel.regularization", self.regularization, above=0, most=1)
        super().check_parameters()

    @property
    def wants_labels(self) -> bool:  # type: ignore[override]
        """It does: the weights are learned from them."""
        return True

    @property
    def light_parameters(self) -> tuple[str, ...]:
        """None: the weights depend on all of them."""
        return ()

    def fit(self, features: FeatureBatch, labels: Any = None) -> Self:
        """Fit the kernels, and learn their weights from n samples and their classes.

        Raises
        ------
        UsageError
            If there are no labels, or kernels and parts do not go together.
        """
        self.check_parameters()
        if labels is None:
            raise UsageError(
                "kernel mkl learns its weights from the classes of the samples: give fit the "
                "labels too, or use it in an svm"
            )
        super().fit(features, labels)
        _, codes = np.unique(np.asarray(labels), return_inverse=True)
        weights = self._learned(list(self._grams(features)), codes)
        self.weights_ = dict(zip(self.kernels_, weights.tolist(), strict=True))
        return self

    def _learned(self, grams: Sequence[Gram], codes: NDArray[np.int64]) -> NDArray[np.float64]:
        sizes = np.array([float(np.diagonal(gram).mean()) for gram in grams])
        sizes = np.where(sizes > 0, sizes, 1.0)
        grams = [gram / size for gram, size in zip(grams, sizes, strict=True)]
        if self.method == "easymkl":
            weights = by_margin(grams, codes, self.regularization)
        else:
            weights = aligned(grams, codes)
        if not weights.sum() > 0:
            weights = np.ones(len(grams))
        return np.asarray(weights / weights.sum() / sizes)

    @property
    def _operations(self) -> Operations:
        return SUM

    def _ordered_weights(self, names: Sequence[str]) -> list[float]:
        return [self.weights_[name] for name in names]

    def _checked_weights(self, names: Sequence[str]) -> list[float]:
        if not hasattr(self, "weights_"):
            raise UsageError("kernel mkl learns its weights in training: fit it first")
        return self._ordered_weights(names)
