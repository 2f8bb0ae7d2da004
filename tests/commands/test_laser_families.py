"""The laser's SVM weighs families of features, from the command line to the model folder."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from command_line import succeeds
from placecue.components.manager import load_plugins
from placecue.logs import McapLog
from placecue.scaling import FamilyScaling, QuantileScaling
from placecue.storage.model import load_model
from results import rows
from rooms import ROOMS

LASER = "cues.laser.classifier"
ONE = [f"{LASER}.search.C=[10]", f"{LASER}.search.gamma=[0.1]"]


def scaling_of(model: Path) -> FamilyScaling:
    loaded = load_model(model, load_plugins(built_ins_only=True).registry)
    scaling = loaded.cues["laser"].classifier.scaling_  # type: ignore[attr-defined]
    assert isinstance(scaling, FamilyScaling)
    return scaling


def test_convert_train_and_classify(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    converted, model, out = tmp_path / "run.mcap", tmp_path / "model", tmp_path / "out"
    succeeds("convert", "source=mcap", f"source.path={log_a}", f"out={converted}")
    succeeds("train", "cue=laser", "integrator=none", *ONE, f"log={converted}", f"out={model}")
    told = succeeds("classify", f"model={model}", f"log={log_b}", f"out={out}")
    scaling = scaling_of(model)
    assert isinstance(scaling.scaling_, QuantileScaling)
    # Of the group's list: the pair f2, three of size from f5 on, 20 + 20 gaps, 99 descriptors.
    sizes = scaling.weights_[[0, 2, 9, 29, 171]] ** -2
    assert sizes == pytest.approx([2, 3, 40, 99, 40])
    registry = load_plugins(built_ins_only=True).registry
    beliefs = list(load_model(model, registry).beliefs(McapLog(str(log_b))))
    table = rows(out / "beliefs.csv")
    for row, belief in zip(table, beliefs, strict=True):
        scores = [float(row[f"score:{name}"]) for name in ROOMS]
        np.testing.assert_allclose(scores, belief.scores.values[0], atol=1e-9)
    right = sum(row["label"] == row["truth"] for row in table)
    assert right / len(table) > 0.9, told.out


def test_weights_by_family(tmp_path: Path, log_a: Path) -> None:
    words = ["train", "cue=laser", "integrator=none", *ONE, f"log={log_a}"]
    halved = f"{LASER}.scaling.weights={{fourier: 0.5, gaps: 0}}"
    succeeds(*words, "cues.laser.preset=full", halved, f"out={tmp_path / 'm'}")
    weights = scaling_of(tmp_path / "m").weights_
    # Of 85 columns ten count gaps and sixteen are descriptors.
    assert np.count_nonzero(weights == 0) == 10
    assert np.count_nonzero(np.isclose(weights, np.sqrt(0.5 / 16))) == 16


def test_the_group_s_own_settings_stay_plain(tmp_path: Path, log_a: Path) -> None:
    chosen = [f"classifier@{LASER}=svm_laser_group", f"{LASER}.search.gamma=[0.01]"]
    words = ["cue=laser", "integrator=none", *chosen, f"log={log_a}", f"out={tmp_path / 'm'}"]
    succeeds("train", *words)
    loaded = load_model(tmp_path / "m", load_plugins(built_ins_only=True).registry)
    assert type(loaded.cues["laser"].classifier.scaling_).__name__ == "RangeScaling"  # type: ignore[attr-defined]
