"""Support vector machine with the multi-class extensions of the paper."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone

from placecue.classifier import Classifier
from placecue.errors import DataError, UsageError, choices
from placecue.features import FeatureBatch, FeatureKind, kind_of, n_samples, take
from placecue.folds import FoldScheme, InterleavedChunks
from placecue.kernel import DistanceKernel, Gram, Kernel
from placecue.scaling import Scaling, scaling
from placecue.scores import Layout, ModifiedOneAgainstAll, OneAgainstAll, OneAgainstOne, Scores
from placecue_classifiers.machines import Machines, one_against_all, one_against_one
from placecue_classifiers.search import Grid, search

MULTICLASS = ("oao", "oaa", "modified_oaa")


class SVM(Classifier):
    """C-SVC on a precomputed kernel, by LIBSVM.

    Parameters
    ----------
    kernel : Kernel
        How alike two samples are.
    C : float
        Cost of a margin violation.
    multiclass : {"oaa", "oao", "modified_oaa"}
        One-against-all (M functions, the largest wins), one-against-one (M (M - 1) / 2 functions,
        majority vote), or modified one-against-all (the class whose training mean the output lies
        nearest).
    class_weight : {"balanced"} or None
        Weight classes by inverse frequency, or not.
    scaling : {"range", "standard", "quantiles"} or None
        Scaling of dense features, learned on the training samples.
    search : mapping, optional
        Values to try, ``{"C": [...], "gamma": [...]}``, by cross-validation on balanced accuracy.
        The Gram matrix is computed once for the whole grid. What is left out stays as given.
    n_folds : int
        Number of folds of the search.
    fold_seconds : float
        Length of the interleaved chunks that the folds are made of, s.

    Attributes
    ----------
    layout_ : Layout
        What the columns of the scores are.
    C_ : float
        The cost in use.
    kernel_ : Kernel
        The kernel in use.
    support_features_ : batch of k samples
        The union of the support vectors.
    coefficients_ : ndarray of float64, shape (k, V)
        Their signed dual coefficients.
    intercepts_ : ndarray of float64, shape (V,)
    search_ : dict of str to list
        For each point of the grid ``C``, ``gamma`` (if searched) and ``balanced_accuracy``.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 3.3; Pronobis and Caputo, IROS 2007 (modified
    one-against-all).
    """

    def __init__(
        self,
        kernel: Kernel | None = None,
        C: float = 100.0,
        multiclass: str = "oaa",
        class_weight: str | None = "balanced",
        scaling: str | None = None,
        search: Mapping[str, Sequence[float]] | None = None,
        n_folds: int = 5,
        fold_seconds: float = 2.0,
    ) -> None:
        self.kernel = kernel
        self.C = C
        self.multiclass = multiclass
        self.class_weight = class_weight
        self.scaling = scaling
        self.search = search
        self.n_folds = n_folds
        self.fold_seconds = fold_seconds

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Train on n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        UsageError
            If a parameter is not one of those above, or the kernel cannot take these features.
        DataError
            If there is one class only, or a feature is NaN or infinite.
        """
        self._check_parameters()
        names, codes = np.unique(np.asarray(labels, dtype=np.str_), return_inverse=True)
        if len(names) < 2:
            raise DataError(f"all {len(codes)} training samples are '{names[0]}': give two classes")
        self.scaling_ = self._fitted_scaling(features)
        features = self._prepared(features)
        kernel: Kernel = clone(self.kernel).fit(features)
        distances = kernel.distances(features) if isinstance(kernel, DistanceKernel) else None
        self.C_ = float(self.C)
        if self.search:
            grid = Grid.of(self.search, kernel, self.C_)
            splits = list(self._folds().split(np.asarray(labels), stamps))
            self.search_ = search(
                grid, lambda k: _gram(k, features, distances), codes, splits, self
            )
            best = int(np.argmax(self.search_["balanced_accuracy"]))
            self.C_ = self.search_["C"][best]
            if "gamma" in self.search_:
                kernel.set_params(gamma=self.search_["gamma"][best])
        self.kernel_ = kernel
        gram = _gram(kernel, features, distances)
        machines = self.machines(gram, codes, self.C_)
        self.layout_ = self.layout(names, machines, gram, codes)
        support = np.flatnonzero(np.any(machines.coefficients != 0, axis=1))
        self.support_features_ = take(features, support)
        self.coefficients_ = machines.coefficients[support]
        self.intercepts_ = machines.intercepts
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the V discriminant functions of n samples, shape (n, V)."""
        features = self._prepared(features)
        gram = self.kernel_.gram(features, self.support_features_)
        values = Machines(self.coefficients_, self.intercepts_).decide(gram)
        return Scores(values, self.layout_)

    def chosen(self) -> Self:
        """Return an unfitted copy with the C and gamma that the search found."""
        copy: Self = clone(self).set_params(search=None)
        if hasattr(self, "kernel_"):
            copy.set_params(C=self.C_, kernel=clone(self.kernel_))
        return copy

    def machines(self, gram: Gram, codes: NDArray[np.int64], C: float) -> Machines:
        """Train the binary machines on an (n, n) Gram matrix."""
        train = one_against_one if self.multiclass == "oao" else one_against_all
        return train(gram, codes, C, self.class_weight == "balanced")

    def layout(
        self, names: NDArray[np.str_], machines: Machines, gram: Gram, codes: NDArray[np.int64]
    ) -> Layout:
        """Return the layout that decides on the machines' outputs."""
        classes = tuple(str(name) for name in names)
        if self.multiclass == "oao":
            return OneAgainstOne(classes)
        if self.multiclass == "oaa":
            return OneAgainstAll(classes)
        outputs = machines.decide(gram)
        means = [float(outputs[codes == code, code].mean()) for code in range(len(classes))]
        return ModifiedOneAgainstAll(classes, tuple(means))

    def _check_parameters(self) -> None:
        if self.multiclass not in MULTICLASS:
            known = choices(self.multiclass, MULTICLASS)
            raise UsageError(f"unknown multiclass extension '{self.multiclass}'; {known}")
        if self.class_weight not in ("balanced", None):
            raise UsageError(f"class_weight is 'balanced' or null, not '{self.class_weight}'")
        if self.kernel is None:
            raise UsageError("an SVM needs a kernel, such as kernel={plugin: rbf}")
        if self.C <= 0:
            raise UsageError(f"C must be above 0, got {self.C}")

    def _folds(self) -> FoldScheme:
        return InterleavedChunks(n_folds=self.n_folds, seconds=self.fold_seconds)

    def _fitted_scaling(self, features: FeatureBatch) -> Scaling | None:
        if self.scaling is None:
            return None
        if kind_of(features) is not FeatureKind.DENSE:
            raise UsageError(
                f"scaling '{self.scaling}' takes dense vectors, got {kind_of(features)}"
            )
        return scaling(self.scaling).fit(_finite(features))

    def _prepared(self, features: FeatureBatch) -> FeatureBatch:
        if n_samples(features) == 0:
            raise DataError("there is no sample to classify")
        if kind_of(features) is FeatureKind.DENSE:
            features = _finite(features)
        return features if self.scaling_ is None else self.scaling_.transform(np.asarray(features))


def _finite(features: Any) -> NDArray[np.float64]:
    features = np.asarray(features, dtype=np.float64)
    bad = ~np.isfinite(features).all(axis=1)
    if bad.any():
        raise DataError(
            f"{int(bad.sum())} of {len(features)} samples hold NaN or infinite features, the first "
            f"is number {int(bad.argmax())}"
        )
    return features


def _gram(kernel: Kernel, features: FeatureBatch, distances: Any) -> Gram:
    if isinstance(kernel, DistanceKernel):
        return kernel.from_distances(distances)
    return kernel.gram(features)
