"""Classifiers hand the families of features to their scaling; four classes throughout."""

from __future__ import annotations

from dataclasses import replace
from typing import Self

import numpy as np
import pytest
from sklearn.neighbors import KNeighborsClassifier

from placecue import Blocks, Scaling
from placecue.classifier import Classifier
from placecue.features import take
from placecue.scaling import FamilyScaling, RangeScaling
from placecue.training_set import TrainingSet
from placecue_classifiers.grid_search import GridSearch
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF

PLACES = np.array(["corridor", "kitchen", "lab", "office"])
NEIGHBOURS = "sklearn.neighbors.KNeighborsClassifier"
#: Two columns that tell the places apart, and sixty of a family that do not.
FAMILIES = ("size", "range", *["fourier"] * 60)


def samples(seed: int) -> TrainingSet:
    rng = np.random.default_rng(seed)
    codes = rng.integers(4, size=160)
    telling = np.stack([codes % 2, codes // 2], axis=1) + 0.2 * rng.normal(size=(160, 2))
    features = np.hstack([telling, rng.choice([-1.0, 1.0], size=(160, 60))])
    return TrainingSet(features, PLACES[codes], folds=Blocks(n_folds=4), families=FAMILIES)


SEEN, UNSEEN = samples(0), samples(1)
NEAR = {"n_neighbors": 5}
SEARCH = {"C": [1.0, 10.0], "gamma": [0.1, 0.5]}


@pytest.fixture(params=["svm", "search", "sklearn", "grid_search"])
def classifier(request: pytest.FixtureRequest) -> Classifier:
    scaling = FamilyScaling(RangeScaling())
    neighbours = ScikitLearn(NEIGHBOURS, NEAR, scaling=scaling)
    made: dict[str, Classifier] = {
        "svm": SVM(RBF(gamma=0.5), C=10.0, scaling=scaling),
        "search": SVM(RBF(), search=SEARCH, scaling=scaling),
        "sklearn": neighbours,
        "grid_search": GridSearch(neighbours, {"random_state": [0, 1]}),
    }
    return made[request.param]


def accuracy(classifier: Classifier) -> float:
    return float((classifier.predict(UNSEEN.features) == UNSEEN.labels).mean())


def test_families_reach_the_scaling(classifier: Classifier) -> None:
    assert accuracy(classifier.train(SEEN)) > 0.9
    assert accuracy(classifier.train(replace(SEEN, families=None))) < 0.75


def test_families_reach_the_scaling_of_every_fold(classifier: Classifier) -> None:
    def held_out(training: TrainingSet) -> float:
        classifier.train(training)
        parts = classifier.out_of_fold(training, training.split())
        found = [scores.decide().labels == training.labels[rows] for rows, scores in parts]
        return float(np.concatenate(found).mean())

    assert held_out(SEEN) > 0.9
    assert held_out(replace(SEEN, families=None)) < 0.75


def test_a_search_judges_by_families() -> None:
    svm = SVM(RBF(), search=SEARCH, scaling=FamilyScaling(RangeScaling())).train(SEEN)
    assert max(svm.search_["balanced_accuracy"]) > 0.9


def test_neighbours_are_those_of_scikit_learn_on_weighed_features() -> None:
    low, high = SEEN.features.min(axis=0), SEEN.features.max(axis=0)
    by_hand = np.array([1.0, 1.0, *[60**-0.5] * 60])

    def weighed(features: np.ndarray) -> np.ndarray:
        return (2 * (features - low) / (high - low) - 1) * by_hand

    mine = ScikitLearn(NEIGHBOURS, NEAR, scaling=FamilyScaling(RangeScaling())).train(SEEN)
    peer = KNeighborsClassifier(**NEAR).fit(weighed(SEEN.features), SEEN.labels)
    expected = peer.predict_proba(weighed(UNSEEN.features))
    np.testing.assert_array_equal(mine.scores(UNSEEN.features).values, expected)


def test_some_of_the_samples_are_in_the_same_families() -> None:
    assert SEEN.take(np.arange(3)).families == FAMILIES
    learning = TrainingSet(
        SEEN.features, SEEN.labels, families=FAMILIES, relearn=lambda rows: replace(SEEN)
    )
    assert learning.relearned(np.arange(9)).families == FAMILIES
    assert learning.take(np.arange(9)).relearned(np.arange(3)).families == FAMILIES


class Halved(Scaling):
    """A scaling that knows nothing of families."""

    def fit(self, features: np.ndarray) -> Self:
        self.fitted_ = len(features)
        return self

    def transform(self, features: np.ndarray) -> np.ndarray:
        return features / 2


def test_a_scaling_that_knows_of_no_families_goes_on_working() -> None:
    scaled = SVM(RBF(gamma=0.4), scaling=Halved()).train(SEEN)
    plain = SVM(RBF(gamma=0.1)).train(SEEN)
    rows = take(UNSEEN.features, np.arange(20))
    np.testing.assert_allclose(scaled.scores(rows).values, plain.scores(rows).values, atol=1e-9)
    assert scaled.scaling_.fitted_ == len(SEEN)
    inside = SVM(RBF(gamma=0.4), scaling=FamilyScaling(Halved())).train(
        replace(SEEN, families=None)
    )
    np.testing.assert_allclose(inside.scores(rows).values, plain.scores(rows).values, atol=1e-9)
