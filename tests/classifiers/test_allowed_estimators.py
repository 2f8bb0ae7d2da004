"""What a config or a model folder may make of estimators: data in, nothing run, nothing written."""

from __future__ import annotations

import inspect
import json
import os
import pickle
import sys
import types
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.cluster import FeatureAgglomeration
from sklearn.utils import all_estimators

from folders import edit
from placecue import DataError, Pipeline, UsageError, estimators
from placecue.storage.model import load_model, save_model
from placecue_classifiers.scikit_learn import ScikitLearn
from toys import Beams, Walk, registry

#: Every estimator of scikit-learn, by its class and the module that a user imports it from.
EVERY = [
    (kind, f"{module}.{name}")
    for name, kind in all_estimators()
    for module in estimators.SKLEARN
    if getattr(import_module(module), name, None) is kind
]
#: Parameters whose text is a word: compared with samples or labels, or looked up in a table.
WORDS = {"constant", "missing_values", "outlier_label", "pos_label", "scoring", "threshold"}
SAMPLES = np.random.default_rng(0).normal(size=(24, 4))
CODES = np.arange(24) % 3
AGGLOMERATION = {"estimator": "sklearn.cluster.FeatureAgglomeration"}
BAGGING = "sklearn.ensemble.BaggingClassifier"
TREE = {"estimator": "sklearn.tree.DecisionTreeClassifier"}


class Payload:
    """Makes a folder when it is unpickled."""

    def __init__(self, marker: Path) -> None:
        self.marker = str(marker)

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (self.marker,)


@pytest.fixture
def marker(tmp_path: Path) -> Path:
    return tmp_path / "marker"


@pytest.fixture
def loaded(tmp_path: Path, marker: Path) -> Path:
    """A folder that, taken for a cache, makes the marker when an agglomeration is fitted."""
    folder = tmp_path / "cache"
    FeatureAgglomeration(memory=str(folder)).fit(SAMPLES)
    results = list(folder.rglob("output.pkl"))
    assert results
    for path in results:
        path.write_bytes(pickle.dumps(Payload(marker)))
    return folder


def test_the_payload_would_run(loaded: Path, marker: Path) -> None:
    with pytest.raises(TypeError):  # what was unpickled is no tree
        FeatureAgglomeration(memory=str(loaded)).fit(SAMPLES)
    assert marker.exists()


def _fitted_with(kind: Any, name: str, folder: Path) -> list[str]:
    """Give every parameter a folder in two forms; fit what is built, name what took it."""
    took = []
    for parameter in kind._get_param_names():
        for value in (str(folder), {"location": str(folder)}):
            try:
                built = estimators.estimator(name, {parameter: value})
            except UsageError:
                continue
            took.append(parameter)
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("ignore")
                try:
                    built.fit(SAMPLES, CODES)
                except Exception:
                    continue
    return took


def test_no_estimator_takes_a_folder_for_a_parameter(loaded: Path, marker: Path) -> None:
    assert len(EVERY) > 150
    before = sorted(loaded.rglob("*"))
    took = {parameter for kind, name in EVERY for parameter in _fitted_with(kind, name, loaded)}
    assert took <= WORDS
    assert not marker.exists()
    assert sorted(loaded.rglob("*")) == before


@pytest.mark.parametrize(
    "parameter",
    ["memory", "n_jobs", "verbose", "callback", "func", "kw_args", "param_grid", "pre_dispatch"],
)
def test_no_estimator_lets_files_processes_or_functions_be_named(parameter: str) -> None:
    having = [(k, name) for k, name in EVERY if parameter in k._get_param_names()]
    assert having
    for _, name in having:
        for value in (4, "all", ["C"], {"memory": ["x"]}):
            with pytest.raises(UsageError, match=parameter):
                estimators.estimator(name, {parameter: value})


def test_every_classifier_can_be_named() -> None:
    names = [name for kind, name in EVERY if issubclass(kind, ClassifierMixin)]
    assert len(names) > 35
    for name in names:
        given: dict[str, Any] = {}
        kind = {each: kind for kind, each in EVERY}[name]
        parameters = inspect.signature(kind).parameters
        if "estimator" in parameters:
            given["estimator"] = TREE
        elif "base_estimator" in parameters:  # ClassifierChain before scikit-learn 1.7
            given["base_estimator"] = TREE
        if "estimators" in kind._get_param_names():
            given["estimators"] = [["tree", TREE]]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FutureWarning)  # some are on their way out
            assert type(estimators.classifier(name, given)) is kind


