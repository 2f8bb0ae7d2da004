"""A kernel: how alike two samples are."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError
from placecue.estimator import Estimator
from placecue.features import FeatureBatch, FeatureKind, FeatureParts, kind_of
from placecue.guard import call

Gram = NDArray[np.float64]


class Kernel(Estimator, ABC):
    """Gram blocks between batches of features.

    Attributes
    ----------
    accepts : frozenset of FeatureKind
        The kinds of features that the kernel can take. One that takes parts takes them as one
        joined vector, and each must be of another kind that it takes.
    wants_labels : bool
        Whether :meth:`fit` takes the classes of the training samples too:
        ``fit(features, labels)``, labels of shape (n,). Such a kernel is fitted in each fold anew.
    positive_definite : bool
        Whether every Gram matrix is positive semi-definite.
    version : str
        Changes when the results do, so that a model does not meet another kernel unawares.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset()
    wants_labels: ClassVar[bool] = False
    positive_definite: ClassVar[bool] = True
    version: ClassVar[str] = "1"

    def fit(self, features: FeatureBatch) -> Self:
        """Learn what the kernel needs from training features; the default learns nothing."""
        return self

    @abstractmethod
    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel between every sample of ``a`` and every sample of ``b``.

        Parameters
        ----------
        a, b : batch of n and of m samples
            Features; without ``b``, ``a`` against itself.

        Returns
        -------
        ndarray of float64, shape (n, m)

        Raises
        ------
        UsageError
            If the kernel cannot take this kind of features.
        """

    @property
    def light_parameters(self) -> tuple[str, ...]:
        """Parameters that neither :meth:`fit` nor :meth:`shared` depends on; cheap to search."""
        return ()

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        """Return what all settings of :attr:`light_parameters` share, in any form.

        Without such parameters that is the Gram block.
        """
        return self.gram(a, b)

    def from_shared(self, shared: Any) -> Gram:
        """Return the Gram block, shape (n, m), from what :meth:`shared` returned; keeps that."""
        gram: Gram = shared
        return gram

    def check(self, *batches: FeatureBatch | None) -> None:
        """Raise UsageError if a batch, or a part of one, is of a kind that it cannot take."""
        for batch in batches:
            if batch is None:
                continue
            if kind_of(batch) not in self.accepts:
                raise self._wrong_kind(str(kind_of(batch)))
            if isinstance(batch, FeatureParts):
                self._check_parts(batch)

    def _check_parts(self, batch: FeatureParts) -> None:
        for name, part in batch.parts.items():
            if kind_of(part) not in self.accepts:
                raise self._wrong_kind(f"{kind_of(part)} in part '{name}'")

    def _wrong_kind(self, got: str) -> UsageError:
        return UsageError(
            f"kernel {type(self).__name__} takes {' or '.join(sorted(self.accepts))}, got {got}: "
            "choose another kernel for this cue"
        )


def fit_kernel(kernel: Kernel, features: FeatureBatch, labels: Any = None) -> Kernel:
    """Fit a kernel on n training samples and return it; it gets labels if it wants them.

    Parameters
    ----------
    kernel : Kernel
    features : batch of n samples
    labels : array, shape (n,), optional
        Their classes.
    """
    call(kernel, "fit", *((features, labels) if kernel.wants_labels else (features,)))
    return kernel


class DistanceKernel(Kernel):
    """A kernel whose costly part, a distance, does not depend on its parameter ``gamma``.

    A search over gamma computes :meth:`shared`, the distances, once and :meth:`from_shared` for
    each gamma.

    Parameters
    ----------
    gamma : float
        How fast likeness falls with distance.
    """

    def __init__(self, gamma: float = 1.0) -> None:
        self.gamma = gamma

    @property
    def light_parameters(self) -> tuple[str, ...]:
        """Gamma."""
        return ("gamma",)

    @abstractmethod
    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        """Return the distances, which gamma does not enter, in any form :meth:`from_shared` takes.

        Parameters
        ----------
        a, b : batch of n and of m samples
            Features; without ``b``, ``a`` against itself.
        """

    def from_shared(self, shared: Any) -> Gram:
        """Return exp(-gamma * shared), shape (n, m); override where the form is another."""
        scaled: Gram = np.multiply(shared, -self.gamma)
        return np.exp(scaled, out=scaled)

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel between every sample of ``a`` and of ``b``; see :class:`Kernel`."""
        return self.from_shared(self.shared(a, b))
