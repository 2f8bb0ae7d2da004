"""The options of ``integrator=``: they compose, and survive saving."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hydra import compose, initialize_config_module

from command_line import placecue
from placecue import Integrator, Pipeline
from placecue.components.build import build, plain
from placecue.components.manager import load_plugins
from placecue.components.options import register_with_hydra
from placecue.storage.model import load_model, save_model
from placecue_classifiers.svm import SVM
from placecue_integrators.gdas import GDAS
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness, Walk, registry

REGISTRY = load_plugins(built_ins_only=True).registry
SVM_DAS = {"svm_das": "rbf", "svm_das_linear": "linear", "svm_das_hi": "hi"}


def integrator(*words: str) -> Integrator:
    """Return the integrator that ``placecue train`` would use."""
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose("train", ["log=x", "cue=[crfh,laser]", *words])
    made: Integrator = build(plain(config)["integrator"], "integrator", REGISTRY)
    return made


@pytest.mark.parametrize(("option", "kernel"), SVM_DAS.items())
@pytest.mark.parametrize("multiclass", ["oao", "oaa", "modified_oaa"])
def test_svm_das_has_a_kernel_and_a_multi_class_extension(
    option: str, kernel: str, multiclass: str
) -> None:
    words = [] if multiclass == "oao" else [f"integrator.classifier.multiclass={multiclass}"]
    classifier = integrator(f"integrator={option}", *words).get_params()["classifier"]
    assert classifier.multiclass == multiclass
    found = REGISTRY.find(classifier.kernel)
    assert found is not None
    assert found.component.name == kernel
    assert set(classifier.search) == ({"C", "gamma"} if kernel == "rbf" else {"C"})


def test_weights_by_name_stand_on_the_command_line() -> None:
    gdas = integrator("integrator=gdas", "integrator.weights={crfh: 2, laser: 1}")
    assert gdas.get_params() == {
        "weights": {"crfh": 2, "laser": 1},
        "step": 0.05,
        "modified_oaa": "sum_of_distances",
    }
    assert integrator("integrator=gdas").get_params() == GDAS().get_params()


@pytest.mark.parametrize("option", ["gdas", *SVM_DAS])
def test_the_config_of_a_job_is_shown(option: str) -> None:
    shown = placecue("train", "log=x", "cue=[crfh,laser]", f"integrator={option}", "--cfg", "job")
    assert shown.status == 0
    assert f"  plugin: {'gdas' if option == 'gdas' else 'svm_das'}\n" in shown.out


@pytest.mark.parametrize("option", ["gdas", *SVM_DAS])
@pytest.mark.parametrize("multiclass", ["oao", "modified_oaa"])
def test_a_saved_model_says_the_same_to_the_last_bit(
    option: str, multiclass: str, tmp_path: Path
) -> None:
    cues = {
        "beams": (Beams(), SVM(kernel=RBF(gamma=0.1), multiclass=multiclass)),
        "brightness": (Brightness(), SVM(kernel=RBF(gamma=0.001), multiclass=multiclass)),
    }
    known = registry()
    trained = Pipeline(cues, integrator(f"integrator={option}")).fit(Walk())
    loaded = load_model(save_model(trained, tmp_path / "m", known), known)
    walk = list(Walk(rounds=1, seed=1))
    before, after = (
        np.concatenate([each.scores.values for each in pipeline.beliefs(walk)])
        for pipeline in (trained, loaded)
    )
    assert before.tobytes() == after.tobytes()


def test_gdas_keeps_its_weights_with_the_model(tmp_path: Path) -> None:
    cues = {
        name: (cue, SVM(kernel=RBF(gamma=0.1)))
        for name, cue in (("beams", Beams()), ("brightness", Brightness()))
    }
    known = registry()
    trained = Pipeline(cues, GDAS(weights={"beams": 3, "brightness": 1})).fit(Walk())
    loaded = load_model(save_model(trained, tmp_path / "m", known), known)
    assert loaded.integrator.weights_.tolist() == [0.75, 0.25]  # type: ignore[attr-defined]
    assert loaded.integrator.get_params() == trained.integrator.get_params()
