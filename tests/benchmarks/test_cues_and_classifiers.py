"""What the page of every cue with every classifier rests on: resuming, scoring, shared kernels."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse

from placecue import Blocks
from placecue.training_set import TrainingSet
from placecue_classifiers.svm import SVM
from placecue_kernels.chi2 import Chi2

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def results(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("cues_and_classifiers_results")


@pytest.fixture
def page(results):
    return import_module("cues_and_classifiers_page")


@pytest.fixture
def folds(results):
    return import_module("cues_and_classifiers_fold")


def test_a_finished_fold_is_known_and_another_is_not(results, tmp_path):
    kept, cell = results.Results(tmp_path), results.Cell("maps", "laser, full", "three", "oaa")
    kept.keep(cell, 0, ["a=1"], {"truth": ["x"], "predicted": ["x"]})
    assert kept.known(cell, 0, ["a=1"])
    assert not kept.known(cell, 1, ["a=1"])
    assert not kept.known(cell, 0, ["a=2"])
    assert not kept.known(cell._replace(column="oao"), 0, ["a=1"])


def test_a_cell_has_no_result_until_all_folds_are_there(results, tmp_path):
    kept, cell = results.Results(tmp_path), results.Cell("maps", "laser, full", "three", "oaa")
    kept.keep(cell, 0, [], {"seconds": 1})
    assert kept.folds(cell, 2) is None
    kept.keep(cell, 1, [], {"seconds": 2})
    assert [fold["seconds"] for fold in kept.folds(cell, 2)] == [1, 2]


def test_a_fold_cut_short_while_it_was_written_is_run_again(results, tmp_path, monkeypatch):
    kept, cell = results.Results(tmp_path), results.Cell("maps", "laser, full", "three", "oaa")

    def killed(path, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        kept.keep(cell, 0, [], {})
    assert not kept.known(cell, 0, [])


def test_scores_pool_the_folds(results):
    # a: 1 of 2 right over both folds, b: 1 of 1, c: 0 of 1, d: 1 of 2; their mean is 1/2.
    folds = [
        {"truth": ["a", "b", "d"], "predicted": ["a", "b", "d"], "inner": 0.3},
        {"truth": ["a", "c", "d"], "predicted": ["b", "a", "a"], "inner": 0.4},
    ]
    assert results.balanced_accuracy(folds) == pytest.approx(50)
    # Variances of the recalls: 1/4 / 2, 0, 0, 1/4 / 2.
    assert results.standard_error(folds) == pytest.approx(100 * 0.25**0.5 / 4)


def test_errors_are_over_scenes_where_these_are_known(results):
    # Ten frames each of two scenes, one right and one wrong: a recall of 0, 1/2 or 1, so that its
    # standard deviation is 35 points, where single frames would have 11.
    fold = {"truth": ["a"] * 20, "predicted": ["a"] * 10 + ["b"] * 10}
    error = results.standard_error([{**fold, "scenes": ["1"] * 10 + ["2"] * 10}])
    assert error == pytest.approx(100 / 8**0.5, abs=2)
    assert results.standard_error([fold]) == pytest.approx(100 / 80**0.5)


def test_only_the_tables_of_the_given_parts_are_made(page, results, tmp_path, monkeypatch):
    monkeypatch.setattr(page, "TABLES", {"four": lambda _: "frames", "two": lambda _: "plans"})
    path = tmp_path / "page.md"
    text = "<!-- table four -->\nold\n<!-- end -->\n<!-- table two -->\nold\n<!-- end -->\n"
    path.write_text(text)
    page.write(path, results.Results(tmp_path), ["nyuv2"])
    assert path.read_text() == text.replace("old", "frames", 1)


def test_the_variant_that_does_best_inside_is_taken_fold_by_fold(results):
    one = [{"inner": 0.5, "name": "one"}, {"inner": 0.2, "name": "one"}]
    two = [{"inner": 0.4, "name": "two"}, {"inner": 0.3, "name": "two"}]
    assert [fold["name"] for fold in results.chosen_inside([one, two])] == ["one", "two"]


def test_only_what_stands_between_a_tables_markers_is_replaced(page):
    text = "a\n<!-- table x -->\nold\n<!-- end -->\nb\n<!-- table y -->\nold\n<!-- end -->\n"
    expected = text.replace("old", "| 1 \\g<0> |", 1)
    assert page.filled(text, "x", "| 1 \\g<0> |") == expected
    with pytest.raises(ValueError, match="no place for the table z"):
        page.filled(text, "z", "")


def test_looked_up_kernels_and_one_search_for_all_extensions_change_no_result(folds):
    generator = np.random.default_rng(0)
    codes = np.arange(80) % 4
    counts = generator.poisson(1 + 4 * (np.arange(12) % 4 == codes[:, None]))
    features = sparse.csr_array(counts / counts.sum(axis=1, keepdims=True))
    labels, stamps = np.array(list("abcd"))[codes], np.arange(80) * 10**9
    training, held_out = np.arange(60), np.arange(60, 80)
    fold = folds.Fold(TrainingSet(features, labels, stamps), training, held_out, {})
    search = {"C": [1, 10], "gamma": [0.3, 1.0, 3.0]}
    for extension in ("oaa", "modified_oaa", "oao"):
        blocks = Blocks(n_folds=3)
        svm = SVM(kernel=Chi2(), multiclass=extension, search=search, folds=blocks)
        told = fold.outcome(svm, extension)
        svm.fit(features[training], labels[training], stamps[training])
        assert told["predicted"] == svm.predict(features[held_out]).tolist()
        assert {name: told["chosen"][name] for name in search} == svm.chosen_
