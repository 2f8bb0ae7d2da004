"""SVM agrees with scikit-learn's own on the same kernel; four classes or more throughout."""

from itertools import combinations

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.datasets import make_blobs
from sklearn.metrics import balanced_accuracy_score
from sklearn.model_selection import GridSearchCV
from sklearn.multiclass import OneVsRestClassifier
from sklearn.svm import SVC

from placecue import (
    DataError,
    InterleavedChunks,
    Kernel,
    OneAgainstAll,
    OneAgainstOne,
    UsageError,
)
from placecue.scaling import QuantileScaling, RangeScaling, StandardScaling
from placecue_classifiers.machines import one_against_all, one_against_one
from placecue_classifiers.svm import SVM
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF

NAMES = np.array(["corridor", "kitchen", "lab", "office", "printer"])


@pytest.fixture(scope="module")
def blobs() -> tuple[np.ndarray, np.ndarray]:
    features, codes = make_blobs(
        n_samples=[60, 30, 20, 40, 25], n_features=6, cluster_std=5.0, random_state=3
    )
    return features, codes


def test_one_against_all_equals_scikit_learn(blobs: tuple[np.ndarray, np.ndarray]) -> None:
    features, codes = blobs
    svm = SVM(kernel=RBF(gamma=0.02), C=10.0, multiclass="oaa").fit(features, NAMES[codes])
    peer = OneVsRestClassifier(SVC(gamma=0.02, C=10.0, class_weight="balanced"))
    expected = peer.fit(features, codes).decision_function(features)
    assert svm.scores(features).values == pytest.approx(expected, abs=1e-9)
    assert (svm.predict(features) == NAMES[peer.predict(features)]).all()
    assert isinstance(svm.layout_, OneAgainstAll)


def test_one_against_one_equals_scikit_learn(blobs: tuple[np.ndarray, np.ndarray]) -> None:
    features, codes = blobs
    svm = SVM(kernel=RBF(gamma=0.02), C=10.0, multiclass="oao").fit(features, NAMES[codes])
    peer = SVC(gamma=0.02, C=10.0, class_weight="balanced", decision_function_shape="ovo")
    expected = peer.fit(features, codes).decision_function(features)
    # LIBSVM stops each machine at a tolerance of 1e-3.
    assert svm.scores(features).values == pytest.approx(expected, abs=5e-3)
    assert isinstance(svm.layout_, OneAgainstOne)
    assert svm.scores(features).values.shape[1] == 10


@pytest.mark.parametrize("kernel", [RBF(0.02), Linear(), HistogramIntersection()], ids=str)
def test_decisions_equal_scikit_learn_s_on_the_same_gram_matrix(
    blobs: tuple[np.ndarray, np.ndarray], kernel: Kernel
) -> None:
    features, codes = blobs
    gram = kernel.fit(features).gram(features)
    peer = SVC(kernel="precomputed", C=10.0, class_weight="balanced")
    rest = OneVsRestClassifier(peer).fit(gram, codes)
    pairs = clone(peer).set_params(decision_function_shape="ovo").fit(gram, codes)
    # Classes are equally many, and so all weights 1; LIBSVM stops each machine at 1e-3.
    for multiclass, each, slack in (("oaa", rest, 1e-9), ("oao", pairs, 1e-2)):
        svm = SVM(kernel=kernel, C=10.0, multiclass=multiclass).fit(features, NAMES[codes])
        expected = each.decision_function(gram)
        assert svm.scores(features).values == pytest.approx(expected, rel=1e-6, abs=slack)


