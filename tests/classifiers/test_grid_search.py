"""A search around any classifier; five classes throughout."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sklearn.metrics import balanced_accuracy_score
from sklearn.naive_bayes import GaussianNB

from command_line import succeeds
from placecue import Blocks, ByLog, DataError, UsageError
from placecue.evidence import OutOfFold
from placecue.learning.samples import CueSamples
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.grid_search import GridSearch
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from rooms import Rooms, write_log

Samples = tuple[np.ndarray, np.ndarray]
BLOCKS = Blocks(n_folds=3)


def test_finds_what_an_exhaustive_loop_finds(seen: Samples) -> None:
    features, labels = seen
    found = GridSearch(AdaBoost(), {"rounds": [1, 5, 20], "criterion": ["error", "gini"]}, BLOCKS)
    found.fit(features, labels)
    expected = []
    for rounds, criterion in zip(found.search_["rounds"], found.search_["criterion"], strict=True):
        predicted = np.empty_like(labels)
        for training, held_out in Blocks(n_folds=3).split(labels):
            model = AdaBoost(rounds=rounds, criterion=criterion)
            model.fit(features[training], labels[training])
            predicted[held_out] = model.predict(features[held_out])
        expected.append(balanced_accuracy_score(labels, predicted))
    assert len(expected) == 6
    assert found.search_["balanced_accuracy"] == pytest.approx(expected)
    best = int(np.argmax(expected))
    chosen = {name: found.search_[name][best] for name in ("rounds", "criterion")}
    assert found.chosen_ == chosen
    whole = AdaBoost(**chosen).fit(features, labels)
    assert np.array_equal(found.scores(features).values, whole.scores(features).values)
    assert found.layout_ == whole.layout_


def test_a_class_that_is_never_held_out_is_not_scored(seen: Samples) -> None:
    features, labels = seen
    order = np.argsort(np.random.default_rng(0).permutation(len(labels)))
    features, labels = features[order], labels[order]
    # The second log, an hour later, has four of the five classes.
    later = (np.arange(len(labels)) > 100) & (labels != "office")
    order = np.argsort(later, kind="stable")
    features, labels, later = features[order], labels[order], later[order]
    stamps = (np.arange(len(labels)) + 3600 * later) * 10**9
    folds = ByLog(only_last=True)
    points = {"C": [0.1, 100.0], "gamma": [1e-3, 0.3]}
    own = SVM(kernel=RBF(), search=points, folds=folds).fit(features, labels, stamps)
    grid = {"C": [0.1, 100.0], "kernel__gamma": [1e-3, 0.3]}
    ours = GridSearch(SVM(kernel=RBF()), grid, folds).fit(features, labels, stamps)
    assert sorted(ours.search_["balanced_accuracy"]) == pytest.approx(
        sorted(own.search_["balanced_accuracy"])
    )


def test_searches_parameters_of_scikit_learn(seen: Samples) -> None:
    features, labels = seen
    tried = (1e-9, 1e-1, 10.0)
    grid = {"params": [{"var_smoothing": value} for value in tried]}
    ours = GridSearch(ScikitLearn("sklearn.naive_bayes.GaussianNB"), grid, BLOCKS)
    ours.fit(features, labels)
    expected = []
    for value in tried:
        predicted = np.empty_like(labels)
        for training, held_out in Blocks(n_folds=3).split(labels):
            model = GaussianNB(var_smoothing=value).fit(features[training], labels[training])
            predicted[held_out] = model.predict(features[held_out])
        expected.append(balanced_accuracy_score(labels, predicted))
    assert ours.search_["balanced_accuracy"] == pytest.approx(expected)
    best = GaussianNB(var_smoothing=tried[int(np.argmax(expected))]).fit(features, labels)
    assert (ours.predict(features) == best.predict(features)).all()


def test_reaches_into_components(seen: Samples) -> None:
    features, labels = seen
    grid = {"kernel__gamma": [1e-6, 0.01], "C": [1.0, 10.0]}
    ours = GridSearch(SVM(kernel=RBF()), grid, BLOCKS).fit(features, labels)
    own = SVM(kernel=RBF(), search={"gamma": [1e-6, 0.01], "C": [1.0, 10.0]}, folds=BLOCKS)
    own.fit(features, labels)

    def points(search: dict[str, list[Any]], gamma: str) -> dict[tuple[float, float], float]:
        pairs = zip(search[gamma], search["C"], strict=True)
        return dict(zip(pairs, search["balanced_accuracy"], strict=True))

    assert points(ours.search_, "kernel__gamma") == pytest.approx(points(own.search_, "gamma"))
    assert ours.chosen_ == {"kernel__gamma": own.chosen_["gamma"], "C": own.chosen_["C"]}


def test_out_of_fold_scores_search_no_more(seen: Samples) -> None:
    features, labels = seen
    found = GridSearch(AdaBoost(), {"rounds": [1, 20]}, BLOCKS).fit(features, labels)
    plain = AdaBoost(rounds=found.chosen_["rounds"]).fit(features, labels)
    assert found.chosen().get_params() == plain.get_params()
    ours, theirs = (
        OutOfFold(Blocks(n_folds=4)).scores(each, CueSamples(features), labels).values
        for each in (found, plain)
    )
    assert np.array_equal(ours, theirs)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"classifier": None}, "needs a classifier and what to search"),
        ({"search": None}, "needs a classifier and what to search"),
        ({"search": {"round": [1]}}, "search cannot vary 'round'; did you mean 'rounds'?"),
        ({"search": {"rounds": 5}}, "search.rounds must be a list of values to try, got 5"),
        ({"search": {"rounds": []}}, "search.rounds must be a list of values to try"),
        ({"search": {"criterion": "gini"}}, "must be a list of values to try, got 'gini'"),
        ({"folds": Blocks(n_folds=1)}, "folds.n_folds must be 2 or more, got 1"),
    ],
)
def test_wrong_parameters_are_named(seen: Samples, parameters: dict[str, Any], said: str) -> None:
    usual: dict[str, Any] = {"classifier": AdaBoost(), "search": {"rounds": [1]}}
    with pytest.raises(UsageError) as caught:
        GridSearch(**(usual | parameters)).fit(*seen)
    assert said in str(caught.value)


def test_bad_samples_are_named(seen: Samples) -> None:
    search = GridSearch(AdaBoost(), {"rounds": [1]})
    features, labels = seen
    with pytest.raises(DataError, match="one class only"):
        search.fit(features, np.full(len(labels), "office"))
    with pytest.raises(DataError, match="NaN"):
        search.fit(np.where(features > 0, features, np.nan), labels)


def test_from_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    log = write_log(tmp_path / "a.mcap", Rooms(seed=0))
    option = "classifier@cues.laser.classifier=grid_search"
    words = ["cue=laser", "integrator=none", option, f"log={log}", "out=model"]
    told = succeeds("train", *words, "cues.laser.classifier.search.rounds=[2,10]")
    assert "rounds" in told.out
    table = (tmp_path / "model" / "search" / "laser.md").read_text()
    assert table.startswith("| rounds | balanced accuracy (%) |")
    assert (tmp_path / "model" / "search" / "laser.png").stat().st_size > 5000
    log = write_log(tmp_path / "b.mcap", Rooms(seed=1))
    succeeds("classify", "model=model", f"log={log}", "out=classified")
    metrics = json.loads((tmp_path / "classified" / "metrics.json").read_text())
    assert metrics["methods"]["integrated"]["balanced_accuracy"] > 0.7
