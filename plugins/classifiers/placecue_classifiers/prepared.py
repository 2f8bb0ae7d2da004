"""Training samples made ready for one kernel: scaled, with what all its Gram matrices share."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.base import clone

from placecue.classifier import WrongKind
from placecue.errors import DataError, UsageError
from placecue.features import FeatureBatch, FeatureKind, kind_of, take
from placecue.folds import Rows
from placecue.kernel import Gram, Kernel
from placecue.scaling import Scaling
from placecue_classifiers.grid import Setting


@dataclass(frozen=True)
class Prepared:
    """n training samples and a kernel fitted on them.

    Parameters
    ----------
    kernel : Kernel
        Fitted.
    scaling : Scaling or None
        Of dense features, fitted.
    features : batch of n samples
        Scaled.
    shared : object
        What Gram matrices for other light parameters of the kernel share; where there is only
        one, None.
    only : ndarray of float64, shape (n, n), or None
        The only Gram matrix.
    """

    kernel: Kernel
    scaling: Scaling | None
    features: FeatureBatch
    shared: Any
    only: Gram | None

    @classmethod
    def of(
        cls,
        features: FeatureBatch,
        kernel: Kernel,
        how: Scaling | None,
        rows: Rows | None = None,
        light: bool = False,
    ) -> Prepared:
        """Fit copies of the kernel and of the scaling ``how``.

        Parameters
        ----------
        features : batch of n samples
        kernel : Kernel
        how : Scaling or None
        rows : ndarray of int64, optional
            The samples to fit on; all by default.
        light : bool
            Whether there will be Gram matrices for other light parameters of the kernel.

        Raises
        ------
        UsageError
            If scaling or kernel cannot take this kind of features.
        """
        fitted = fitted_scaling(_of_rows(features, rows), how)
        if fitted is not None:
            features = fitted.transform(np.asarray(features))
        kernel = clone(kernel)
        try:
            kernel.check(features)
        except UsageError as error:
            raise WrongKind(str(error)) from error
        kernel.fit(_of_rows(features, rows))
        if light:
            return cls(kernel, fitted, features, kernel.shared(features), None)
        return cls(kernel, fitted, features, None, kernel.gram(features))

    @property
    def learned(self) -> bool:
        """Whether the Gram matrix depends on which samples it was prepared with."""
        return self.scaling is not None or _has_learned(self.kernel)

    def gram(self, light: Setting | None = None) -> Gram:
        """Return the Gram matrix, shape (n, n), with other light parameters of the kernel if any.

        Raises
        ------
        DataError
            If a value is not finite.
        """
        kernel = self.with_light(light)
        gram = kernel.from_shared(self.shared) if self.only is None else self.only
        return _finite(gram, kernel)

    def with_light(self, light: Setting | None = None) -> Kernel:
        """Return the fitted kernel, or a copy of it with light parameters as named in a grid."""
        if not light:
            return self.kernel
        named = {name.removeprefix("kernel__"): value for name, value in light.items()}
        changed: Kernel = deepcopy(self.kernel).set_params(**named)
        return changed


@dataclass
class Preparations:
    """Prepares the same samples for one kernel and scaling after another; remembers the last.

    Parameters
    ----------
    make : callable
        Prepares the samples for the parameters of a grid.
    """

    make: Callable[[Setting], Prepared]
    last: tuple[Setting, Prepared] | None = None

    def __call__(self, setting: Setting) -> Prepared:
        """Return the samples prepared for the given parameters of kernel and scaling."""
        if self.last is None or self.last[0] != setting:
            # The distances of the last one may be large: let go of them first.
            self.last = None
            self.last = setting, self.make(setting)
        return self.last[1]


def fitted_scaling(features: FeatureBatch, how: Scaling | None) -> Scaling | None:
    """Return a copy of the scaling ``how`` fitted on dense features, shape (n, d); None for none.

    Raises
    ------
    UsageError
        If the features are not dense.
    """
    if how is None:
        return None
    if not isinstance(how, Scaling):
        raise UsageError(f"scaling must be a Scaling, such as QuantileScaling(), got {how!r}")
    if kind_of(features) is not FeatureKind.DENSE:
        raise WrongKind(f"{type(how).__name__} takes dense vectors, got {kind_of(features)}")
    fitted: Scaling = clone(how)
    return fitted.fit(np.asarray(features))


def _of_rows(features: FeatureBatch, rows: Rows | None) -> FeatureBatch:
    return features if rows is None else take(features, rows)


def _has_learned(kernel: Kernel) -> bool:
    """Tell whether fitting left anything in a kernel, or in those that it joins."""
    own = {name: value for name, value in vars(kernel).items() if name.endswith("_")}
    joined = own.pop("kernels_", [])
    return bool(own) or any(map(_has_learned, joined))


def _finite(gram: Gram, kernel: Kernel) -> Gram:
    if not np.isfinite(gram).all():
        raise DataError(
            f"kernel {type(kernel).__name__} of these features is not finite: they are too large; "
            "scale them, for example with scaling=standard"
        )
    return np.ascontiguousarray(gram)
