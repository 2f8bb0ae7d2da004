"""``placecue train``: what parameters are picked from, and on which sequence."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from command_line import placecue, succeeds
from placecue.components.manager import load_plugins
from placecue.pipeline import Pipeline
from placecue.storage.model import load_model
from rooms import ROOMS, Rooms

REGISTRY = load_plugins(built_ins_only=True).registry
LASER = "cues.laser.classifier"
ALONE = ["cue=laser", "integrator=none"]


def values(pipeline: Pipeline) -> np.ndarray:
    """Return the scores of unseen observations."""
    beliefs = pipeline.beliefs(Rooms(seed=2), batch=16)
    return np.concatenate([belief.scores.values for belief in beliefs])


def test_picked_on_a_second_log(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    second = [f"folds@{LASER}.folds=by_log", f"{LASER}.folds.only_last=true"]
    words = [*ALONE, *second, f"{LASER}.refit=false", f"{LASER}.scaling=null"]
    succeeds("train", *words, f"log=[{log_a},{log_b}]", f"out={tmp_path / 'm'}")
    model = load_model(tmp_path / "m", REGISTRY)
    classifier = model.cues["laser"].classifier
    assert model.classes == tuple(ROOMS)
    # What it would be if it had been trained on the first log alone, with what was picked.
    chosen = [f"{LASER}.C={classifier.C_}", f"{LASER}.kernel.gamma={classifier.kernel_.gamma}"]
    fixed = [*ALONE, *chosen, f"{LASER}.search=null", f"{LASER}.scaling=null"]
    succeeds("train", *fixed, f"log={log_a}", f"out={tmp_path / 'a'}")
    first = load_model(tmp_path / "a", REGISTRY)
    np.testing.assert_allclose(values(model), values(first), rtol=0, atol=1e-9)


def test_one_log_has_no_second_one(tmp_path: Path, log_a: Path) -> None:
    words = [*ALONE, f"log={log_a}", f"out={tmp_path / 'm'}"]
    told = placecue("train", *words, f"{LASER}.folds=by_log")
    assert told.status == 1
    assert told.line.startswith("folds by_log need two logs or more")
    told = placecue("train", *words, f"{LASER}.refit=false")
    assert told.status == 2
    assert "refit=false needs folds that hold out samples once" in told.line


@pytest.mark.parametrize(
    ("cue", "exponents"), [("crfh", np.arange(-24, 13)), ("laser", np.arange(-32, 17))]
)
def test_the_grid_of_the_paper_s_group(
    tmp_path: Path, log_a: Path, cue: str, exponents: np.ndarray
) -> None:
    option = f"classifier@cues.{cue}.classifier=svm_{cue}_group"
    words = [f"cue={cue}", "integrator=none", f"log={log_a}", f"out={tmp_path / 'm'}"]
    succeeds("train", *words, option)
    classifier = load_model(tmp_path / "m", REGISTRY).cues[cue].classifier
    # C = 100 and 8 steps a decade: from 0.001 to 31.6, and from 0.0001 to 100.
    assert classifier.C_ == 100
    assert classifier.multiclass == "oaa"
    np.testing.assert_allclose(classifier.search["gamma"], 10 ** (exponents / 8), rtol=1e-3)
    assert classifier.kernel_.gamma in classifier.search["gamma"]