@pytest.mark.parametrize("weights", ["balanced", None, np.array([0.3, 2.0, 1.0, 5.0])], ids=str)
def test_each_machine_of_a_pair_is_scikit_learn_s_on_that_pair(
    weights: str | np.ndarray | None,
) -> None:
    rng = np.random.default_rng(8)
    codes = np.repeat(np.arange(4), (40, 5, 12, 23))  # the pairs' weights differ by class sizes
    rng.shuffle(codes)
    gram = RBF(0.3).gram(rng.normal(size=(80, 3)) + np.eye(4, 3)[codes])
    machines = one_against_one(gram, codes, 0.7, weights)
    found, pairs = machines.decide(gram), list(combinations(range(4), 2))
    assert machines.coefficients.shape == (80, len(pairs))
    for column, (i, j) in enumerate(pairs):
        rows = np.flatnonzero((codes == i) | (codes == j))
        weight = dict.fromkeys((i, j), 1.0)
        if isinstance(weights, str):
            # By inverse frequency within the pair, n_pair / (2 n_i).
            weight = {code: len(rows) / (2 * np.sum(codes == code)) for code in (i, j)}
        elif weights is not None:
            weight = {code: weights[code] for code in (i, j)}
        peer = SVC(kernel="precomputed", C=0.7, class_weight=weight)
        peer.fit(gram[np.ix_(rows, rows)], codes[rows])
        # scikit-learn's second class is positive, ours the first of the pair.
        expected = -peer.decision_function(gram[:, rows])
        np.testing.assert_allclose(found[:, column], expected, rtol=1e-9, atol=1e-12)


def test_modified_one_against_all_has_the_training_means(
    blobs: tuple[np.ndarray, np.ndarray],
) -> None:
    features, codes = blobs
    svm = SVM(kernel=RBF(gamma=0.02), multiclass="modified_oaa").fit(features, NAMES[codes])
    plain = SVM(kernel=RBF(gamma=0.02), multiclass="oaa").fit(features, NAMES[codes])
    outputs = plain.scores(features).values
    means = [outputs[codes == code, code].mean() for code in range(5)]
    assert svm.scores(features).values == pytest.approx(outputs - means)
    winner = np.abs(outputs - means).argmin(axis=1)
    assert svm.predict(features).tolist() == NAMES[winner].tolist()


def test_only_support_vectors_are_kept(blobs: tuple[np.ndarray, np.ndarray]) -> None:
    features, codes = blobs
    gram = RBF(gamma=0.02).gram(features)
    for train in (one_against_all, one_against_one):
        machines = train(gram, codes, 10.0, "balanced")
        used = np.any(machines.coefficients != 0, axis=1)
        assert used.sum() < len(features)
        kept = machines.coefficients[used]
        assert gram[:, used] @ kept + machines.intercepts == pytest.approx(machines.decide(gram))


def test_search_finds_what_an_exhaustive_loop_finds(
    blobs: tuple[np.ndarray, np.ndarray],
) -> None:
    features, codes = blobs
    labels, stamps = NAMES[codes], np.arange(len(codes)) * 10**9
    costs, gammas = [0.1, 1.0, 10.0], [0.001, 0.01, 0.1]
    svm = SVM(kernel=RBF(), search={"C": costs, "gamma": gammas}).fit(features, labels, stamps)
    splits = list(InterleavedChunks().split(labels, stamps))
    best = {}
    for gamma in gammas:
        for cost in costs:
            peer = OneVsRestClassifier(SVC(gamma=gamma, C=cost, class_weight="balanced"))
            truth, predicted = [], []
            for training, held_out in splits:
                peer.fit(features[training], codes[training])
                predicted += peer.predict(features[held_out]).tolist()
                truth += codes[held_out].tolist()
            best[cost, gamma] = balanced_accuracy_score(truth, predicted)
    found = zip(svm.search_["C"], svm.search_["gamma"], strict=True)
    for point, accuracy in zip(found, svm.search_["balanced_accuracy"], strict=True):
        assert accuracy == pytest.approx(best[point], abs=0.01)
    assert best[svm.C_, svm.kernel_.gamma] == pytest.approx(max(best.values()), abs=0.01)


def test_the_gram_matrix_of_a_gamma_is_computed_once(
    blobs: tuple[np.ndarray, np.ndarray],
) -> None:
    calls = []

    class Counted(RBF):
        def shared(self, a, b=None):  # type: ignore[no-untyped-def]
            calls.append(1)
            return super().shared(a, b)

    features, codes = blobs
    SVM(kernel=Counted(), search={"C": [1, 10], "gamma": [0.01, 0.1]}).fit(features, NAMES[codes])
    assert len(calls) == 1


