"""Classifiers are trained on features by cues that have not seen what is held out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import toys
from caching import CALLS, REGISTRY, Learning
from placecue import Blocks, Cue, FoldScheme, Observation, Pipeline
from placecue.classifier import Classifier
from placecue.features import take
from placecue.learning.collecting import collect
from placecue.storage.feature_cache import FeatureCache
from placecue.training_set import TrainingSet
from placecue_classifiers.grid_search import GridSearch
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.linear import Linear
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

    def augmentations(self):  # type: ignore[no-untyped-def]
        return [lambda each: each.altered("negative", image=255 - each.image)]


@pytest.mark.parametrize("cue", [ByHeart(), ByHeartTwice()], ids=["plain", "augmented"])
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
    pipeline = Pipeline({"heart": (cue, classifier)}).fit(Walk(rounds=2), reliability=True)
    assert max(classifier.search_["balanced_accuracy"]) < 0.35  # a guess: 0.25
    assert pipeline.judged_ is not None
    right = np.concatenate([each.decisions()[1] for each in pipeline.judged_])
    assert right.size == Walk(rounds=2).count()
    assert right.mean() < 0.35
    beliefs = list(pipeline.beliefs(Walk(rounds=2)))
    # Of what it has seen it knows the class; what calibration has learned is that it guesses.
    if isinstance(classifier, SVM):
        assert np.mean([belief.scores.values.max() for belief in beliefs]) < 0.45
    else:
        assert [belief.label for belief in beliefs] == [each.label for each in Walk(rounds=2)]


def test_probabilities_of_unseen_samples_are_calibrated_inside_their_fold() -> None:
    svm = SVM(RBF(1.0), C=10.0, probability="sigmoid")
    pipeline = Pipeline({"heart": (ByHeart(), svm)}).fit(Walk(rounds=2), reliability=True)
    assert pipeline.judged_ is not None
    likeliest = np.concatenate(
        [part.evidence.scores("heart").values.max(axis=1) for part in pipeline.judged_]
    )
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
        pipeline.fit(Walk())
    assert CALLS["fit"] == 1 + 5  # all samples, and five folds


class CountedSVM(SVM):
    """Counts its trainings."""

    trained = 0

    def train(self, training: TrainingSet) -> CountedSVM:
        CountedSVM.trained += 1
        return super().train(training)


def test_a_second_integrator_trains_no_cue_again() -> None:
    CALLS.clear()
    CountedSVM.trained = 0
    cues = {
        "beams": (Beams(), CountedSVM(RBF(0.1))),
        "brightness": (Learning(), CountedSVM(RBF(0.001))),
    }
    first = Pipeline(cues, SVMDAS(SVM(RBF(0.3))))
    samples = first.collect(Walk())
    held_out = first.fit_cues(samples).held_out(samples)
    counts = CALLS["fit"], CountedSVM.trained
    # All samples and five folds; the folds of beams share a Gram matrix, so that none is trained.
    assert counts == (1 + 5, 1 + 1 + 5)
    first.fit_integrator(held_out)
    second = Pipeline(first.cues, SVMDAS(SVM(Linear(), C=1.0))).fit_integrator(held_out)
    assert (CALLS["fit"], CountedSVM.trained) == counts
    whole = Pipeline(cues, SVMDAS(SVM(RBF(0.3)))).fit(Walk())
    for one, other in zip(first.beliefs(Walk(seed=1)), whole.beliefs(Walk(seed=1)), strict=True):
        assert np.array_equal(one.scores.values, other.scores.values)
    labels = [belief.label for belief in second.beliefs(Walk(seed=1))]
    assert np.mean([a == o.label for a, o in zip(labels, Walk(seed=1), strict=True)]) > 0.9


# ---------------------------------------------------------------------- the set itself


def of_numbers(asked: list[list[int]] | None = None, views: int = 2) -> TrainingSet:
    """Six samples whose features are their numbers, minus them as copies; by a cue that learns."""

    def relearn(rows: np.ndarray) -> TrainingSet:
        if asked is not None:
            asked.append(rows.tolist())
        recorded = 10.0 + np.arange(6.0)[:, None]
        return replace(whole, features=recorded, augmented=(100.0 + recorded - 10,) * (views - 1))

    recorded = np.arange(6.0)[:, None]
    whole = TrainingSet(
        recorded,
        np.array([*"abcabc"]),
        np.arange(6) * toys.SECOND,
        np.array([0, 0, 0, 1, 1, 1]),
        (-recorded,) * (views - 1),
        folds=Blocks(n_folds=2),
        relearn=relearn,
    )
    return whole


def test_each_sample_is_followed_by_its_copies() -> None:
    training = of_numbers().take(np.array([1, 2, 4]))
    assert training.batch().ravel().tolist() == [1, -1, 2, -2, 4, -4]
    assert training.repeated(training.stamps).tolist() == [1e9, 1e9, 2e9, 2e9, 4e9, 4e9]
    assert training.copies(np.array([0, 2])).tolist() == [0, 1, 4, 5]
    assert training.recorded(np.array([0, 2])).tolist() == [0, 4]
    assert training.groups.tolist() == [0, 0, 1]


@pytest.mark.parametrize("views", [1, 2])
def test_a_part_of_a_set_learns_from_its_own_rows(views: int) -> None:
    asked: list[list[int]] = []
    training = of_numbers(asked, views).take(np.array([1, 2, 4, 5]))
    relearned = training.relearned(np.array([0, 2]))
    assert asked == [[1, 4]]
    assert relearned.features.ravel().tolist() == [11, 12, 14, 15]
    inner = relearned.take(np.array([0, 2])).relearned(np.array([1]))
    assert asked == [[1, 4], [4]]
    assert inner.features.ravel().tolist() == [11, 14]


def test_a_set_that_learns_nothing_stays_as_it_is() -> None:
    plain = replace(of_numbers(), relearn=None)
    assert plain.relearned(np.array([0, 1])) is plain
    assert plain.take(np.array([0, 1])).relearned(np.array([1])).features.ravel().tolist() == [0, 1]


def test_the_set_s_folds_are_those_of_who_has_none() -> None:
    training = of_numbers()
    halves = [held_out.tolist() for _, held_out in training.split()]
    assert halves == [[0, 1, 2], [3, 4, 5]]
    assert [h.tolist() for _, h in training.split(Blocks(n_folds=2))] == halves


def test_the_pipeline_s_folds_are_inherited() -> None:
    asked: list[str] = []

    class Noted(Blocks):
        def assign(self, labels, *others):  # type: ignore[no-untyped-def]
            asked.append(self.name)
            return super().assign(labels, *others)

    def noted(name: str, n_folds: int = 3) -> FoldScheme:
        scheme = Noted(n_folds=n_folds)
        object.__setattr__(scheme, "name", name)
        return scheme

    own = noted("own")
    cues = {
        "beams": (Beams(), SVM(RBF(0.1), search={"C": [1, 10]})),
        "few": (Beams(2), SVM(RBF(0.1), search={"C": [1, 10]}, folds=own)),
        "search": (Beams(3), GridSearch(SVM(RBF(0.1)), {"C": [1, 10]})),
    }
    Noted.name = "own"  # a copy of the SVM has a copy of its scheme
    integrator = SVMDAS(SVM(RBF(0.3), search={"C": [1, 10]}))
    Pipeline(cues, integrator, folds=noted("pipeline")).fit(Walk())
    searches = ["pipeline", "own", "pipeline"]
    # Out-of-fold, and the integrator's of each set of three cues.
    assert asked == [*searches, *["pipeline"] * 3, *["pipeline"] * 7]


def test_samples_are_learned_from_in_their_order_and_once() -> None:
    cue = ByHeart()
    samples = collect(Walk(), {"heart": cue})
    training = samples.training_set("heart", cue)
    relearned = training.relearned(np.array([70, 3, 3, 25]))
    # Of the samples that it has not learned from, the cue guesses: it knows these three.
    codes = np.array([PLACES.index(label) for label in samples.labels])
    for row in (3, 25, 70):
        assert take(relearned.features, np.array([row]))[0].argmax() == codes[row]
    assert cue.stamps_.tolist() == samples.stamps.tolist()