@pytest.mark.parametrize(
    ("name", "params"),
    [
        (
            "sklearn.svm.SVC",
            {"C": 3, "gamma": "scale", "class_weight": "balanced"},
        ),
        ("sklearn.neighbors.KNeighborsClassifier", {"metric": "minkowski", "p": 1.5}),
        ("sklearn.neural_network.MLPClassifier", {"hidden_layer_sizes": [8, 4], "max_iter": 9}),
        ("sklearn.ensemble.RandomForestClassifier", {"max_features": "sqrt", "max_depth": None}),
        ("sklearn.ensemble.RandomForestClassifier", {"n_jobs": None, "verbose": 0}),  # as they are
        ("sklearn.tree.DecisionTreeClassifier", {"class_weight": {"0": 1.0, "1": 2, "2": 3}}),
        ("sklearn.ensemble.HistGradientBoostingClassifier", {"max_iter": 3, "scoring": "accuracy"}),
        ("sklearn.ensemble.VotingClassifier", {"estimators": [["a", TREE], ["b", TREE]]}),
        ("sklearn.ensemble.StackingClassifier", {"estimators": [["a", TREE]], "cv": 3}),
        ("sklearn.calibration.CalibratedClassifierCV", {"estimator": TREE, "cv": 2}),
        ("sklearn.ensemble.BaggingClassifier", {"estimator": TREE, "n_estimators": 3}),
        ("sklearn.pipeline.Pipeline", {"steps": [["fewer", AGGLOMERATION], ["tree", TREE]]}),
    ],
)
def test_what_is_plain_data_is_taken_and_works(name: str, params: dict[str, Any]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fitted = estimators.classifier(name, params).fit(SAMPLES, CODES)
    assert fitted.predict(SAMPLES).shape == (24,)


@pytest.mark.parametrize(
    ("name", "params", "said"),
    [
        ("sklearn.pipeline.Pipeline", {"steps": [["a", TREE]], "memory": "x"}, "'memory' may not"),
        ("sklearn.pipeline.Pipeline", {"steps": [["a", "b"]]}, "'a' must be an estimator"),
        ("sklearn.pipeline.Pipeline", {"steps": [3]}, "stand in a list as"),
        ("sklearn.pipeline.Pipeline", {"steps": "x"}, "'steps' cannot be 'x'"),
        ("sklearn.svm.SVC", {"kernel": "os.system"}, "'kernel' cannot be 'os.system'"),
        ("sklearn.svm.SVC", {"class_weight": {"memory": 1}}, "'class_weight' cannot be"),
        ("sklearn.neighbors.KNeighborsClassifier", {"metric_params": {"n_jobs": 4}}, "cannot be"),
        ("sklearn.ensemble.BaggingClassifier", {"estimator": "os.system"}, "'estimator' cannot be"),
        ("sklearn.feature_extraction.text.CountVectorizer", {}, "no estimator that a config may"),
        ("sklearn.ensemble._forest.RandomForestClassifier", {}, "no estimator that a config may"),
        ("sklearn.tree.plot_tree", {}, "is no estimator"),
        ("sklearn.svm.SVC", [1], "must be a mapping"),
        (["sklearn.svm.SVC"], {}, "no estimator that a config may"),
    ],
)
def test_what_is_not_is_refused(name: Any, params: Any, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        estimators.estimator(name, params)


def test_estimators_do_not_stand_without_end_inside_one_another() -> None:
    nested: dict[str, Any] = TREE
    for _ in range(2000):
        nested = {"estimator": BAGGING, "params": {"estimator": nested}}
    with pytest.raises(UsageError, match="too deep"):
        estimators.estimator(nested["estimator"], nested["params"])


# ---------------------------------------------------------------------------- in a model folder


def test_a_model_folder_cannot_have_files_unpickled(
    tmp_path: Path, loaded: Path, marker: Path
) -> None:
    steps = [["fewer", AGGLOMERATION], ["tree", TREE]]
    chain = ScikitLearn("sklearn.pipeline.Pipeline", {"steps": steps})
    known = registry()
    trained = Pipeline({"beams": (Beams(), chain)}).fit(Walk(rounds=2, stay=5))
    folder = save_model(trained, tmp_path / "m", known)
    assert load_model(folder, known).believe(list(Walk(rounds=1, stay=1)))

    def agglomeration(manifest: Any) -> Any:
        params = manifest["pipeline"]["cues"]["beams"]["classifier"]["params"]
        return params["steps"][0][1].setdefault("params", {})

    def set_memory(manifest: Any) -> None:
        agglomeration(manifest)["memory"] = str(loaded)

    edit(folder, "manifest.json", set_memory)
    with pytest.raises(DataError, match="'memory' may not be set"):
        load_model(folder, known)
    assert not marker.exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda state: state.update(labels_=["a"]), "labels_|classes"),
        (lambda state: state.pop("codes_"), "codes_"),
        (lambda state: state.update(columns_=[1]), "does not fit"),
    ],
)
def test_samples_that_do_not_fit_are_refused_on_loading(
    tmp_path: Path, change: Any, said: str
) -> None:
    known = registry()
    forest = ScikitLearn(params={"n_estimators": 2})
    trained = Pipeline({"beams": (Beams(), forest)}).fit(Walk(rounds=2, stay=5))
    folder = save_model(trained, tmp_path / "m", known)
    edit(folder, "state.json", lambda state: change(state["cues"]["beams"]["classifier"]))
    with pytest.raises(DataError, match=said):
        load_model(folder, known)


