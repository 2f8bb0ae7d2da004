"""Training samples made ready for one kernel: scaled, with what all its Gram matrices share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from scipy import sparse

from placecue import contracts
from placecue.classifier import WrongKind
from placecue.errors import DataError, UsageError
from placecue.estimator import clone
from placecue.features import (
    Families,
    FeatureBatch,
    FeatureKind,
    FeatureParts,
    kind_of,
    n_samples,
    take,
)
from placecue.folds import Rows
from placecue.grams import current
from placecue.guard import call
from placecue.kernel import Gram, Kernel, fit_kernel
from placecue.ownership import provenance
from placecue.scaling import Scaling
from placecue_classifiers.grid import Setting

#: A scaling that has been fitted; of features in parts one for each dense part, by its name.
Fitted: TypeAlias = Scaling | dict[str, Scaling]


@dataclass(frozen=True)
class Prepared:
    """n training samples and a kernel fitted on them.

    Parameters
    ----------
    kernel : Kernel
        Fitted.
    scaling : Scaling, dict of str to Scaling, or None
        Of dense features, or of each dense part, fitted.
    features : batch of n samples
        Scaled.
    shared : object
        What Gram matrices for other light parameters of the kernel share; None where there is only
        one, or where Gram blocks are kept.
    only : ndarray of float64, shape (n, n), or None
        The only Gram matrix.
    """

    kernel: Kernel
    scaling: Fitted | None
    features: FeatureBatch
    shared: Any
    only: Gram | None

    @classmethod
    def of(
        cls,
        features: FeatureBatch,
        kernel: Kernel,
        scaling: Scaling | None = None,
        rows: Rows | None = None,
        light: bool = False,
        families: Families | None = None,
        labels: Any = None,
    ) -> Prepared:
        """Fit copies of kernel and scaling.

        Parameters
        ----------
        features : batch of n samples
        kernel : Kernel
        scaling : Scaling, optional
        rows : ndarray of int64, optional
            The samples to fit on; all by default.
        light : bool
            Whether there will be Gram matrices for other light parameters of the kernel.
        families : sequence of str, optional
            The family of each feature, for a scaling; of features in parts by part.
        labels : ndarray, shape (n,), optional
            Their classes, for a kernel that learns from them.

        Raises
        ------
        UsageError
            If scaling or kernel cannot take this kind of features.
        """
        fitted = fitted_scaling(_of_rows(features, rows), scaling, families)
        if fitted is not None:
            features = transformed(fitted, features)
        kernel = clone(kernel)
        try:
            call(kernel, "check", features)
        except UsageError as error:
            raise WrongKind(str(error)) from error
        of_rows = labels if rows is None or labels is None else labels[rows]
        fit_kernel(kernel, _of_rows(features, rows), of_rows)
        if light and current().keeps:
            return cls(kernel, fitted, features, None, None)
        if light:
            return cls(kernel, fitted, features, current().shared(kernel, features), None)
        return cls(kernel, fitted, features, None, current().gram(kernel, features))

    def gram(self, light: Setting | None = None) -> Gram:
        """Return the Gram matrix, shape (n, n), with other light parameters of the kernel if any.

        Raises
        ------
        DataError
            If a value is not finite.
        """
        kernel = self.with_light(light)
        if self.only is not None:
            return _finite(self.only, kernel)
        if self.shared is None:
            return _finite(current().gram(kernel, self.features), kernel)
        n = n_samples(self.features)
        check = partial(contracts.scaled, shape=(n, n))
        return _finite(call(kernel, "from_shared", self.shared, check=check), kernel)

    def with_light(self, light: Setting | None = None) -> Kernel:
        """Return the fitted kernel, or a copy of it with light parameters as named in a grid."""
        if not light:
            return self.kernel
        named = {name.removeprefix("kernel__"): value for name, value in light.items()}
        changed: Kernel = deepcopy(self.kernel).set_params(**named)
        return changed


def remembering(make: Callable[[Setting], Prepared]) -> Callable[[Setting], Prepared]:
    """Return ``make`` such that it remembers what it returned last."""
    last: list[tuple[Setting, Prepared]] = []

    def prepared(setting: Setting) -> Prepared:
        if not last or last[0][0] != setting:
            last.clear()  # distances may be large: let go of them before others are computed
            last.append((setting, make(setting)))
        return last[0][1]

    return prepared


def fitted_scaling(
    features: FeatureBatch, scaling: Scaling | None, families: Families | None = None
) -> Fitted | None:
    """Return a copy of a scaling fitted on dense features, shape (n, d); None for none.

    Of features in parts a copy for each dense part, and for each sparse one where the scaling
    takes it; the others are left alone. ``families`` names
    the family of each feature, if that is known.

    Raises
    ------
    UsageError
        If there is nothing dense in the features.
    """
    if scaling is None:
        return None
    if not isinstance(scaling, Scaling):
        raise UsageError(f"scaling must be a Scaling, such as QuantileScaling(), got {scaling!r}")
    if isinstance(features, FeatureParts):
        scaled = {n: part for n, part in features.parts.items() if _takes(scaling, part)}
        of_part = families if isinstance(families, Mapping) else {}
        return {n: _fitted_on(part, scaling, of_part.get(n)) for n, part in scaled.items()}
    if not _takes(scaling, features):
        raise WrongKind(
            f"scaling {type(scaling).__name__} takes dense vectors, got {kind_of(features)}: "
            "choose scaling=null for this cue"
        )
    assert not isinstance(families, Mapping)  # which are of parts
    return _fitted_on(features, scaling, families)


def _takes(scaling: Scaling, features: FeatureBatch) -> bool:
    kind = kind_of(features)
    return kind is FeatureKind.DENSE or (scaling.takes_sparse and kind is FeatureKind.SPARSE)


def _fitted_on(part: FeatureBatch, scaling: Scaling, families: Sequence[str] | None) -> Scaling:
    copy: Scaling = clone(scaling)
    call(copy, "train", _matrix(part), families)
    return copy


def _matrix(part: FeatureBatch) -> Any:
    return part if sparse.issparse(part) else np.asarray(part, dtype=np.float64)


def transformed(scaling: Fitted, features: FeatureBatch) -> Any:
    """Return features scaled, checked: dense ones, shape (n, d), or the dense ones of parts."""
    if isinstance(scaling, Scaling):
        return _scaled(scaling, features)
    assert isinstance(features, FeatureParts)
    scaled = {name: _scaled(each, features.parts[name]) for name, each in scaling.items()}
    return FeatureParts({**features.parts, **scaled})


def _scaled(scaling: Scaling, features: FeatureBatch) -> Any:
    matrix = _matrix(features)

    def wrong(made: Any) -> str | None:
        if not sparse.issparse(matrix):
            return contracts.scaled(made, matrix.shape) or contracts.finite(made)
        if not sparse.issparse(made) or made.shape != matrix.shape:
            return f"made no sparse matrix of shape {matrix.shape} of one"
        return contracts.finite(made.data)

    return call(scaling, "transform", matrix, check=wrong)


def learns(kernel: Kernel, features: FeatureBatch) -> bool:
    """Tell whether a kernel learns anything from samples such as these."""
    if kernel.wants_labels:
        return True
    if type(kernel).fit is Kernel.fit:
        return False
    call(kernel, "check", features)
    return _has_learned(fit_kernel(clone(kernel), features))


def _of_rows(features: FeatureBatch, rows: Rows | None) -> FeatureBatch:
    return features if rows is None else take(features, rows)


def _has_learned(kernel: Kernel) -> bool:
    """Tell whether fitting left anything in a kernel, or in those that it joins."""
    own = {name: value for name, value in vars(kernel).items() if name.endswith("_")}
    joined = own.pop("kernels_", [])
    inside = joined.values() if isinstance(joined, Mapping) else joined
    return bool(own) or any(map(_has_learned, inside))


def _finite(gram: Gram, kernel: Kernel) -> Gram:
    if not np.isfinite(gram).all():
        raise DataError(
            f"{provenance(kernel)} of these features is not finite: they are too large; "
            "scale them, for example with scaling=standard"
        )
    return np.ascontiguousarray(gram)
