"""What stands inside a component is chosen by the same words everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from hydra import compose, initialize_config_module

from command_line import placecue
from placecue import Pipeline, UsageError
from placecue.components.build import plain
from placecue.components.manager import load_plugins
from placecue.components.options import register_with_hydra
from placecue.components.pipelines import build_pipeline, describe_pipeline
from placecue.components.searches import check_opened, opened

REGISTRY = load_plugins(built_ins_only=True).registry
LASER = "cues.laser.classifier"
ONE = ["cue=laser", "integrator=none"]


def built(*words: str) -> Pipeline:
    """Return the pipeline that ``placecue train`` would train."""
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose("train", [*opened(words), "log=x"])
    check_opened(config, opened(words))
    return build_pipeline(plain(config), REGISTRY)


def described(*words: str) -> dict[str, Any]:
    """Return its description, which is what a model folder keeps."""
    return describe_pipeline(built(*words), REGISTRY)


def test_one_folds_setting_serves_where_no_other_is_given() -> None:
    pipeline = described("cue=[crfh,laser]", "folds=by_log", "folds.gap=7")
    by_log = {"plugin": "by_log", "n_folds": 5, "gap": 7, "only_last": False}
    assert pipeline["folds"] == by_log
    assert pipeline["cues"]["crfh"]["classifier"]["folds"] is None
    assert pipeline["cues"]["laser"]["classifier"]["folds"] is None
    assert pipeline["integrator"]["classifier"]["folds"] is None


@pytest.mark.parametrize(
    "word",
    [
        f"{LASER}.folds=blocks",
        f"{LASER}.folds={{plugin:blocks}}",
        f"folds@{LASER}.folds=blocks",
    ],
)
def test_a_classifier_may_have_folds_of_its_own(word: str) -> None:
    pipeline = described(*ONE, word)
    assert pipeline["folds"]["plugin"] == "interleaved"
    blocks = {"plugin": "blocks", "n_folds": 5}
    assert pipeline["cues"]["laser"]["classifier"]["folds"] == blocks


def families(**inner: object) -> dict[str, object]:
    """What the laser's SVM scales by: families of features, on top of another scaling."""
    return {"plugin": "families", "scaling": inner, "weights": None}


@pytest.mark.parametrize(
    ("words", "scaling"),
    [
        ([], families(plugin="quantiles", n_quantiles=100)),
        (
            [f"{LASER}.scaling.scaling.n_quantiles=9"],
            families(plugin="quantiles", n_quantiles=9),
        ),
        ([f"scaling@{LASER}.scaling.scaling=standard"], families(plugin="standard")),
        (
            [f"{LASER}.scaling.weights={{fourier: 0.5}}"],
            {**families(plugin="quantiles", n_quantiles=100), "weights": {"fourier": 0.5}},
        ),
        (
            [f"scaling@{LASER}.scaling=quantiles"],
            {"plugin": "quantiles", "n_quantiles": 100},
        ),
        ([f"{LASER}.scaling=range"], {"plugin": "range"}),
        ([f"scaling@{LASER}.scaling=range"], {"plugin": "range"}),
        ([f"{LASER}.scaling=null"], None),
        ([f"classifier@{LASER}=svm"], None),
    ],
)
def test_a_scaling_is_chosen_as_a_kernel_is(words: Sequence[str], scaling: object) -> None:
    assert described(*ONE, *words)["cues"]["laser"]["classifier"]["scaling"] == scaling


@pytest.mark.parametrize("name", ["adaboost", "sklearn", "svm", "svm_svm_das", "adaboost_searched"])
def test_every_classifier_may_stand_in_an_integrator(name: str) -> None:
    pipeline = built("cue=[crfh,laser]", f"classifier@integrator.classifier={name}")
    kinds = {"adaboost": "AdaBoost", "sklearn": "ScikitLearn", "adaboost_searched": "GridSearch"}
    classifier = pipeline.integrator.classifier  # type: ignore[attr-defined]
    assert type(classifier).__name__ == kinds.get(name, "SVM")


def test_the_integrator_s_own_classifier_is_as_before() -> None:
    classifier = described("cue=[crfh,laser]")["integrator"]["classifier"]
    assert classifier["multiclass"] == "oao"
    assert classifier["kernel"]["plugin"] == "rbf"
    assert classifier["search"] == {"C": [1, 10, 100], "gamma": [0.01, 0.03, 0.1, 0.3, 1]}


def test_any_classifier_may_stand_in_a_grid_search() -> None:
    grid = [f"classifier@{LASER}=grid_search", f"classifier@{LASER}.classifier=svm"]
    words = [*grid, f"{LASER}.search.C=[1,2]", f"{LASER}.search.scaling=[range,null]"]
    classifier = described(*ONE, *words)["cues"]["laser"]["classifier"]
    assert classifier["search"] == {"C": [1, 2], "scaling": [{"plugin": "range"}, None]}


def test_a_search_takes_other_keys_and_gives_up_its_own() -> None:
    words = [f"{LASER}.search.multiclass=[oao,oaa]", f"{LASER}.search.gamma=null"]
    search = described(*ONE, *words)["cues"]["laser"]["classifier"]["search"]
    assert search == {"C": [1, 10, 100], "multiclass": ["oao", "oaa"]}
    # Where there was none, there is one.
    words = [f"classifier@{LASER}=svm", f"{LASER}.search.C=[1,2]"]
    assert described(*ONE, *words)["cues"]["laser"]["classifier"]["search"] == {"C": [1, 2]}


def test_the_parameters_of_an_estimator_are_named_likewise() -> None:
    words = [f"classifier@{LASER}=sklearn", f"{LASER}.params.n_estimators=7"]
    assert described(*ONE, *words)["cues"]["laser"]["classifier"]["params"] == {"n_estimators": 7}


@pytest.mark.parametrize("place", ["cues.lasr.classifier", "clasifier", "integrator.clasifier"])
def test_a_search_of_nothing_is_refused(place: str) -> None:
    with pytest.raises(UsageError, match=f"search.C=.1.: there is no component {place}; "):
        built("cue=[crfh,laser]", f"{place}.search.C=[1]")


def test_the_command_line_opens_searches() -> None:
    words = [*ONE, "log=x", f"{LASER}.search.multiclass=[oao,oaa]", f"{LASER}.search.gamma=null"]
    shown = placecue("train", *words, "--cfg", "job")
    assert shown.status == 0
    assert "        gamma: null\n        multiclass:\n        - oao\n        - oaa\n" in shown.out
