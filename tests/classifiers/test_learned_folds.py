"""In the folds of a search or a calibration, a cue has learned from the training rows only.

Five classes throughout.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest
from sklearn.metrics import balanced_accuracy_score
from sklearn.multiclass import OneVsRestClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from placecue import (
    Blocks,
    ByLog,
    DataError,
    OneAgainstAll,
    QuantileScaling,
    RangeScaling,
    Scaling,
    StandardScaling,
    progress,
)
from placecue.classifier import Classifier
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.calibration import calibrators
from placecue_classifiers.grid_search import GridSearch
from placecue_classifiers.svm import SVM
from placecue_kernels.combined import Sum
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF

Samples = tuple[np.ndarray, np.ndarray]
BLOCKS = Blocks(n_folds=4)


class Stretched:
    """A cue that learns: divides its features by their spread in the samples it has learned from.

    Parameters
    ----------
    features : ndarray of float64, shape (n, d)
    """

    def __init__(self, features: np.ndarray) -> None:
        self.features = features
        self.calls: list[np.ndarray] = []

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        self.calls.append(rows)
        return self.features / np.ptp(self.features[rows], axis=0)

    def everything(self) -> np.ndarray:
        return self.features / np.ptp(self.features, axis=0)


def splits(labels: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    return list(Blocks(n_folds=4).split(labels))


def pooled(peer: Any, cue: Stretched, labels: np.ndarray) -> float:
    """Balanced accuracy of a classifier of scikit-learn, fold by fold."""
    predicted = np.empty_like(labels)
    for training, held_out in splits(labels):
        features = cue.features / np.ptp(cue.features[training], axis=0)
        peer.fit(features[training], labels[training])
        predicted[held_out] = peer.predict(features[held_out])
    return float(balanced_accuracy_score(labels, predicted))


@pytest.mark.parametrize("scaling", [None, StandardScaling()])
def test_points_of_an_svm_are_those_of_scikit_learn(seen: Samples, scaling: Scaling | None) -> None:
    features, labels = seen
    cue = Stretched(features)
    search = {"C": [0.1, 1.0, 10.0], "gamma": [0.1, 1.0]}
    svm = SVM(RBF(), search=search, scaling=scaling, folds=BLOCKS)
    svm.fit_on_learned(cue.everything(), labels, None, cue)
    for point, accuracy in enumerate(svm.search_["balanced_accuracy"]):
        gamma, cost = svm.search_["gamma"][point], svm.search_["C"][point]
        peer = OneVsRestClassifier(SVC(gamma=gamma, C=cost, class_weight="balanced"))
        if scaling is not None:
            peer = make_pipeline(StandardScaler(), peer)
        assert accuracy == pytest.approx(pooled(peer, cue, labels))
    plain = svm.chosen().fit(cue.everything(), labels)
    assert np.array_equal(plain.scores(features).values, svm.scores(features).values)


@pytest.mark.parametrize("kernel", [RBF(1.0), Linear(), HistogramIntersection()])
def test_an_svm_asks_for_the_training_rows_of_each_fold(seen: Samples, kernel: Any) -> None:
    features, labels = seen
    cue = Stretched(features)
    svm = SVM(kernel, search={"C": [1.0, 10.0]}, probability="sigmoid", folds=BLOCKS)
    svm.fit_on_learned(cue.everything(), labels, None, cue)
    expected = 2 * [training.tolist() for training, _ in splits(labels)]  # search, calibration
    assert [rows.tolist() for rows in cue.calls] == expected


class Noting(HistogramIntersection):
    """Notes the samples that it is fitted on."""

    fitted_on: ClassVar[list[np.ndarray]] = []

    def fit(self, features: np.ndarray) -> Noting:
        self.fitted_on.append(features)
        return super().fit(features)


def test_scaling_and_kernel_learn_from_the_training_rows_of_each_fold(seen: Samples) -> None:
    features, labels = seen
    cue = Stretched(features)
    Noting.fitted_on.clear()
    svm = SVM(Noting(), search={"C": [1.0, 10.0]}, scaling=StandardScaling(), folds=BLOCKS)
    svm.fit_on_learned(cue.everything(), labels, None, cue)
    rows = [training for training, _ in splits(labels)]
    expected = [StandardScaler().fit_transform(cue(each)[each]) for each in rows]
    expected.append(StandardScaler().fit_transform(cue.everything()))
    for found, wanted in zip(Noting.fitted_on, expected, strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-9)


@pytest.mark.parametrize("kernel", [RBF(1.0), Sum([RBF(1.0), Linear()])], ids=["rbf", "sum"])
def test_every_parameter_is_searched_in_features_of_the_fold(seen: Samples, kernel: Any) -> None:
    features, labels = seen
    cue = Stretched(features)
    gamma = "gamma" if isinstance(kernel, RBF) else "kernel__kernels__0__gamma"
    tried = {"scaling": [StandardScaling(), RangeScaling()], gamma: [0.01, 3.0], "C": [0.1, 10.0]}
    svm = SVM(kernel, search=tried, folds=BLOCKS).fit_on_learned(
        cue.everything(), labels, None, cue
    )
    points = {}
    for scaling in tried["scaling"]:
        for value in tried[gamma]:
            one = SVM(kernel, search={**tried, "scaling": [scaling], gamma: [value]}, folds=BLOCKS)
            found = one.fit_on_learned(cue.everything(), labels, None, cue).search_
            for cost, accuracy in zip(found["C"], found["balanced_accuracy"], strict=True):
                points[scaling, value, cost] = accuracy
    assert len(set(points.values())) > 4
    table = (svm.search_[name] for name in ("scaling", gamma, "C", "balanced_accuracy"))
    assert {each[:3]: each[3] for each in zip(*table, strict=True)} == pytest.approx(points)


def test_calibrated_with_what_was_chosen(seen: Samples) -> None:
    features, labels = seen
    cue = Stretched(features)
    search = {"gamma": [0.5], "C": [3.0], "scaling": [StandardScaling()]}
    svm = SVM(RBF(100.0), search=search, probability="sigmoid", folds=BLOCKS)
    svm.fit_on_learned(cue.everything(), labels, None, cue)
    plain = SVM(RBF(0.5), C=3.0, scaling=StandardScaling(), probability="sigmoid", folds=BLOCKS)
    plain.fit_on_learned(cue.everything(), labels, None, cue)
    assert np.array_equal(np.array(svm.calibrators_), np.array(plain.calibrators_))


def test_a_plain_svm_asks_for_nothing(seen: Samples) -> None:
    features, labels = seen
    cue = Stretched(features)
    learned = SVM(RBF(0.1)).fit_on_learned(cue.everything(), labels, None, cue)
    plain = SVM(RBF(0.1)).fit(cue.everything(), labels)
    assert not cue.calls
    assert np.array_equal(learned.scores(features).values, plain.scores(features).values)


def test_calibration_learns_from_features_of_each_fold(seen: Samples) -> None:
    features, labels = seen
    cue = Stretched(features)
    svm = SVM(RBF(1.0), C=1.0, probability="sigmoid", folds=BLOCKS)
    svm.fit_on_learned(cue.everything(), labels, None, cue)
    outputs, codes = [], []
    for training, held_out in splits(labels):
        of_fold = cue(training)
        peer = OneVsRestClassifier(SVC(gamma=1.0, C=1.0, class_weight="balanced"))
        peer.fit(of_fold[training], labels[training])
        outputs.append(peer.decision_function(of_fold[held_out]))
        codes.append(np.unique(labels, return_inverse=True)[1][held_out])
    layout = OneAgainstAll(tuple(np.unique(labels)))
    expected = calibrators("sigmoid", layout, np.concatenate(outputs), np.concatenate(codes))
    assert np.array(svm.calibrators_) == pytest.approx(np.array(expected), rel=1e-2)


def test_trained_on_the_first_sequence(seen: Samples, unseen: Samples) -> None:
    features = np.concatenate([seen[0], unseen[0]])
    labels = np.concatenate([seen[1], unseen[1]])
    first = len(seen[1])
    stamps = (np.arange(len(labels)) + 7200 * (np.arange(len(labels)) >= first)) * 10**9
    cue = Stretched(features)
    folds = ByLog(only_last=True)
    svm = SVM(RBF(1.0), search={"C": [0.1, 1.0, 10.0]}, folds=folds, refit=False)
    svm.fit_on_learned(cue.everything(), labels, stamps, cue)
    [asked] = cue.calls
    assert asked.tolist() == list(range(first))
    plain = SVM(RBF(1.0), C=svm.chosen_["C"]).fit(cue.everything()[:first], labels[:first])
    found, expected = (each.scores(features).values for each in (svm, plain))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_grid_search_finds_what_a_loop_finds(seen: Samples) -> None:
    features, labels = seen
    # What spreads is what a stump does not look at: shift the features instead.
    shift = lambda rows: features - features[rows].mean(axis=0)  # noqa: E731
    found = GridSearch(AdaBoost(), {"rounds": [1, 5, 20]}, BLOCKS)
    found.fit_on_learned(shift(np.arange(len(labels))), labels, None, shift)
    expected = []
    for rounds in (1, 5, 20):
        predicted = np.empty_like(labels)
        for training, held_out in splits(labels):
            model = AdaBoost(rounds=rounds)
            model.fit(shift(training)[training], labels[training])
            predicted[held_out] = model.predict(shift(training)[held_out])
        expected.append(balanced_accuracy_score(labels, predicted))
    assert found.search_["balanced_accuracy"] == pytest.approx(expected)
    whole = AdaBoost(rounds=found.chosen_["rounds"]).fit(shift(np.arange(len(labels))), labels)
    assert np.array_equal(found.scores(features).values, whole.scores(features).values)


def test_folds_inside_folds_learn_from_their_own_rows(seen: Samples) -> None:
    features, labels = seen
    cue = Stretched(features)
    inner = SVM(RBF(1.0), probability="sigmoid", folds=Blocks(n_folds=2))
    search = GridSearch(inner, {"C": [1.0, 10.0]}, BLOCKS)
    search.fit_on_learned(cue.everything(), labels, None, cue)
    expected = []
    for training, _ in splits(labels):
        nested = [training[rows] for rows, _ in Blocks(n_folds=2).split(labels[training])]
        expected += [training, *nested, *nested]  # nested once for each C
    expected += [rows for rows, _ in Blocks(n_folds=2).split(labels)]
    assert [rows.tolist() for rows in cue.calls] == [rows.tolist() for rows in expected]


def test_folds_inside_folds_are_cut_along_the_stamps(seen: Samples) -> None:
    features, labels = np.tile(seen[0], (3, 1)), np.tile(seen[1], 3)
    log = np.arange(len(labels)) // len(seen[1])
    stamps = (np.arange(len(labels)) + 7200 * log) * 10**9
    cue = Stretched(features)
    inner = SVM(RBF(1.0), probability="sigmoid", folds=ByLog())
    told: list[tuple[str, int]] = []

    def report(items: Any, what: str, total: int) -> Any:
        told.append((what, total))
        return items

    token = progress._reporter.set(report)
    try:
        search = GridSearch(inner, {"C": [1.0, 10.0]}, ByLog(n_folds=3))
        search.fit_on_learned(cue.everything(), labels, stamps, cue)
    finally:
        progress._reporter.reset(token)
    assert told[0] == ("searching parameters", 6)
    logs = [np.unique(log[rows]).tolist() for rows in cue.calls]
    assert logs[:5] == [[1, 2], [2], [1], [2], [1]]
    assert logs[-3:] == [[1, 2], [0, 2], [0, 1]]


def test_a_search_inside_a_search_is_made_once(seen: Samples) -> None:
    features, labels = seen
    inner = SVM(RBF(), search={"gamma": [0.01, 0.1]}, folds=BLOCKS)
    search = GridSearch(inner, {"C": [1.0, 10.0]}, BLOCKS).fit(features, labels)
    chosen = search.chosen()
    assert chosen.search is None
    assert (chosen.C, chosen.kernel.gamma) == (
        search.chosen_["C"],
        search.classifier_.chosen_["gamma"],
    )


def memorised(rows: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Features that tell the class of the samples learned from, and nothing of the others."""
    codes = np.unique(labels, return_inverse=True)[1]
    known = np.random.default_rng(0).integers(0, 5, len(labels))
    known[rows] = codes[rows]
    return np.eye(5)[known]


