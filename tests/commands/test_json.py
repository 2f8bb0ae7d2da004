"""``--json``: one document on standard output, with the numbers of the tables."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from command_line import succeeds


def document(*words: str) -> Any:
    return json.loads(succeeds(*words, "--json").out)


def test_info(log_a: Path, log_b: Path) -> None:
    first, second = document("info", str(log_a), str(log_b))
    assert (first["path"], second["path"]) == (str(log_a), str(log_b))
    assert first["labels"] == dict.fromkeys(("corridor", "kitchen", "lab", "office"), 24)
    assert first["coverage"] == 1.0
    assert {topic["name"]: topic["count"] for topic in first["topics"]}["/scan"] == 96


def test_classify_and_label(laser_model: Path, log_b: Path, tmp_path: Path) -> None:
    said = document("classify", str(laser_model), str(log_b), "out=beliefs")
    assert said["scores"] == json.loads((tmp_path / "beliefs" / "metrics.json").read_text())
    assert all((tmp_path / path).is_file() for path in said["files"].values())
    said = document("label", str(laser_model), str(log_b), "out=map")
    assert said["map"] == json.loads((tmp_path / "map" / "semantic_map.json").read_text())


def test_train(log_a: Path, tmp_path: Path) -> None:
    few = "cues.laser.classifier.search.gamma=[0.01,0.1]"
    said = document("train", str(log_a), "cue=laser", "integrator=none", few, "out=model")
    assert said["classes"] == ["corridor", "kitchen", "lab", "office"]
    [best] = said["balanced_accuracy_of_searches"].values()
    rows = (tmp_path / "model" / "search" / "laser.md").read_text().splitlines()
    assert f"{100 * best:.1f}" == rows[2].split("|")[-2].strip()  # best first


def test_plugins_and_cache(tmp_path: Path) -> None:
    found = document("plugins", "kind=cue")["components"]
    assert {each["kind"] for each in found} == {"cue"}
    assert {"crfh", "laser"} <= {each["name"] for each in found}
    assert document("cache", f"cache.folder={tmp_path}/none")["kept"] == []
