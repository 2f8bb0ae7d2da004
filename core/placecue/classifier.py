"""A classifier: from the features of one cue to scores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from typing import Any, ClassVar, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from sklearn.base import BaseEstimator, ClassifierMixin, clone
from sklearn.exceptions import NotFittedError
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import column_or_1d, validate_data

from placecue.errors import DataError, UsageError
from placecue.features import FeatureBatch, FeatureKind, kind_of, n_samples, take
from placecue.folds import Rows
from placecue.scores import Layout, Scores

#: Features of all training samples by a copy of a cue that has learned from the given ones only.
FoldFeatures: TypeAlias = Callable[[Rows], FeatureBatch]


class UnfitSamples(DataError, ValueError, TypeError):
    """Samples that a classifier cannot learn from or score; scikit-learn expects such errors."""


class WrongKind(UsageError, ValueError):
    """Features of a kind that a classifier cannot take; scikit-learn expects a ValueError."""


class Classifier(ClassifierMixin, BaseEstimator, ABC):  # type: ignore[misc]
    """Scores the features of one cue: a scikit-learn classifier.

    No logic in ``__init__``; what is learned ends in ``_`` and is plain data (arrays, numbers,
    strings, lists, layouts, other components), so that a model folder can hold it.

    Attributes
    ----------
    layout_ : Layout
        What the columns of the scores are; set by :meth:`fit`.
    labels_ : ndarray, shape (M,)
        The classes as they were given in training, in the order of ``layout_.classes``; a
        classifier sets it with :meth:`learn_classes`, or leaves it out where labels are text.
    version : str
        Changes when the results do, so that a model does not meet another classifier unawares.
    """

    version: ClassVar[str] = "1"
    layout_: Layout
    labels_: NDArray[Any]

    @abstractmethod
    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Learn to tell the classes apart.

        Parameters
        ----------
        features : batch of n samples
            Features of the training samples.
        labels : array of str, shape (n,)
            Their classes.
        stamps : array of int, shape (n,), optional
            Their times, ns; folds of a parameter search are cut along them.
        """

    def fit_on_learned(
        self,
        features: FeatureBatch,
        labels: ArrayLike,
        stamps: ArrayLike | None,
        learned_from: FoldFeatures,
    ) -> Self:
        """Learn as :meth:`fit` does, from features of a cue that has learned from these samples.

        A codebook that was learned from a sample tells something of it. Override this where
        :meth:`fit` holds samples out, to search parameters, say: in such a fold take the features
        that ``learned_from`` returns. The default is :meth:`fit`.

        Parameters
        ----------
        features : batch of n samples
            By the cue as learned from all of them.
        labels : array of str, shape (n,)
        stamps : array of int, shape (n,), or None
        learned_from : callable
            Given the training rows of a fold, returns the features of all n samples by a copy of
            the cue that has learned from those rows only. Each call reads the samples again.
        """
        return self.fit(features, labels, stamps)

    @abstractmethod
    def scores(self, features: FeatureBatch) -> Scores:
        """Return the outputs for n samples, shape (n, V), with their layout."""

    @property
    def classes_(self) -> NDArray[Any]:
        """The classes, sorted, shape (M,)."""
        return self.labels_ if hasattr(self, "labels_") else np.asarray(self.layout_.classes)

    def predict(self, features: FeatureBatch) -> NDArray[Any]:
        """Return the class that the layout's rule picks for each sample, shape (n,)."""
        winner = self.scores(features).decide().ranking[:, 0]
        return np.asarray(self.classes_[winner])

    def chosen(self) -> Self:
        """Return an unfitted copy with what a parameter search found as fixed parameters.

        Out-of-fold scores are made with it, so that a search runs once and not once a fold.
        """
        copy: Any = clone(self)
        return copy  # type: ignore[no-any-return]

    def out_of_fold(
        self,
        features: FeatureBatch,
        labels: NDArray[np.str_],
        stamps: NDArray[np.int64] | None,
        splits: Iterable[tuple[Rows, Rows]],
    ) -> Iterator[tuple[Rows, NDArray[np.float64]]]:
        """Yield what samples are scored by copies of this classifier that have not seen them.

        Override it where folds can share work, such as a Gram matrix.

        Parameters
        ----------
        features : batch of n samples
        labels : ndarray of str, shape (n,)
        stamps : ndarray of int64, shape (n,), or None
            Times, ns.
        splits : iterable of (training rows, held-out rows)
            The folds.

        Yields
        ------
        tuple of held-out rows and their scores, shape (k, V)
            By a copy of :meth:`chosen` that was fitted on the training rows.
        """
        for training, held_out in splits:
            times = None if stamps is None else stamps[training]
            copy = self.chosen().fit(take(features, training), labels[training], times)
            yield held_out, copy.scores(take(features, held_out)).values

    # ------------------------------------------------------------------ for those who write one

    def learn_classes(self, labels: ArrayLike) -> NDArray[np.int64]:
        """Set ``labels_`` and return the class of each sample as a number, 0 to M - 1, shape (n,).

        Parameters
        ----------
        labels : array of str or int, shape (n,)
            The classes of the training samples.

        Raises
        ------
        DataError
            If all samples are of one class, or the labels are no classes.
        """
        try:
            given = column_or_1d(labels, warn=True)
            check_classification_targets(given)
        except ValueError as error:
            raise UnfitSamples(f"these labels are no classes: {_in_one_line(error)}") from error
        given = given.astype(np.str_) if given.dtype.kind == "O" else given
        self.labels_, codes = np.unique(given, return_inverse=True)
        if len(self.labels_) < 2:
            raise UnfitSamples(
                f"the training samples are of one class only ('{self.labels_[0]}', {len(given)} "
                "of them): give samples of two classes or more"
            )
        return np.asarray(codes, dtype=np.int64)

    @property
    def class_names(self) -> tuple[str, ...]:
        """The classes as text, for a layout, in the order of ``labels_``."""
        return tuple(str(label) for label in self.labels_)

    def training_samples(self, features: FeatureBatch, labels: ArrayLike) -> FeatureBatch:
        """Return training features, checked: as many as labels, numbers, finite.

        Parameters
        ----------
        features : batch of n samples
        labels : array, shape (n,)

        Raises
        ------
        DataError
            If they are not.
        """
        if kind_of(features) is not FeatureKind.DESCRIPTORS:
            features = self._validated(features, y=labels, reset=True)
        elif len(features) != len(np.asarray(labels)):
            raise UnfitSamples(
                f"{len(features)} samples and {len(np.asarray(labels))} labels: give one a sample"
            )
        return self._some_and_finite(features)

    def fold_features(self, learned_from: FoldFeatures, labels: ArrayLike) -> FoldFeatures:
        """Return ``learned_from`` with its features checked as :meth:`training_samples` does."""
        return lambda rows: clone(self).training_samples(learned_from(rows), labels)

    def samples(self, features: FeatureBatch) -> FeatureBatch:
        """Return features to score, checked: as long as in training, finite.

        Raises
        ------
        DataError
            If they are not.
        NotFittedError
            If the classifier has not been fitted.
        """
        if not hasattr(self, "layout_"):
            raise NotFittedError(f"this {type(self).__name__} is not fitted yet: call fit first")
        # One frame after another comes by here, so the usual case is checked by hand.
        usual = isinstance(features, np.ndarray) and features.dtype == np.float64
        if usual and features.shape[1:] == (getattr(self, "n_features_in_", -1),):
            return self._some_and_finite(features)
        if kind_of(features) is not FeatureKind.DESCRIPTORS:
            self._check_width(features)
            features = self._validated(features, reset=False)
        return self._some_and_finite(features)

    def _check_width(self, features: FeatureBatch) -> None:
        width, known = getattr(features, "shape", ())[1:], getattr(self, "n_features_in_", None)
        if width and known is not None and width[0] != known:
            raise UnfitSamples(
                f"X has {width[0]} features, but {type(self).__name__} is expecting {known} "
                "features as input, as in training: the cue must have the same parameters, and "
                "for some cues an image of another size has other features"
            )

    def _validated(self, features: FeatureBatch, **options: Any) -> FeatureBatch:
        if sparse.issparse(features):
            features = sparse.csr_array(features)
        try:
            checked = validate_data(
                self, features, accept_sparse="csr", ensure_all_finite=False, **options
            )
        except (ValueError, TypeError) as error:
            raise UnfitSamples(_in_one_line(error)) from error
        features = checked[0] if isinstance(checked, tuple) else checked
        return features if sparse.issparse(features) else np.asarray(features, dtype=np.float64)

    def _some_and_finite(self, features: FeatureBatch) -> FeatureBatch:
        if n_samples(features) == 0:
            raise UnfitSamples("there is no sample: give one or more")
        rows = _spoilt_rows(features)
        if len(rows):
            raise UnfitSamples(
                f"{len(rows)} of {n_samples(features)} samples hold NaN or infinite (inf) "
                f"features, the first is number {rows[0]}"
            )
        return features


def wrong_kind(classifier: object, accepted: str, features: FeatureBatch) -> WrongKind:
    """Return the error that says which kinds of features a classifier takes."""
    return WrongKind(
        f"classifier {type(classifier).__name__} takes {accepted}, got {kind_of(features)}: choose "
        "another classifier for this cue, such as svm with a kernel for such features"
    )


def _spoilt_rows(features: Any) -> NDArray[np.int64]:
    """Return the samples that hold a NaN or infinite number."""
    if kind_of(features) is FeatureKind.DENSE:
        spoilt = ~np.isfinite(features).all(axis=1)
        return np.flatnonzero(spoilt)
    if kind_of(features) is FeatureKind.SPARSE:
        starts, places = features.indptr, np.flatnonzero(~np.isfinite(features.data))
    else:
        starts = features.offsets
        places = np.flatnonzero(~np.isfinite(features.values).all(axis=1))
    return np.unique(np.searchsorted(starts, places, side="right") - 1)


def _in_one_line(error: Exception) -> str:
    return " ".join(str(error).split())
