"""The parameter search: every parameter, fold scheme, picture."""

import cv2
import joblib
import numpy as np
import pytest
from scipy import sparse
from sklearn.metrics import balanced_accuracy_score
from sklearn.multiclass import OneVsRestClassifier
from sklearn.svm import SVC

from placecue import DataError, InterleavedChunks, OneAgainstOne, UsageError, progress
from placecue.evaluation.search_figure import draw_search, search_rows, search_table
from placecue.folds import Blocks, ByLog
from placecue.scaling import RangeScaling, StandardScaling
from placecue_classifiers.svm import SVM
from placecue_kernels.chi2 import Chi2
from placecue_kernels.linear import Linear
from placecue_kernels.match import Match
from placecue_kernels.rbf import RBF

Blobs = tuple[np.ndarray, np.ndarray]
SECOND = 10**9


class Blurred(RBF):
    """A kernel with a parameter that the distances depend on."""

    made = 0

    def __init__(self, gamma: float = 0.05, blur: float = 0.0) -> None:
        super().__init__(gamma)
        self.blur = blur

    def shared(self, a, b=None):  # type: ignore[no-untyped-def]
        Blurred.made += 1
        return super().shared(a, b) ** (1 - self.blur)


def test_every_combination_is_tried_and_the_best_is_taken(seen: Blobs) -> None:
    tried = {
        "multiclass": ["oaa", "oao", "modified_oaa"],
        "C": [1, 100],
        "gamma": [0.001, 0.01],
        "scaling": [None, StandardScaling()],
        "class_weight": ["balanced", None],
    }
    svm = SVM(RBF(), search=tried).fit(*seen)
    table = svm.search_
    assert len(table["C"]) == 3 * 2 * 2 * 2 * 2
    assert len({tuple(str(table[name][i]) for name in tried) for i in range(48)}) == 48
    best = int(np.argmax(table["balanced_accuracy"]))
    assert svm.chosen_ == {name: table[name][best] for name in tried}
    again = svm.best().fit(*seen)
    assert again.search is None
    assert (again.scores(seen[0]).values == svm.scores(seen[0]).values).all()
    assert again.layout_ == svm.layout_


@pytest.mark.parametrize("multiclass", ["oaa", "oao"])
def test_points_are_those_of_scikit_learn_in_the_same_folds(seen: Blobs, multiclass: str) -> None:
    features, labels = seen
    folds = Blocks(n_folds=4)
    costs, gammas = [1.0, 10.0, 100.0], [0.003, 0.03]
    search = {"C": costs, "gamma": gammas}
    svm = SVM(RBF(), multiclass=multiclass, search=search, folds=folds).fit(features, labels)
    for point, accuracy in enumerate(svm.search_["balanced_accuracy"]):
        gamma, cost = svm.search_["gamma"][point], svm.search_["C"][point]
        peer = SVC(gamma=gamma, C=cost, class_weight="balanced", break_ties=False)
        peer = OneVsRestClassifier(peer) if multiclass == "oaa" else peer
        truth, predicted = [], []
        for training, held_out in Blocks(n_folds=4).split(labels):
            peer.fit(features[training], labels[training])
            predicted += peer.predict(features[held_out]).tolist()
            truth += labels[held_out].tolist()
        # Ties among one-against-one votes are broken in another way.
        limit = 1e-9 if multiclass == "oaa" else 0.03
        assert accuracy == pytest.approx(balanced_accuracy_score(truth, predicted), abs=limit)


def test_distances_are_computed_once_for_each_parameter_that_changes_them(seen: Blobs) -> None:
    Blurred.made = 0
    tried = {"kernel__blur": [0.0, 0.2, 0.4], "gamma": [0.01, 0.1], "C": [1, 10]}
    svm = SVM(Blurred(), search=tried).fit(*seen)
    again = svm.chosen_["kernel__blur"] != 0.4  # the last of them is still at hand
    assert Blurred.made == 3 + again
    assert svm.kernel_.blur == svm.chosen_["kernel__blur"]
    assert svm.kernel_.gamma == svm.chosen_["gamma"]


