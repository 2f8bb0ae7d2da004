"""Any classifier of scikit-learn by its dotted name, kept without pickle."""

import subprocess
import sys

import numpy as np
import pytest
from scipy import sparse
from sklearn.ensemble import BaggingClassifier, RandomForestClassifier
from sklearn.linear_model import RidgeClassifier
from sklearn.tree import DecisionTreeClassifier

from placecue import (
    Blocks,
    DataError,
    DescriptorSets,
    OneAgainstAll,
    Pipeline,
    Probabilities,
    RangeScaling,
    StandardScaling,
    UsageError,
)
from placecue import estimators as allowed
from placecue.storage.model import load_model, save_model
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import Beams, Walk, registry

Blobs = tuple[np.ndarray, np.ndarray]


def test_probabilities_are_the_estimator_s(seen: Blobs, unseen: Blobs) -> None:
    mine = ScikitLearn(params={"n_estimators": 20}).fit(*seen)
    peer = RandomForestClassifier(n_estimators=20, random_state=0).fit(*seen)
    assert (mine.scores(unseen[0]).values == peer.predict_proba(unseen[0])).all()
    assert (mine.predict(unseen[0]) == peer.predict(unseen[0])).all()
    assert isinstance(mine.layout_, Probabilities)


def test_decision_functions_are_the_estimator_s(seen: Blobs, unseen: Blobs) -> None:
    mine = ScikitLearn("sklearn.linear_model.RidgeClassifier", {"alpha": 2.0}).fit(*seen)
    peer = RidgeClassifier(alpha=2.0).fit(*seen)
    assert mine.scores(unseen[0]).values == pytest.approx(peer.decision_function(unseen[0]))
    assert isinstance(mine.layout_, OneAgainstAll)
    two = np.where(seen[1] == "lab", "lab", "other")
    peer.fit(seen[0], two)
    both = ScikitLearn("sklearn.linear_model.RidgeClassifier", {"alpha": 2.0}).fit(seen[0], two)
    assert (both.predict(unseen[0]) == peer.predict(unseen[0])).all()
    assert both.scores(unseen[0]).values.shape == (len(unseen[0]), 2)


def test_estimators_nest(seen: Blobs, unseen: Blobs) -> None:
    inner = {"estimator": "sklearn.tree.DecisionTreeClassifier", "params": {"max_depth": 3}}
    mine = ScikitLearn("sklearn.ensemble.BaggingClassifier", {"estimator": inner}).fit(*seen)
    tree = DecisionTreeClassifier(max_depth=3, random_state=0)
    peer = BaggingClassifier(tree, random_state=0).fit(*seen)
    assert (mine.scores(unseen[0]).values == peer.predict_proba(unseen[0])).all()


def test_sparse_histograms_lose_their_empty_columns(seen: Blobs) -> None:
    dense, labels = np.abs(seen[0]), seen[1]
    wide = 28**6
    rows, columns = np.nonzero(dense)
    places = columns * 80_000_000 + 5
    histograms = sparse.csr_array((dense[rows, columns], (rows, places)), shape=(len(dense), wide))
    name = "sklearn.naive_bayes.MultinomialNB"
    narrow = ScikitLearn(name).fit(dense, labels)
    mine = ScikitLearn(name).fit(histograms, labels)
    assert mine.features_.shape == dense.shape
    assert mine.scores(histograms).values == pytest.approx(narrow.scores(dense).values)
    elsewhere = sparse.csr_array(([1.0], ([0], [7])), shape=(1, wide))  # a column not met before
    assert mine.scores(elsewhere).values.shape == (1, 5)


@pytest.mark.parametrize(
    "classifier",
    [
        ScikitLearn(params={"n_estimators": 10}),
        ScikitLearn(
            "sklearn.neural_network.MLPClassifier", {"max_iter": 300}, scaling=StandardScaling()
        ),
        AdaBoost(rounds=10),
        AdaBoost(rounds=10, output="probability"),
        SVM(kernel=RBF(0.1), probability="sigmoid", multiclass="oao"),
        SVM(kernel=RBF(0.1), probability="isotonic", multiclass="modified_oaa"),
        SVM(RBF(), search={"C": [1.0], "scaling": [RangeScaling(), None]}, folds=Blocks()),
    ],
    ids=lambda each: type(each).__name__,
)
def test_a_model_folder_gives_the_same_to_the_last_bit(classifier, tmp_path) -> None:  # type: ignore[no-untyped-def]
    known = registry()
    fitted = Pipeline({"beams": (Beams(), classifier)}).fit(Walk())
    folder = save_model(fitted, tmp_path / "model", known, trained_on=[Walk()])
    loaded = load_model(folder, known)
    walk = list(Walk(rounds=1, seed=1))
    for before, after in zip(fitted.beliefs(walk), loaded.beliefs(walk), strict=True):
        assert before.scores.values.tobytes() == after.scores.values.tobytes()
        assert before.scores.layout == after.scores.layout
        assert before.label == after.label


@pytest.mark.parametrize(
    ("name", "params", "message"),
    [
        ("os.system", {}, "no estimator that a config may name"),
        ("RandomForestClassifier", {}, "no estimator that a config may name"),
        ("sklearn.ensemble.RandomForrestClassifier", {}, "did you mean 'sklearn.ensemble.Random"),
        ("sklearn.nowhere.Thing", {}, "no estimator that a config may name"),
        ("sklearn.base.clone", {}, "no estimator that a config may name"),
        ("sklearn.svm.l1_min_c", {}, "is no estimator"),
        ("sklearn.ensemble.RandomForestRegressor", {}, "is no classifier"),
        ("sklearn.svm.LinearSVC", {"c": 1}, "no parameter 'c'; available: C,"),
        ("sklearn.svm.SVC", {"decision_function_shape": "ovo"}, "pairs of classes"),
        ("sklearn.semi_supervised.LabelPropagation", {"kernel": 3}, "'kernel' cannot be 3"),
    ],
)
def test_what_cannot_be_is_named(seen: Blobs, name: str, params: dict, message: str) -> None:
    with pytest.raises((UsageError, DataError), match=message):
        ScikitLearn(name, params).fit(*seen)


def test_a_plugin_allows_another_package(seen: Blobs, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(allowed, "_allowed", dict(allowed._allowed))
    with pytest.raises(UsageError, match="may name"):
        ScikitLearn("placecue_classifiers.adaboost.AdaBoost").fit(*seen)
    allowed.allow_estimators("placecue_classifiers.adaboost")
    assert allowed.classifier("placecue_classifiers.adaboost.AdaBoost", {"rounds": 3}).rounds == 3


def test_descriptor_sets_are_refused(seen: Blobs) -> None:
    sets = DescriptorSets(np.ones((175, 2)), np.arange(176))
    with pytest.raises(UsageError, match="takes dense vectors or sparse histograms, got set"):
        ScikitLearn().fit(sets, seen[1])


def test_listing_components_imports_no_estimator() -> None:
    code = "import sys, placecue_classifiers; sys.exit('sklearn' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