def test_loading_fits_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = registry()
    forest = ScikitLearn(params={"n_estimators": 2})
    trained = Pipeline({"beams": (Beams(), forest)}).fit(Walk(rounds=2, stay=5))
    folder = save_model(trained, tmp_path / "m", known)
    fitted: list[object] = []
    monkeypatch.setattr(ScikitLearn, "_train", lambda self, _: fitted.append(self.features_))
    loaded = load_model(folder, known)
    assert fitted == []
    classifier = loaded.cues["beams"].classifier
    classifier.fitted()
    assert len(fitted) == 1
    assert fitted[0] is classifier.features_


# ---------------------------------------------------------------------------- a third party's


class Careless(ClassifierMixin, BaseEstimator):
    """Takes everything, and unpickles a file that a parameter names."""

    def __init__(
        self,
        rate: float = 0.1,
        objective: str = "plain",
        memory: str | None = None,
        table: str | None = None,
        n_jobs: int | None = None,
        inner: Any = None,
        extra: Any = None,
    ) -> None:
        self.rate, self.objective, self.memory, self.table = rate, objective, memory, table
        self.n_jobs, self.inner, self.extra = n_jobs, inner, extra

    def fit(self, samples: Any, codes: Any) -> Careless:
        for path in filter(None, (self.memory, self.table, self.objective)):
            if Path(path).is_file():
                pickle.loads(Path(path).read_bytes())
        return self


@pytest.fixture
def third(monkeypatch: pytest.MonkeyPatch) -> str:
    """The module of another distribution, allowed as its plugin would allow it."""
    module: Any = types.ModuleType("careless")
    module.Careless = Careless
    module.helper = json.loads
    monkeypatch.setitem(sys.modules, "careless", module)
    monkeypatch.setattr(Careless, "__module__", "careless")
    monkeypatch.setattr(estimators, "_allowed", dict(estimators._allowed))
    with pytest.raises(UsageError, match="no estimator that a config may name"):
        estimators.estimator("careless.Careless")
    estimators.allow_estimators("careless", texts=["objective", "memory"])
    return "careless.Careless"


def test_a_third_party_s_estimator_takes_numbers_and_what_is_vouched_for(third: str) -> None:
    built = estimators.classifier(third, {"rate": 0.5, "objective": "fast", "inner": TREE})
    assert (built.rate, built.objective, type(built.inner).__name__) == (
        0.5,
        "fast",
        "DecisionTreeClassifier",
    )


@pytest.mark.parametrize("parameter", ["memory", "table", "n_jobs", "inner", "extra", "rate"])
def test_a_third_party_s_estimator_takes_no_other_text(
    third: str, parameter: str, tmp_path: Path, marker: Path
) -> None:
    path = tmp_path / "payload"
    path.write_bytes(pickle.dumps(Payload(marker)))
    forms = [str(path), [str(path)], [[1, str(path)]], {"a": str(path)}, {"estimator": str(path)}]
    for value in forms:
        with pytest.raises(UsageError):
            estimators.estimator(third, {parameter: value}).fit(SAMPLES, CODES)
    assert not marker.exists()
    Careless(**{"table": str(path)}).fit(SAMPLES, CODES)
    assert marker.exists()  # the payload would have run


def test_a_third_party_s_module_is_allowed_and_nothing_beside_it(third: str) -> None:
    for name in ("careless.helper", "careless.json.loads", "careless.other.Careless"):
        with pytest.raises(UsageError, match="is no estimator"):
            estimators.estimator(name)
    with pytest.raises(UsageError, match="'n_jobs' may not be set"):
        estimators.estimator(third, {"n_jobs": 2})