def test_a_kernel_without_gamma_is_computed_once(seen: Blobs) -> None:
    made = []

    class Counted(Linear):
        def gram(self, a, b=None):  # type: ignore[no-untyped-def]
            made.append(1)
            return super().gram(a, b)

    tried = {"C": [0.01, 0.1, 1.0], "multiclass": ["oaa", "oao"]}
    svm = SVM(Counted(), search=tried, probability="isotonic").fit(*seen)
    assert len(made) == 1
    svm.scores(seen[0])
    assert len(made) == 2
    # A scaling learns from the training rows of each fold: in the search, and in calibration.
    made.clear()
    SVM(Counted(), search=tried, probability="isotonic", scaling=StandardScaling()).fit(*seen)
    assert len(made) == 1 + 5 + 5


def test_a_kernel_without_gamma_is_searched_for_its_other_parameters(seen: Blobs) -> None:
    svm = SVM(Linear(), search={"C": [0.01, 1.0]}, scaling=StandardScaling()).fit(*seen)
    assert list(svm.search_) == ["C", "balanced_accuracy"]
    with pytest.raises(UsageError, match="cannot vary 'kernel__power'"):
        SVM(Linear(), search={"kernel__power": [2]}).fit(*seen)


def test_progress_is_told_of(seen: Blobs) -> None:
    told: list[tuple[str, int]] = []

    def report(items, what, total):  # type: ignore[no-untyped-def]
        told.append((what, total))
        return items

    token = progress._reporter.set(report)
    try:
        tried = {"C": [1, 100], "gamma": [0.001, 0.01, 0.1], "scaling": [RangeScaling(), None]}
        SVM(RBF(), search=tried, probability="isotonic").fit(*seen)
    finally:
        progress._reporter.reset(token)
    # Scalings are learned in each of five folds: so many matrices of three gammas, twice.
    assert told == [("searching parameters", 30), ("calibrating", 5)]


def test_threads_find_the_same(seen: Blobs) -> None:
    tried = {"C": [1, 100], "gamma": [0.001, 0.01]}
    one = SVM(RBF(), search=tried).fit(*seen)
    with joblib.parallel_config(n_jobs=2):
        two = SVM(RBF(), search=tried).fit(*seen)
    assert one.search_ == two.search_


def test_parameters_are_picked_on_the_second_sequence(seen: Blobs, unseen: Blobs) -> None:
    features = np.concatenate([seen[0], unseen[0]])
    labels = np.concatenate([seen[1], unseen[1]])
    first, second = np.arange(len(seen[1])), np.arange(len(unseen[1]))
    stamps = np.concatenate([first, second + 7200]) * SECOND
    costs = [0.1, 1.0, 10.0, 100.0]
    folds = ByLog(only_last=True)
    svm = SVM(RBF(0.01), search={"C": costs}, folds=folds).fit(features, labels, stamps)
    for cost, accuracy in zip(costs, svm.search_["balanced_accuracy"], strict=True):
        peer = OneVsRestClassifier(SVC(gamma=0.01, C=cost, class_weight="balanced")).fit(*seen)
        expected = balanced_accuracy_score(unseen[1], peer.predict(unseen[0]))
        assert accuracy == pytest.approx(expected)


@pytest.mark.parametrize("multiclass", ["oaa", "oao", "modified_oaa"])
def test_trained_on_the_first_sequence_picked_on_the_second(
    seen: Blobs, unseen: Blobs, multiclass: str
) -> None:
    features = np.concatenate([seen[0], unseen[0]])
    labels = np.concatenate([seen[1], unseen[1]])
    first, second = np.arange(len(seen[1])), np.arange(len(unseen[1]))
    stamps = np.concatenate([first, second + 7200]) * SECOND
    tried = {"C": [0.1, 1.0, 10.0], "gamma": [0.001, 0.01]}
    both = {"multiclass": multiclass, "folds": ByLog(only_last=True)}
    svm = SVM(RBF(), search=tried, refit=False, **both).fit(features, labels, stamps)
    alone = SVM(RBF(svm.kernel_.gamma), C=svm.C_, multiclass=multiclass).fit(*seen)
    assert svm.scores(unseen[0]).values == pytest.approx(alone.scores(unseen[0]).values, abs=1e-9)
    assert len(svm.support_features_) <= len(seen[1])
    reached = balanced_accuracy_score(unseen[1], alone.predict(unseen[0]))
    assert reached == pytest.approx(max(svm.search_["balanced_accuracy"]))
    # With refit the second sequence is learned from too.
    refitted = SVM(RBF(), search=tried, **both).fit(features, labels, stamps)
    assert len(refitted.support_features_) > len(svm.support_features_)
    again = svm.best()
    assert (again.search, again.refit, again.C) == (None, True, svm.C_)


