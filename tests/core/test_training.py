"""Classifiers are trained on features by cues that have not seen what is held out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from placecue.learning.training import train

import toys
from caching import CALLS, REGISTRY, Learning
from placecue import Cue, DataError, Observation, Pipeline
from placecue.classifier import Classifier
from placecue.learning.samples import CueSamples, collect
from placecue.storage.feature_cache import FeatureCache
from placecue_classifiers.grid_search import GridSearch
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Walk


class ByHeart(Cue):
    """Knows the class of every observation that it has learned from; guesses the others."""

    requires = ("image",)
    learns = True

    def fit(self, observations, labels=None):  # type: ignore[no-untyped-def]
        stamps = [each.stamp for each in observations]
        self.stamps_ = np.array(stamps)
        self.codes_ = np.array([PLACES.index(label) for label in labels])
        return self

    def extract(self, observation: Observation) -> np.ndarray:
        guess = np.random.default_rng(observation.stamp).integers(0, 4)
        known = self.codes_[self.stamps_ == observation.stamp]
        return np.eye(4)[known[0] if len(known) else guess]


class ByHeartTwice(ByHeart):
    """Trains on every observation and on its negative."""

    def alterations(self):  # type: ignore[no-untyped-def]
        return [lambda each: each.altered("negative", image=255 - each.image)]


@pytest.mark.parametrize("cue", [ByHeart(), ByHeartTwice()], ids=["plain", "altered"])
@pytest.mark.parametrize(
    "classifier",
    [
        SVM(RBF(1.0), search={"C": [1.0, 100.0]}, probability="sigmoid"),
        GridSearch(
            ScikitLearn("sklearn.linear_model.LogisticRegression"),
            {"params": [{"C": 1.0}, {"C": 100.0}]},
        ),
    ],
    ids=["svm", "grid_search"],
)
def test_a_cue_that_learns_by_heart_is_not_believed(cue: Cue, classifier: Classifier) -> None:
    pipeline = Pipeline({"heart": (cue, classifier)}).fit(Walk(), reliability=True)
    assert max(classifier.search_["balanced_accuracy"]) < 0.35  # a guess: 0.25
    held_out = pipeline.held_out_
    assert held_out is not None
    right = held_out.evidence.scores("heart").decide().labels == held_out.labels
    assert right.mean() < 0.35
    beliefs = list(pipeline.beliefs(Walk()))
    # Of what it has seen it knows the class; what calibration has learned is that it guesses.
    if isinstance(classifier, SVM):
        assert np.mean([belief.scores.values.max() for belief in beliefs]) < 0.45
    else:
        assert [belief.label for belief in beliefs] == [each.label for each in Walk()]


def test_probabilities_of_unseen_samples_are_calibrated_inside_their_fold() -> None:
    svm = SVM(RBF(1.0), C=10.0, probability="sigmoid")
    pipeline = Pipeline({"heart": (ByHeart(), svm)}).fit(Walk(), reliability=True)
    held_out = pipeline.held_out_
    assert held_out is not None
    likeliest = held_out.evidence.scores("heart").values.max(axis=1)
    # Calibrated on what the cue knew by heart they would be near 1.
    assert likeliest.mean() < 0.45


def test_a_cue_learns_once_for_a_fold_of_search_and_of_integration(tmp_path: Path) -> None:
    CALLS.clear()
    search = {"C": [1.0, 10.0], "gamma": [1e-4, 1e-3]}
    pipeline = Pipeline(
        {
            "beams": (Beams(), SVM(RBF(0.1))),
            "brightness": (Learning(), SVM(RBF(), search=search)),
        },
        SVMDAS(SVM(RBF(0.3))),
    )
    with FeatureCache(tmp_path, REGISTRY) as pipeline.extraction:
        pipeline.fit(pipeline.extraction.following(Walk()))
    assert CALLS["fit"] == 1 + 5  # all samples, and five folds


class Telling(Classifier):
    """Tells which rows it would hold out, and keeps what it is given for them."""

    def fit(self, features, labels, stamps=None):  # type: ignore[no-untyped-def]
        raise AssertionError("a cue that learns goes by fit_on_learned")

    def fit_on_learned(self, features, labels, stamps, learned_from):  # type: ignore[no-untyped-def]
        self.features, self.stamps = features, stamps
        self.given = learned_from(np.array([0, 1, 2, 3, 5]))
        return self

    def scores(self, features):  # type: ignore[no-untyped-def]
        raise AssertionError("not asked for")


class Drawing(Telling):
    """Draws rows with repetition, as bagging does, or by a mask."""

    def __init__(self, drawn: object) -> None:
        self.drawn = drawn

    def fit_on_learned(self, features, labels, stamps, learned_from):  # type: ignore[no-untyped-def]
        learned_from(np.array(self.drawn))
        return self


@pytest.mark.parametrize(
    ("views", "drawn", "expected"),
    [
        (1, [0, 0, 1, 2], [1, 2, 4]),
        (1, [True, False, True, False], [1, 4]),
        (2, [0, 0, 1, 1, 2, 3], [1, 2]),
        (2, [3, 0, 2, 1], [1, 2]),
    ],
)
def test_rows_may_be_drawn_twice(views: int, drawn: list[int], expected: list[int]) -> None:
    asked: list[list[int]] = []
    recorded = np.arange(6.0)[:, None]
    samples = CueSamples(recorded, (-recorded,) * (views - 1))

    def learned_from(rows: np.ndarray) -> CueSamples:
        asked.append(rows.tolist())
        return samples

    labels = np.array([*"abcabc"])
    train(Drawing(drawn), samples, labels, None, np.array([1, 2, 4, 5]), learned_from)
    assert asked == [expected]


def test_a_fold_of_copies_alone() -> None:
    recorded = np.arange(6.0)[:, None]
    samples = CueSamples(recorded, (-recorded,))
    with pytest.raises(DataError, match="a cue has nothing to learn from"):
        train(Drawing([0, 2, 4]), samples, np.array([*"abcabc"]), None, None, lambda rows: samples)


def test_samples_are_learned_from_in_their_order_and_once() -> None:
    samples = collect(Walk(), {"heart": ByHeart()})
    cue = ByHeart()
    samples.fit(cue, np.array([70, 3, 3, 25]))
    assert cue.stamps_.tolist() == samples.stamps[[3, 25, 70]].tolist()
    assert [PLACES[code] for code in cue.codes_] == samples.labels[[3, 25, 70]].tolist()


def test_rows_of_altered_copies_stand_for_their_samples() -> None:
    asked: list[list[int]] = []

    def learned_from(rows: np.ndarray) -> CueSamples:
        asked.append(rows.tolist())
        return CueSamples(10.0 + np.arange(6.0)[:, None], (100.0 + np.arange(6.0)[:, None],))

    labels, stamps = np.array([*"abcabc"]), np.arange(6) * toys.SECOND
    samples = CueSamples(np.arange(6.0)[:, None], (-np.arange(6.0)[:, None],))
    rows = np.array([1, 2, 4])
    telling = train(Telling(), samples, labels, stamps, rows, learned_from)
    assert telling.features.ravel().tolist() == [1, -1, 2, -2, 4, -4]
    assert telling.stamps.tolist() == [1e9, 1e9, 2e9, 2e9, 4e9, 4e9]
    # Of sample 4 one copy is held out, so that the cue may not learn from it.
    assert asked == [[1, 2]]
    assert telling.given.ravel().tolist() == [11, 101, 12, 102, 14, 104]
