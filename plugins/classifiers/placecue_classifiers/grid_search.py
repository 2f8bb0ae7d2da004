"""Any classifier, with parameters picked by cross-validation on balanced accuracy."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone

from placecue.classifier import Classifier
from placecue.errors import UsageError, choices
from placecue.features import FeatureBatch, take
from placecue.folds import Rows, fold_scheme
from placecue.progress import track
from placecue.scores import Scores

from .grid import Setting, check_listed, settings
from .search import SCORE, balanced_accuracy, best_of


class GridSearch(Classifier):
    """A classifier whose parameters are tried, every combination of them, before it is trained.

    For classifiers that do not search themselves; an SVM's own ``search`` shares Gram matrices and
    is many times as fast.

    Parameters
    ----------
    classifier : Classifier
        What to train.
    search : mapping of str to sequence
        Values to try by the name of the parameter, such as ``{"rounds": [30, 100, 300]}``; one of
        a component inside the classifier as ``kernel__gamma``.
    folds : mapping, optional
        How the training samples are cut, such as ``{"scheme": "interleaved", "n_folds": 5}``.

    Attributes
    ----------
    classifier_ : Classifier
        Trained on all samples with the parameters that were best.
    search_ : dict of str to list
        For each point of the grid the parameters and ``balanced_accuracy``: the mean of the
        per-class recalls over all held-out samples, pooled over the folds.
    chosen_ : dict
        The parameters of the best point, the first of equals.
    layout_ : Layout
        That of ``classifier_``.
    """

    def __init__(
        self,
        classifier: Classifier | None = None,
        search: Mapping[str, Sequence[Any]] | None = None,
        folds: Mapping[str, Any] | None = None,
    ) -> None:
        self.classifier = classifier
        self.search = search
        self.folds = folds

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Search, then train on n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        UsageError
            If there is no classifier or nothing to search, or a parameter cannot be.
        DataError
            If the classifier refuses the samples, or they cannot be cut into folds.
        """
        points = self._points()
        scheme = fold_scheme(self.folds)
        features = self.training_samples(features, labels)
        codes = self.learn_classes(labels)
        given, times = self.labels_[codes], None if stamps is None else np.asarray(stamps)
        splits = list(scheme.split(np.asarray(self.class_names)[codes], times))
        truth = np.concatenate([given[held_out] for _, held_out in splits])
        self.search_: dict[str, list[Any]] = {name: [] for name in (*points[0], SCORE)}
        for point in track(points, "searching parameters"):
            found = [self._predicted(point, features, given, times, split) for split in splits]
            accuracy = balanced_accuracy(truth, np.concatenate(found))
            for name, value in {**point, SCORE: accuracy}.items():
                self.search_[name].append(value)
        self.chosen_ = best_of(self.search_)
        self.classifier_ = self._with(self.chosen_).fit(features, given, times)
        self.layout_ = self.classifier_.layout_
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return what the trained classifier says of n samples, shape (n, V)."""
        features = self.samples(features)
        return self.classifier_.scores(features)

    def chosen(self) -> Any:
        """Return the classifier itself, unfitted, with the parameters that were best."""
        return self._with(getattr(self, "chosen_", {}))

    def out_of_fold(
        self,
        features: FeatureBatch,
        labels: NDArray[np.str_],
        stamps: NDArray[np.int64] | None,
        splits: Iterable[tuple[Rows, Rows]],
    ) -> Iterator[tuple[Rows, NDArray[np.float64]]]:
        """Yield held-out rows with the scores of copies of the trained classifier."""
        return self.classifier_.out_of_fold(features, labels, stamps, splits)

    def _points(self) -> list[Setting]:
        if self.classifier is None or not self.search:
            raise UsageError(
                "grid_search needs a classifier and what to search, such as search={rounds: "
                "[30, 100]} of adaboost"
            )
        known = self.classifier.get_params()
        for name, tried in self.search.items():
            if name not in known:
                raise UsageError(f"search cannot vary '{name}'; {choices(name, known)}")
            check_listed(name, tried)
        return list(settings(self.search))

    def _with(self, point: Mapping[str, Any]) -> Classifier:
        copy: Classifier = clone(self.classifier).set_params(**point)
        return copy

    def _predicted(
        self,
        point: Mapping[str, Any],
        features: FeatureBatch,
        labels: NDArray[Any],
        stamps: NDArray[np.int64] | None,
        split: tuple[Rows, Rows],
    ) -> NDArray[Any]:
        training, held_out = split
        times = None if stamps is None else stamps[training]
        copy = self._with(point).fit(take(features, training), labels[training], times)
        return copy.predict(take(features, held_out))

    def __sklearn_tags__(self) -> Any:
        """Return what scikit-learn is told of the estimator: what the classifier says of itself."""
        tags = super().__sklearn_tags__()
        if self.classifier is not None:
            tags.input_tags.sparse = self.classifier.__sklearn_tags__().input_tags.sparse
        return tags
