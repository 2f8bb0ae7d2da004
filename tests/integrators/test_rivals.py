"""What all rivals of G-DAS and SVM-DAS answer to bad input, and that they are kept and composed."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from hydra import compose, initialize_config_module
from omegaconf import OmegaConf

from command_line import placecue
from placecue import (
    DataError,
    Integrator,
    Layout,
    OneAgainstAll,
    Pipeline,
    Probabilities,
    Scores,
    StoredEvidence,
    UsageError,
    clone,
)
from placecue.components.build import build, describe, plain
from placecue.components.options import register_with_hydra
from placecue.components.pipelines import build_pipeline
from placecue.storage.model import load_model, save_model
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_integrators.dynamic import Dynamic
from placecue_integrators.probability_rules import (
    MaxProbability,
    MeanProbability,
    ProductProbability,
)
from placecue_integrators.stacking import Stacking
from placecue_integrators.svm_das import SVMDAS
from placecue_integrators.vote import Vote
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness, Walk, registry

CLASSES = ("corridor", "kitchen", "lab", "office")
REGRESSION = {"plugin": "sklearn", "estimator": "sklearn.linear_model.LogisticRegression"}
#: As a config has them.
RIVALS: dict[str, dict[str, Any]] = {
    "vote": {"weights": {"beams": 0.5}},
    "mean_probability": {"calibrate": False, "penalty": 0.5},
    "product_probability": {"priors": "training", "calibrate": True, "penalty": 1.0},
    "max_probability": {"calibrate": True, "penalty": 1.0},
    "stacking": {"classifier": REGRESSION},
    "dynamic": {"penalty": 0.5, "per_sample": True},
}
FIXED = (Vote, MeanProbability, ProductProbability, MaxProbability)
BY_CLASS = (*FIXED, Dynamic)


def probabilities(n: int = 12, classes: tuple[str, ...] = CLASSES, seed: int = 0) -> Scores:
    generator = np.random.default_rng(seed)
    values = generator.dirichlet(np.ones(len(classes)), size=n)
    return Scores(values, Probabilities(classes))


def labels(n: int = 12) -> np.ndarray:
    return np.resize(CLASSES, n)


def regression() -> Stacking:
    return Stacking(ScikitLearn("sklearn.linear_model.LogisticRegression"))


@pytest.mark.parametrize("kind", BY_CLASS)
def test_a_class_that_a_cue_never_saw_is_named(kind: type[Integrator]) -> None:
    fewer = ("corridor", "kitchen", "office")
    for names in (("crfh", "laser"), ("laser", "crfh")):
        scores = {"crfh": probabilities(), "laser": probabilities(classes=fewer)}
        evidence = StoredEvidence({name: scores[name] for name in names})
        said = r"^cue 'laser' was trained without 'lab', which cue 'crfh' tells apart: train all "
        with pytest.raises(DataError, match=said):
            kind().fit(evidence, labels())


@pytest.mark.parametrize("kind", BY_CLASS)
def test_samples_of_a_class_that_no_cue_knows_are_named(kind: type[Integrator]) -> None:
    evidence = StoredEvidence({"crfh": probabilities(), "laser": probabilities(seed=1)})
    others = np.where(labels() == "lab", "labs", labels())
    with pytest.raises(DataError, match=r"samples of 'labs', which no cue .* did you mean 'lab'"):
        kind().fit(evidence, others)


@pytest.mark.parametrize("make", [*BY_CLASS, regression, lambda: SVMDAS(SVM(kernel=RBF()))])
def test_one_label_a_sample(make: Callable[[], Integrator]) -> None:
    evidence = StoredEvidence({"crfh": probabilities(), "laser": probabilities(seed=1)})
    with pytest.raises(
        DataError, match=r"^11 labels for the evidence of 12 samples: give one a sa"
    ):
        make().fit(evidence, labels(11))


@pytest.mark.parametrize("make", [Dynamic, regression])
def test_a_cue_that_is_no_longer_there_is_named(make: Callable[[], Integrator]) -> None:
    evidence = StoredEvidence({"crfh": probabilities(), "laser": probabilities(seed=1)})
    fitted = make().fit(evidence, labels())
    with pytest.raises(UsageError, match=r"no evidence of cue 'laser'; available: crfh$"):
        fitted.integrate(StoredEvidence({"crfh": probabilities()}))


@pytest.mark.parametrize("kind", FIXED)
def test_rules_take_evidence_of_some_of_the_cues_as_if_the_others_were_missing(
    kind: type[Integrator],
) -> None:
    both = {"crfh": probabilities(), "laser": probabilities(seed=1)}
    fitted = kind().fit(StoredEvidence(both), labels())
    gone = Scores(np.full((12, 4), np.nan), Probabilities(CLASSES))
    expected = fitted.integrate(StoredEvidence({"crfh": both["crfh"], "laser": gone}))
    found = fitted.integrate(StoredEvidence({"crfh": both["crfh"]}))
    assert found.layout == expected.layout
    assert np.array_equal(found.values, expected.values)
    said = r"^there is evidence of cue 'sonar', and the integrator was fitted on crfh, laser: give"
    with pytest.raises(UsageError, match=said):
        fitted.integrate(StoredEvidence({"sonar": both["crfh"]}))


@pytest.mark.parametrize("kind", [Vote, Dynamic])
def test_other_layouts_than_those_fitted_on_are_refused(kind: type[Integrator]) -> None:
    both = {"crfh": probabilities(), "laser": probabilities()}
    fitted = kind().fit(StoredEvidence(both), labels())
    other = Scores(probabilities().values, OneAgainstAll(CLASSES))
    with pytest.raises(UsageError, match=r"scores of cue 'laser' are OneAgainstAll.*fitted on"):
        fitted.integrate(StoredEvidence({**both, "laser": other}))


def test_votes_that_count_nothing_tell_nothing_alone() -> None:
    both = {"crfh": probabilities(), "laser": probabilities(seed=1)}
    fitted = Vote(weights={"laser": 0}).fit(StoredEvidence(both), labels())
    assert not fitted.integrate(StoredEvidence({"laser": both["laser"]})).available().any()


@pytest.mark.parametrize("make", [*BY_CLASS, regression])
def test_where_all_cues_are_missing_in_every_row_nothing_is_told(
    make: Callable[[], Integrator],
) -> None:
    evidence = StoredEvidence({"crfh": probabilities(), "laser": probabilities(seed=1)})
    gone = Scores(np.full((3, 4), np.nan), Probabilities(CLASSES))
    found = make().fit(evidence, labels()).integrate(StoredEvidence({"crfh": gone, "laser": gone}))
    assert not found.available().any()
    assert len(found) == 3


@pytest.mark.parametrize("kind", FIXED)
def test_rules_that_learn_nothing_take_a_single_sample(kind: type[Integrator]) -> None:
    one = StoredEvidence({"crfh": probabilities(1), "laser": probabilities(1, seed=1)})
    assert kind().fit(one, ["lab"]).integrate(one).available().all()
    assert kind.gaps  # type: ignore[attr-defined]


def test_cues_that_stacking_joins_may_know_other_classes() -> None:
    fewer = Scores(np.random.default_rng(2).normal(size=(12, 2)), OneAgainstAll(("lab", "office")))
    evidence = StoredEvidence({"crfh": probabilities(), "laser": fewer})
    found = regression().fit(evidence, labels()).integrate(evidence)
    assert found.layout == Probabilities(CLASSES)


@dataclass(frozen=True)
class Unlikeness(Layout):
    """Of a plugin: how unlike each class a sample is; the smallest wins."""

    name: ClassVar[str] = "unlikeness"

    @property
    def columns(self) -> tuple[str, ...]:
        return self.classes

    def preference(self, values: np.ndarray) -> np.ndarray:
        return -values


def test_a_plugin_s_layout_votes_and_is_calibrated_by_its_own_rule() -> None:
    generator = np.random.default_rng(4)
    codes = generator.integers(0, 4, 300)
    values = generator.normal(size=(300, 4)) - 3 * np.eye(4)[codes]
    evidence = StoredEvidence({"laser": Scores(values, Unlikeness(CLASSES))})
    truth = np.array(CLASSES)[codes]
    for integrator in (Vote(), Dynamic()):
        found = integrator.fit(evidence, truth).integrate(evidence).decide().labels
        smallest = np.array(CLASSES)[values.argmin(axis=1)]
        # Calibration moves what is nearly level by the biases of the classes.
        assert np.mean(found == smallest) > (0.97 if isinstance(integrator, Dynamic) else 0.9999)


# ---------------------------------------------------------------------- kept, built, composed


def pipeline(name: str) -> Pipeline:
    """Two cues of a plugin, one of which learns, that give probabilities."""
    cues = {
        "beams": (Beams(), SVM(kernel=RBF(gamma=0.1), multiclass="oao", probability="sigmoid")),
        "brightness": (Brightness(), SVM(kernel=RBF(gamma=1e-3), probability="sigmoid")),
    }
    spec = {"plugin": name, **RIVALS[name]}
    return Pipeline(cues, build(spec, "integrator", registry()))


@pytest.fixture(scope="module")
def trained() -> Pipeline:
    """Cues that the pipelines of all rivals share."""
    first = pipeline("vote")
    return first.fit(Walk(rounds=3, stay=10, noise=0.8))


@pytest.mark.parametrize("name", RIVALS)
def test_a_pipeline_is_kept_to_the_last_bit(name: str, trained: Pipeline, tmp_path: Path) -> None:
    again = Pipeline(trained.cues, pipeline(name).integrator)
    assert trained.held_out_ is not None
    again.fit_integrator(trained.held_out_)
    known = registry()
    loaded = load_model(save_model(again, tmp_path / "model", known), known)
    assert describe(loaded.integrator, known) == describe(again.integrator, known)
    walk = list(Walk(rounds=1, stay=10, seed=1, noise=0.8))
    beliefs = [list(each.beliefs(walk)) for each in (again, loaded)]
    for before, after in zip(*beliefs, strict=True):
        assert before.scores.values.tobytes() == after.scores.values.tobytes()
        assert (before.label, before.confidence) == (after.label, after.confidence)
    right = [belief.label == seen.label for belief, seen in zip(beliefs[0], walk, strict=True)]
    assert np.mean(right) > 0.8


@pytest.mark.parametrize("name", RIVALS)
def test_parameters_are_kept_by_a_clone(name: str) -> None:
    integrator = build({"plugin": name, **RIVALS[name]}, "integrator", registry())
    assert describe(clone(integrator), registry()) == describe(integrator, registry())


def built(*words: str) -> Pipeline:
    """Return the pipeline that ``placecue train`` would train."""
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose("train", [*words, "log=x"])
    return build_pipeline(plain(config), registry())


@pytest.mark.parametrize("name", RIVALS)
def test_the_command_line_shows_each(name: str) -> None:
    shown = placecue("train", "cue=[crfh,laser]", f"integrator={name}", "log=x", "--cfg", "job")
    assert shown.status == 0
    integrator = OmegaConf.create(shown.out).integrator
    assert integrator.plugin == name
    assert build(plain(integrator), "integrator", registry()).get_params(deep=False).keys() == {
        *RIVALS[name]
    }


def test_the_words_that_make_cues_give_probabilities() -> None:
    cues = built(
        "cue=[crfh,laser]",
        "integrator=product_probability",
        "integrator.priors=training",
        "cues.crfh.classifier.probability=sigmoid",
        "classifier@cues.laser.classifier=adaboost",
        "cues.laser.classifier.output=probability",
    ).cues
    assert cues["crfh"].classifier.get_params()["probability"] == "sigmoid"
    assert cues["laser"].classifier.get_params()["output"] == "probability"


def test_the_words_of_votes_and_stacking() -> None:
    vote = built("cue=[crfh,laser]", "integrator=vote", "integrator.weights={laser:2}")
    assert vote.integrator.get_params()["weights"] == {"laser": 2}
    stacking = built("cue=[crfh,laser]", "integrator=stacking").integrator
    inside = stacking.get_params(deep=True)
    assert inside["classifier__estimator"] == "sklearn.linear_model.LogisticRegression"
    forest = "sklearn.ensemble.RandomForestClassifier"
    words = [f"integrator.classifier.estimator={forest}", "integrator.classifier.random_state=3"]
    inside = built("cue=[crfh,laser]", "integrator=stacking", *words).integrator.get_params()
    assert inside["classifier__estimator"] == forest
    other = "classifier@integrator.classifier=svm"
    assert isinstance(
        built("cue=[crfh,laser]", "integrator=stacking", other).integrator.classifier,  # type: ignore[attr-defined]
        SVM,
    )
