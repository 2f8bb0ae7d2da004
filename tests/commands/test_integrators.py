"""``placecue train integrator=``: swept, and refused in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from command_line import placecue, succeeds
from placecue import Belief, Observation, OneAgainstAll, Scores
from placecue.evaluation.tally import Tally


def test_a_sweep_over_integrators(tmp_path: Path, log_a: Path) -> None:
    out = tmp_path / "sweep"
    few = [f"cues.{cue}.classifier.search=null" for cue in ("crfh", "laser")]
    words = ["cue=[crfh,laser]", *few, f"log={log_a}", f"out={out}"]
    succeeds("train", "-m", "integrator=gdas,svm_das_linear", *words)
    manifests = [json.loads((out / job / "manifest.json").read_text()) for job in "01"]
    found = [each["pipeline"]["integrator"]["plugin"] for each in manifests]
    assert found == ["gdas", "svm_das"]


def test_unequal_outputs_are_one_line(tmp_path: Path, log_a: Path) -> None:
    few = [f"cues.{cue}.classifier.search=null" for cue in ("crfh", "laser")]
    words = ["cue=[crfh,laser]", *few, "cues.crfh.classifier.multiclass=oao", f"log={log_a}"]
    told = placecue("train", "integrator=gdas", *words, f"out={tmp_path / 'm'}")
    assert told.status == 2
    assert "gdas adds up the outputs of cues, which must be of one layout" in told.line
    assert "'crfh' are one_against_one" in told.line
    assert "'laser' one_against_all" in told.line


def test_a_cue_is_scored_wherever_it_was_asked() -> None:
    """Also where it was the only one: else the sure decisions of the first cue would not count."""
    tally = Tally()
    layout = OneAgainstAll(("hall", "room"))
    sure = Scores(np.array([[1.0, -1.0]]), layout)
    unsure = Scores(np.array([[-0.1, 0.1]]), layout)
    beliefs = [
        Belief(0, sure, "hall", 2.0, {"laser": sure}),
        Belief(1, sure, "hall", 2.0, {"laser": unsure, "crfh": sure}),
    ]
    for belief in beliefs:
        tally.observe(Observation(belief.stamp, label="hall"), belief, None)
    assert tally.methods == ["laser", "crfh", "integrated"]
    assert tally.recall("laser", "hall") == 0.5
    assert tally.recall("crfh", "hall") == 1.0
    assert tally.used == {"laser": 2, "crfh": 1}
