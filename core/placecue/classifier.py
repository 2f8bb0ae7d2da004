"""A classifier: from the features of one cue to scores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from sklearn.base import ClassifierMixin
from sklearn.exceptions import NotFittedError
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import column_or_1d, validate_data

from placecue.errors import DataError, UsageError
from placecue.estimator import Estimator, clone
from placecue.features import (
    FeatureBatch,
    FeatureKind,
    FeatureParts,
    form,
    kind_of,
    n_samples,
    spoilt_rows,
    take,
)
from placecue.folds import Rows
from placecue.scores import Layout, Scores
from placecue.training_set import TrainingSet


class UnfitSamples(DataError, ValueError, TypeError):
    """Samples that a classifier cannot learn from or score; scikit-learn expects such errors."""


class WrongKind(UsageError, ValueError):
    """Features of a kind that a classifier cannot take; scikit-learn expects a ValueError."""


class Classifier(ClassifierMixin, Estimator, ABC):  # type: ignore[misc]
    """Scores the features of one cue: a scikit-learn classifier.

    No logic in ``__init__``; what is learned ends in ``_`` and is plain data (arrays, numbers,
    strings, lists, layouts, other components), so that a model folder can hold it.

    Attributes
    ----------
    version : str
        Changes when the results do, so that a model does not meet another classifier unawares.
    layout_ : Layout
        What the columns of the scores are; set by :meth:`fit`.
    form_ : str
        What features in parts were like in training, in words; not there for others.
    labels_ : ndarray, shape (M,)
        The classes as they were given in training, in the order of ``layout_.classes``; a
        classifier sets it with :meth:`learn_classes`, or leaves it out where labels are text.
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

    def train(self, training: TrainingSet) -> Self:
        """Learn from a training set; what a pipeline calls.

        Override it where :meth:`fit` holds samples out, to search parameters, say: the set cuts
        the folds (:meth:`TrainingSet.split`) and gives each its own features where the cue learns
        (:meth:`TrainingSet.relearned`). The default calls :meth:`fit` with all samples and their
        augmented copies.
        """
        stamps = None if training.stamps is None else training.repeated(training.stamps)
        return self.fit(training.batch(), training.repeated(training.labels), stamps)

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

    def best(self) -> Self:
        """Return an unfitted copy with what a parameter search found as fixed parameters.

        Out-of-fold scores are made with it, so that a search runs once and not once a fold.
        """
        copy: Any = clone(self)
        return copy  # type: ignore[no-any-return]

    def candidates(self) -> Iterator[tuple[dict[str, Any], Classifier]]:
        """Yield what a parameter search would try: parameters, and an unfitted copy with them.

        For those who choose parameters on samples of their own, such as another recording. Without
        a search that is one copy.
        """
        yield {}, self.best()

    def out_of_fold(
        self, training: TrainingSet, splits: Iterable[tuple[Rows, Rows]]
    ) -> Iterator[tuple[Rows, Scores]]:
        """Yield what samples are scored by copies of this classifier that have not seen them.

        Override it where folds can share work, such as a Gram matrix.

        Parameters
        ----------
        training : TrainingSet
            n samples. Where the cue learns, it has learned from a fold's training rows only.
        splits : iterable of (training rows, held-out rows)
            The folds.

        Yields
        ------
        tuple of held-out rows and their Scores, shape (k, V)
            By a copy of :meth:`best` that was trained on the training rows, in its own layout.
        """
        for rows, held_out in splits:
            of_fold = training.relearned(rows)
            copy = self.best().train(of_fold.take(rows))
            yield held_out, copy.scores(take(of_fold.features, held_out))

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
        self.__dict__.pop("form_", None)
        if isinstance(features, FeatureParts):
            self.form_ = form(features)
        elif kind_of(features) is not FeatureKind.DESCRIPTORS:
            return self._some_and_finite(self._validated(features, y=labels, reset=True))
        if n_samples(features) != len(np.asarray(labels)):
            raise UnfitSamples(
                f"{n_samples(features)} samples and {len(np.asarray(labels))} labels: give one a "
                "sample"
            )
        return self._some_and_finite(features)

    def checked(self, training: TrainingSet) -> TrainingSet:
        """Return a training set with its features checked, and learn the classes.

        For those who override :meth:`train`; sets ``labels_``, in whose order the labels of the
        returned set stand.

        Raises
        ------
        DataError
            If the features are not numbers, not finite or not as many as labels, or all samples
            are of one class.
        """
        labels = training.labels
        features = self.training_samples(training.features, labels)
        augmented = [clone(self).training_samples(each, labels) for each in training.augmented]
        codes = self.learn_classes(labels)
        relearn = None
        if training.relearn is not None:

            def relearn(rows: Rows) -> TrainingSet:
                copy: Classifier = clone(self)
                return copy.checked(training.relearned(rows))

        return replace(
            training,
            features=features,
            labels=self.labels_[codes],
            augmented=tuple(augmented),
            relearn=relearn,
        )

    def codes(self, labels: NDArray[Any]) -> NDArray[np.int64]:
        """Return the numbers of classes, 0 to M - 1 in the order of ``labels_``, shape (n,)."""
        return np.searchsorted(self.labels_, labels).astype(np.int64)

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
        if isinstance(features, FeatureParts) or hasattr(self, "form_"):
            self._check_form(features)
        elif kind_of(features) is not FeatureKind.DESCRIPTORS:
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

    def _check_form(self, features: FeatureBatch) -> None:
        """Raise UnfitSamples unless features in parts have the parts of those in training."""
        known = getattr(self, "form_", "features in one piece")
        if form(features) != known:
            raise UnfitSamples(
                f"{type(self).__name__} was trained on {known}, got {form(features)}: the cue and "
                "its parts must have the same parameters, and for some cues an image of another "
                "size has other features"
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
        rows = spoilt_rows(features)
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


def _in_one_line(error: Exception) -> str:
    return " ".join(str(error).split())