def test_one_against_one_of_two_classes_keeps_its_sign(seen: Blobs) -> None:
    features, labels = seen
    two = np.where(labels == "lab", "lab", "office")
    svm = SVM(RBF(0.02), C=10.0, multiclass="oao").fit(features, two)
    peer = SVC(gamma=0.02, C=10.0, class_weight="balanced").fit(features, two)
    # Positive means that the first class, the lab, wins.
    assert svm.scores(features).values[:, 0] == pytest.approx(-peer.decision_function(features))
    assert (svm.predict(features) == peer.predict(features)).all()
    assert isinstance(svm.layout_, OneAgainstOne)


@pytest.mark.parametrize("multiclass", ["oaa", "oao"])
def test_class_weights_by_name_equal_scikit_learn_s(seen: Blobs, multiclass: str) -> None:
    features, labels = seen
    weight = {"lab": 5.0, "office": 0.5}
    svm = SVM(RBF(0.02), C=1.0, multiclass=multiclass, class_weight=weight).fit(features, labels)
    if multiclass == "oao":
        peer = SVC(gamma=0.02, C=1.0, class_weight=weight, decision_function_shape="ovo")
        expected = peer.fit(features, labels).decision_function(features)
    else:
        each = np.array([weight.get(label, 1.0) for label in labels])
        expected = np.stack(
            [
                SVC(gamma=0.02, C=1.0)
                .fit(features, labels == name, sample_weight=each)
                .decision_function(features)
                for name in np.unique(labels)
            ],
            axis=1,
        )
    assert svm.scores(features).values == pytest.approx(expected, abs=1e-9)


def test_bad_samples_are_named(seen: Blobs) -> None:
    features, labels = seen
    tried = {"C": [1.0]}
    alone = np.where(np.arange(len(labels)) == 0, "attic", labels)
    with pytest.raises(DataError, match="class 'attic' has one sample only"):
        SVM(RBF(), search=tried).fit(features, alone)
    with pytest.raises(DataError, match="is not finite: they are too large"):
        SVM(RBF()).fit(features * 1e200, labels)
    few = np.concatenate([np.flatnonzero(labels == name)[:2] for name in np.unique(labels)])
    small = SVM(RBF(), search=tried, folds=InterleavedChunks(n_folds=5)).fit(
        features[few], labels[few]
    )
    assert len(small.search_["C"]) == 1
    with pytest.raises(UsageError, match="takes set of local descriptors, got sparse histogram"):
        SVM(Match()).fit(sparse.csr_array(features), labels)
    with pytest.raises(DataError, match="histograms"):
        SVM(Chi2()).fit(features, labels)


# ---------------------------------------------------------------------- table and heat map

RESULTS = {
    "scaling": [
        None,
        None,
        None,
        None,
        RangeScaling(),
        RangeScaling(),
        RangeScaling(),
        RangeScaling(),
    ],
    "gamma": [0.1, 0.1, 1.0, 1.0] * 2,
    "C": [1, 100] * 4,
    "balanced_accuracy": [0.5, 0.6, 0.7, 0.65, 0.4, 0.9, 0.3, 0.2],
}


def test_the_table_begins_with_the_best() -> None:
    rows = search_rows(RESULTS)
    # A scaling goes by the name that it is registered under, once it has been built by it.
    assert {rows[0][0], rows[-1][0]} <= {"range", "RangeScaling"}
    assert rows[0][1:] == ["0.1", "100", "90.0"]
    assert rows[-1][1:] == ["1", "100", "20.0"]
    lines = search_table(RESULTS).splitlines()
    assert lines[0] == "| scaling | gamma | C | balanced accuracy (%) |"
    assert lines[3] == "| - | 1 | 1 | 70.0 |"
    assert len(lines) == 10


def test_the_heat_map_is_drawn(tmp_path) -> None:  # type: ignore[no-untyped-def]
    path = draw_search(RESULTS, tmp_path / "search.png", title="crfh")
    assert cv2.imread(str(path)).shape[1] >= 450
    only = {"C": [1, 10], "balanced_accuracy": [0.5, 0.6]}
    assert draw_search(only, tmp_path / "c.svg").exists()
    other = {"class_weight": ["balanced", None], "balanced_accuracy": [0.5, 0.6]}
    with pytest.raises(UsageError, match="neither gamma nor C was searched; searched: class_w"):
        draw_search(other, tmp_path / "x.png")
    assert draw_search(other, tmp_path / "x.png", across="class_weight").exists()