def test_chosen_fixes_what_the_search_found(blobs: tuple[np.ndarray, np.ndarray]) -> None:
    features, codes = blobs
    svm = SVM(kernel=RBF(), search={"C": [3.0], "gamma": [0.05]}).fit(features, NAMES[codes])
    chosen = svm.best()
    assert (chosen.search, chosen.C, chosen.kernel.gamma) == (None, 3.0, 0.05)
    assert not hasattr(chosen, "layout_")


def test_scikit_learn_contract(blobs: tuple[np.ndarray, np.ndarray]) -> None:
    features, codes = blobs
    svm = SVM(kernel=RBF(gamma=0.02))
    assert clone(svm).get_params()["kernel__gamma"] == 0.02
    assert svm.set_params(kernel__gamma=0.5, C=3.0).kernel.gamma == 0.5
    grid = {"C": [1.0, 10.0], "kernel__gamma": [0.01, 0.1]}
    search = GridSearchCV(SVM(kernel=RBF()), grid, cv=3).fit(features, NAMES[codes])
    assert set(search.best_params_) == {"C", "kernel__gamma"}
    assert search.best_score_ > 0.5


@pytest.mark.parametrize("scaling", [RangeScaling(), StandardScaling(), QuantileScaling()])
def test_scaling_is_learned_in_training(blobs: tuple[np.ndarray, np.ndarray], scaling: str) -> None:
    features, codes = blobs
    svm = SVM(kernel=RBF(gamma=0.2), scaling=scaling).fit(features, NAMES[codes])
    single = svm.scores(features[:1]).values
    assert single == pytest.approx(svm.scores(features).values[:1], abs=1e-9)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"multiclass": "oa"}, "did you mean 'oa[ao]'"),
        ({"class_weight": "equal"}, "class_weight is 'balanced', null, or"),
        ({"class_weight": {"lab": -1}}, "class_weight.lab must be a number above 0"),
        ({"class_weight": {"labs": 2}}, "did you mean 'lab'"),
        ({"probability": "platt"}, "probability 'platt'.*isotonic, sigmoid, or null"),
        ({"folds": {"n_folds": 3}}, "folds must be a FoldScheme or None"),
        ({"kernel": None}, "needs a kernel"),
        ({"C": 0.0}, "C must be above 0"),
        ({"scaling": "range"}, "scaling must be a Scaling or None, got 'range'"),
        ({"search": {"c": [1]}}, "cannot vary 'c'"),
        ({"search": {"C": []}}, "list of values"),
        ({"search": {"C": 3}}, "list of values"),
        ({"search": {"C": [0]}}, "values above 0"),
        ({"search": {"gamma": [1], "kernel__gamma": [1]}}, "are the same"),
        ({"search": {"multiclass": ["oab"]}}, "unknown multiclass 'oab'"),
        (
            {"kernel": Linear(), "search": {"gamma": [1]}},
            "cannot vary 'gamma'.*search.gamma=null",
        ),
        ({"search": {"C": [1]}, "refit": False}, "hold out samples once, and these do 5 times"),
        ({"refit": False}, "give search, or refit=true"),
    ],
)
def test_wrong_parameters_are_named(
    blobs: tuple[np.ndarray, np.ndarray], parameters: dict, message: str
) -> None:
    features, codes = blobs
    with pytest.raises(UsageError, match=message):
        SVM(**{"kernel": RBF(), **parameters}).fit(features, NAMES[codes])


def test_wrong_data_are_named(blobs: tuple[np.ndarray, np.ndarray]) -> None:
    features, codes = blobs
    with pytest.raises(DataError, match=r"of one class only \('lab', 175 of them\)"):
        SVM(kernel=RBF()).fit(features, np.repeat("lab", 175))
    spoilt = features.copy()
    spoilt[7, 2] = np.nan
    with pytest.raises(DataError, match=r"1 of 175 samples hold NaN .* number 7"):
        SVM(kernel=RBF()).fit(spoilt, NAMES[codes])
