"""One outer fold of benchmarks/cues_and_classifiers.py: what its classifiers have in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from cues_and_classifiers_plan import EXTENSIONS
from sklearn.base import clone

from placecue.classifier import Classifier
from placecue.features import FeatureBatch, FeatureKind, kind_of, n_samples, take
from placecue.folds import Rows
from placecue.kernel import DistanceKernel, Gram
from placecue.training_set import TrainingSet
from placecue_classifiers.search import SCORE, best_of
from placecue_classifiers.svm import SVM


class Grams:
    """The Gram matrices of all samples for each gamma; copies of it are the very same object."""

    def __init__(self, kernel: DistanceKernel, features: FeatureBatch, gammas: Sequence[float]):
        kernel.check(features)
        distances = kernel.shared(features)
        copies = {gamma: clone(kernel).set_params(gamma=gamma) for gamma in gammas}
        self.of_gamma = {gamma: copy.from_shared(distances) for gamma, copy in copies.items()}

    def __deepcopy__(self, memo: Any) -> Grams:
        return self


class LookUp(DistanceKernel):
    """A kernel between samples that are given by their numbers, shape (n, 1)."""

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.DENSE})

    def __init__(self, grams: Grams, gamma: float = 1.0) -> None:
        super().__init__(gamma)
        self.grams = grams

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        rows, columns = np.asarray(a), np.asarray(a if b is None else b)
        return np.ix_(rows[:, 0].astype(int), columns[:, 0].astype(int))

    def from_shared(self, shared: Any) -> Gram:
        return np.asarray(self.grams.of_gamma[self.gamma][shared])


@dataclass
class Fold:
    """Samples to learn from and samples to tell.

    Parameters
    ----------
    samples : TrainingSet
        n samples by one cue, which has learned from those to learn from.
    training, held_out : ndarray of int64
        Which of them to learn from and to tell.
    grams : dict of str to Grams
        By the kernel's name, for kernels that learn nothing; folds of the same samples share it.
    """

    samples: TrainingSet
    training: Rows
    held_out: Rows
    grams: dict[str, Grams]
    found: dict[str, dict[str, Any]] = field(default_factory=dict)

    def outcome(self, classifier: Classifier, column: str) -> dict[str, Any]:
        """Return the classes of the held-out rows, and what was found inside the training rows."""
        samples, told = self.samples, {}
        if isinstance(classifier, SVM):
            classifier, samples = self._looked_up(classifier)
            told = self._search(classifier, samples, column)
            classifier = classifier.with_setting(told["chosen"]).set_params(search=None)
        classifier.train(samples.take(self.training))
        predicted = classifier.scores(take(samples.features, self.held_out)).decide().labels
        return {"predicted": np.asarray(predicted).tolist(), **told}

    def _looked_up(self, svm: SVM) -> tuple[SVM, TrainingSet]:
        """Return an SVM on the numbers of samples where its kernel learns nothing from them."""
        kernel, features = svm.kernel, self.samples.features
        own = self.samples.relearn is not None or kind_of(features) is FeatureKind.DENSE
        if own or not isinstance(kernel, DistanceKernel):
            return svm, self.samples
        name = type(kernel).__name__
        if name not in self.grams:
            self.grams[name] = Grams(kernel, features, svm.search["gamma"])
        changed: SVM = clone(svm).set_params(kernel=LookUp(self.grams[name]))
        numbers = np.arange(n_samples(features), dtype=np.float64)[:, None]
        return changed, replace(self.samples, features=numbers)

    def _search(self, svm: SVM, samples: TrainingSet, column: str) -> dict[str, Any]:
        """Search inside the training rows; one search serves all multi-class extensions."""
        if column not in self.found:
            extensions = EXTENSIONS if column in EXTENSIONS else (svm.multiclass,)
            wide = clone(svm).set_params(search={**svm.search, "multiclass": list(extensions)})
            table = wide.train(samples.take(self.training)).search_
            for extension in extensions:
                rows = [i for i, name in enumerate(table["multiclass"]) if name == extension]
                part = {name: [values[i] for i in rows] for name, values in table.items()}
                told = {"chosen": best_of(part), "inner": max(part[SCORE])}
                self.found[extension if column in EXTENSIONS else column] = told
        return self.found[column]
