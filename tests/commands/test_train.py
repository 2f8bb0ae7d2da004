"""``placecue train``: what a model folder says and holds."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from command_line import placecue, succeeds
from placecue.components.manager import load_plugins
from placecue.pipeline import Pipeline
from placecue.storage.model import load_model
from rooms import ROOMS, Rooms

REGISTRY = load_plugins(built_ins_only=True).registry
GAMMA = "cues.laser.classifier.kernel.gamma"
CRFH = ["cue=crfh", "integrator=none", "cues.crfh.classifier.search=null"]
FILES = {"arrays.npz", "config.yaml", "manifest.json", "report.html", "state.json"}


def trained(out: Path, *words: str) -> tuple[Pipeline, dict[str, Any]]:
    """Train, and return the model read back with its manifest."""
    told = succeeds("train", *words, f"out={out}")
    assert f"next: placecue classify {out} LOG" in told.out
    assert {path.name for path in out.iterdir()} - {"search"} == FILES
    manifest = json.loads((out / "manifest.json").read_text())
    return load_model(out, REGISTRY), manifest


def right(pipeline: Pipeline) -> float:
    """Return the share of unseen observations that a model recognises."""
    observations = list(Rooms(seed=1))
    beliefs = list(pipeline.beliefs(observations, batch=16))
    assert len(beliefs) == len(observations)
    return sum(b.label == o.label for b, o in zip(beliefs, observations, strict=True)) / 96


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_one_cue(laser_model: Path) -> None:
    pipeline = load_model(laser_model, REGISTRY)
    assert pipeline.classes == tuple(ROOMS)
    assert list(pipeline.cues) == ["laser"]
    assert right(pipeline) > 0.75
    config = yaml.safe_load((laser_model / "config.yaml").read_text())
    assert config["cues"]["laser"]["classifier"]["search"]["C"] == [1, 10, 100]
    assert not config["integrator"]


def test_two_cues(model: Path, log_a: Path) -> None:
    pipeline = load_model(model, REGISTRY)
    assert list(pipeline.cues) == ["crfh", "laser"]
    assert right(pipeline) > 0.95
    manifest = json.loads((model / "manifest.json").read_text())
    assert manifest["classes"] == list(ROOMS)
    assert [(each["name"], each["digest"]) for each in manifest["logs"]] == [
        ("a.mcap", sha256(log_a))
    ]
    assert {(each["kind"], each["name"]) for each in manifest["plugins"]} == {
        *[("cue", "crfh"), ("cue", "laser"), ("classifier", "svm"), ("integrator", "svm_das")],
        *[("kernel", "chi2"), ("kernel", "rbf"), ("folds", "interleaved")],
        *[("scaling", "families"), ("scaling", "quantiles"), ("scaling", "range")],
        *[("layout", "one_against_all"), ("layout", "one_against_one")],
    }
    assert manifest["files"] == {
        name: {"size": (model / name).stat().st_size, "sha256": sha256(model / name)}
        for name in ("state.json", "arrays.npz")
    }


def test_an_integration_log(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    logs = [f"log={log_a}", f"integration_log={log_b}"]
    parts = ("cues.crfh", "cues.laser", "integrator")
    quick = [f"{part}.classifier.search=null" for part in parts]
    pipeline, manifest = trained(tmp_path / "m", "cue=[crfh,laser]", *logs, *quick)
    assert [each["digest"] for each in manifest["logs"]] == [sha256(log_a), sha256(log_b)]
    assert right(pipeline) > 0.95


def test_two_logs(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    words = [*CRFH, f"log=[{log_a},{log_b}]"]
    _, manifest = trained(tmp_path / "m", *words)
    assert [each["digest"] for each in manifest["logs"]] == [sha256(log_a), sha256(log_b)]


def test_floorplans(tmp_path: Path, plan: Path) -> None:
    words = ["+recipe=floorplans", f"source.path=[{plan}]", "source.samples=60"]
    pipeline, manifest = trained(
        tmp_path / "m", *words, "source.balance=class", "source.beams=91", "source.seed=3"
    )
    assert pipeline.classes == ("doorway", "hallway", "room")
    assert manifest["pipeline"]["cues"]["laser"]["preset"] == "full"
    assert manifest["logs"][0]["name"] == "plan"


def test_frames_in_scenes(tmp_path: Path) -> None:
    generator = np.random.default_rng(0)
    lines = ["index,room,rgb,scene"]
    for number in range(24):
        shade = 60 + 90 * (number // 12)
        noise = generator.integers(0, 40, (12, 16, 3)).astype(np.uint8)
        cv2.imwrite(str(tmp_path / f"{number}.png"), shade + noise)
        lines.append(f"{number},{'office' if shade > 99 else 'attic'},{number}.png,{number // 3}")
    (tmp_path / "labels.csv").write_text("\n".join(lines))
    words = ["+recipe=nyuv2", f"log={tmp_path}", "source.depth_column=null"]
    scenes = ["source.scene_column=scene", "source.cuts=null", "source.min_frames=2"]
    cue = ["cue=color_histogram", "integrator=none", "cues.color_histogram.classifier.search.C=[1]"]
    _, manifest = trained(tmp_path / "m", *words, *scenes, *cue)
    assert manifest["pipeline"]["folds"] == {"plugin": "scenes", "n_folds": 5}
    assert manifest["classes"] == ["attic", "office"]
    # Fifths of 12 frames are 0-2, 3-4, 5-7, 8-9, 10-11: of scenes of three each parts all but one.
    told = placecue("train", *words, *scenes, *cue, "folds=blocks", f"out={tmp_path / 'n'}")
    assert told.status == 0
    assert told.line.startswith("folds Blocks part 6 of 8 scenes")


@pytest.mark.parametrize(
    ("cue", "words"),
    [
        ("laser", ["kernel@cues.laser.classifier.kernel=linear"]),
        ("laser", ["kernel@cues.laser.classifier.kernel=rbf", "cues.laser.preset=full"]),
        ("laser", ["cues.laser.classifier.multiclass=oao"]),
        ("laser", ["cues.laser.classifier.multiclass=modified_oaa"]),
        ("laser", ["cues.laser.classifier.scaling=standard", f"{GAMMA}=0.003"]),
        ("crfh", ["kernel@cues.crfh.classifier.kernel=chi2", "cues.crfh.bins=8"]),
        ("crfh", ["kernel@cues.crfh.classifier.kernel=linear", "cues.crfh.precision=single"]),
    ],
)
def test_every_option_of_kernel_and_classifier(
    tmp_path: Path, log_a: Path, cue: str, words: list[str]
) -> None:
    search = f"cues.{cue}.classifier.search=null"
    pipeline, _ = trained(
        tmp_path / "m", f"cue={cue}", "integrator=none", f"log={log_a}", search, *words
    )
    assert pipeline.classes == tuple(ROOMS)
    assert right(pipeline) > 0.5  # of four classes of equal size


def test_training_again_replaces_the_model(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    out = tmp_path / "2024"
    for log in (log_a, log_b):
        words = [*CRFH, f"log={log}", "out=2024"]  # digits are a name like any other
        succeeds("train", *words, "overwrite=true")
    manifest = json.loads((out / "manifest.json").read_text())
    assert [each["name"] for each in manifest["logs"]] == ["b.mcap"]
