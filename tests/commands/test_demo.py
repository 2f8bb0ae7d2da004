"""``placecue demo``, with few and small observations."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from command_line import placecue
from placecue.commands.files import DEMONSTRATED
from placecue.components.manager import load_plugins
from placecue.semantic_map import SemanticMap
from placecue.storage.model import load_model
from results import check_metrics, messages, rows

SMALL = ["rate=0.4", "speed=1.0", "samples=45", "width=64", "height=48", "beams=61"]
PARTS = ["cues.crfh", "cues.laser", "integrator"]


def test_the_demo(tmp_path: Path) -> None:
    out = tmp_path / "demo"
    small = [f"source.{word}" for word in SMALL]
    quick = [f"{part}.classifier.search=null" for part in PARTS]
    told = placecue("demo", *small, *quick, f"out={out}")
    assert told.status == 0, told.err
    shown, _, following = told.out.partition("\ndone in ")
    last = [line.split()[-1] for line in shown.splitlines() if line]
    named = {Path(word) for word in last if word.startswith(str(out))}
    assert len(named) == 15
    for path in named:
        assert list(path.parent.glob(path.name)), path
    made = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    assert made - {"model/reliability.png"} == set(DEMONSTRATED) - {"model/reliability.png"}
    table = rows(out / "beliefs.csv")
    assert 20 < len(table) <= 45
    scores = json.loads((out / "metrics.json").read_text())["methods"]
    assert set(scores) == {"crfh", "laser", "integrated"}
    check_metrics(out)
    for method in scores.values():
        assert f"{100 * method['balanced_accuracy']:.1f}" in shown
    semantic_map = SemanticMap.from_json(json.loads((out / "semantic_map.json").read_text()))
    pipeline = load_model(out / "model", load_plugins(built_ins_only=True).registry)
    assert semantic_map.classes == pipeline.classes
    assert set(pipeline.classes) >= {row["truth"] for row in table}
    assert len(messages(out / "annotated.mcap", "/placecue/belief")) == len(table)
    advised = [line.split() for line in following.splitlines()[1:]]
    assert [words[:2] for words in advised] == [
        ["placecue", command] for command in ("info", "train", "classify")
    ]
    for words in advised:
        assert placecue(*words[1:]).status == 0
    assert (out / "by_laser" / "beliefs.csv").is_file()


def test_the_demo_without_labels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("placecue.starter.pipeline.find_spec", lambda name: None)  # no deep extra
    out = tmp_path / "demo"
    small = [f"source.{word}" for word in SMALL]
    told = placecue("demo", "starter=true", *small, f"out={out}")
    assert told.status == 0, told.err
    assert "the starter tells corridor, doorway, room" in told.err
    assert not (out / "model").exists()
    check_metrics(out)
    table = rows(out / "beliefs.csv")
    assert {row["truth"] for row in table} == {"corridor", "room"}
    assert "model=" not in told.out.partition("\ndone in ")[0]