@pytest.mark.parametrize(
    "classifier",
    [
        SVM(RBF(1.0), search={"C": [1.0, 100.0], "gamma": [0.1, 1.0]}),
        SVM(RBF(1.0), search={"C": [1.0, 100.0], "scaling": [QuantileScaling(), RangeScaling()]}),
        GridSearch(AdaBoost(), {"rounds": [5, 20]}),
    ],
    ids=["svm", "scaled", "grid_search"],
)
def test_learning_by_heart_gains_nothing(seen: Samples, classifier: Classifier) -> None:
    labels = np.tile(seen[1], 4)
    features = memorised(np.arange(len(labels)), labels)
    shared = classifier.fit(features, labels).search_["balanced_accuracy"]
    assert max(shared) == 1
    classifier.fit_on_learned(features, labels, None, lambda rows: memorised(rows, labels))
    assert max(classifier.search_["balanced_accuracy"]) < 0.3
    assert (classifier.predict(features) == labels).all()


def test_features_of_a_fold_are_checked(seen: Samples) -> None:
    features, labels = seen
    svm = SVM(RBF(1.0), search={"C": [1.0, 10.0]})
    for classifier in (svm, GridSearch(AdaBoost(), {"rounds": [1, 2]})):
        for spoilt, said in ((features * np.nan, "NaN"), (features[:-1], "inconsistent numbers")):
            with pytest.raises(DataError, match=said):
                classifier.fit_on_learned(features, labels, None, lambda rows: spoilt)  # noqa: B023
