"""A classifier: from the features of one cue to scores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, clone

from placecue.features import FeatureBatch
from placecue.scores import Layout, Scores


class Classifier(ClassifierMixin, BaseEstimator, ABC):  # type: ignore[misc]
    """Scores the features of one cue: a scikit-learn classifier.

    No logic in ``__init__``; what is learned ends in ``_`` and is plain data (arrays, numbers,
    strings, lists, layouts, other components), so that a model folder can hold it.

    Attributes
    ----------
    layout_ : Layout
        What the columns of the scores are; set by :meth:`fit`.
    """

    layout_: Layout

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

    @abstractmethod
    def scores(self, features: FeatureBatch) -> Scores:
        """Return the outputs for n samples, shape (n, V), with their layout."""

    @property
    def classes_(self) -> NDArray[np.str_]:
        """The classes, sorted, shape (M,)."""
        return np.asarray(self.layout_.classes)

    def predict(self, features: FeatureBatch) -> NDArray[np.str_]:
        """Return the class that the layout's rule picks for each sample, shape (n,)."""
        return self.scores(features).decide().labels

    def chosen(self) -> Self:
        """Return an unfitted copy with what a parameter search found as fixed parameters.

        Out-of-fold scores are made with it, so that a search runs once and not once a fold.
        """
        copy: Any = clone(self)
        return copy  # type: ignore[no-any-return]
