"""Any classifier, with parameters picked by cross-validation on balanced accuracy."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.classifier import Classifier
from placecue.errors import UsageError, choices
from placecue.estimator import clone
from placecue.features import FeatureBatch, take
from placecue.folds import FoldScheme, Rows
from placecue.progress import track
from placecue.scores import Scores
from placecue.training_set import TrainingSet

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
    folds : FoldScheme, optional
        How the training samples are cut; by default as the training set says.

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
        folds: FoldScheme | None = None,
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
        return self.train(TrainingSet(features, labels, stamps))

    def train(self, training: TrainingSet) -> Self:
        """Search, then train; in every fold the cue has learned from its training rows only."""
        points = self._points()
        training = self.checked(training)
        splits = training.split(self.folds)
        found = self._predicted(points, training, splits)
        predicted = list(track(found, "searching parameters", len(splits) * len(points)))
        truth = np.concatenate([training.labels[held_out] for _, held_out in splits])
        self.search_: dict[str, list[Any]] = {name: [] for name in (*points[0], SCORE)}
        for number, point in enumerate(points):
            of_point = np.concatenate(predicted[number :: len(points)])
            for name, value in {**point, SCORE: balanced_accuracy(truth, of_point)}.items():
                self.search_[name].append(value)
        self.chosen_ = best_of(self.search_)
        self.classifier_ = self._with(self.chosen_).train(training)
        self.layout_ = self.classifier_.layout_
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return what the trained classifier says of n samples, shape (n, V)."""
        features = self.samples(features)
        return self.classifier_.scores(features)

    def best(self) -> Any:
        """Return the classifier itself, unfitted, with the parameters that were best."""
        return self.classifier_.best() if hasattr(self, "classifier_") else self._with({})

    def candidates(self) -> Iterator[tuple[Setting, Classifier]]:
        """Yield the points of the search."""
        return ((point, self._with(point)) for point in self._points())

    def out_of_fold(
        self, training: TrainingSet, splits: Iterable[tuple[Rows, Rows]]
    ) -> Iterator[tuple[Rows, Scores]]:
        """Yield held-out rows with the scores of copies of the trained classifier."""
        return self.classifier_.out_of_fold(training, splits)

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
        assert self.classifier is not None  # or there are no points
        return clone(self.classifier).set_params(**point)

    def _predicted(
        self,
        points: Sequence[Setting],
        training: TrainingSet,
        splits: Sequence[tuple[Rows, Rows]],
    ) -> Iterator[NDArray[Any]]:
        """Yield the classes of the held-out rows for every point, fold after fold."""
        for rows, held_out in splits:
            of_fold = training.relearned(rows)
            asked, trained_on = take(of_fold.features, held_out), of_fold.take(rows)
            for point in points:
                yield self._with(point).train(trained_on).predict(asked)

    def __sklearn_tags__(self) -> Any:
        """Return what scikit-learn is told of the estimator: what the classifier says of itself."""
        tags = super().__sklearn_tags__()
        if self.classifier is not None:
            tags.input_tags.sparse = self.classifier.__sklearn_tags__().input_tags.sparse
        return tags
