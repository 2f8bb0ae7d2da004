"""``placecue classify``: beliefs, and scores where the log is labelled."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from command_line import succeeds
from results import check_metrics, largest, messages, rows, vote
from rooms import ROOMS, Rooms, write_log


def test_a_labelled_log(tmp_path: Path, model: Path, log_b: Path) -> None:
    out = tmp_path / "out"
    told = succeeds("classify", f"model={model}", f"log={log_b}", f"out={out}")
    table, seen = rows(out / "beliefs.csv"), list(Rooms(seed=1))
    assert [int(row["stamp"]) for row in table] == [each.stamp for each in seen]
    assert [row["truth"] for row in table] == [each.label for each in seen]
    for row, each in zip(table, seen, strict=True):
        assert each.pose is not None
        assert (float(row["x"]), float(row["y"])) == (each.pose.x, each.pose.y)
        assert float(row["theta"]) == pytest.approx(each.pose.theta, abs=1e-12)
        assert row["cues"] == "crfh+laser"
        assert row["label"] == vote(row, list(ROOMS))
    check_metrics(out)
    metrics = json.loads((out / "metrics.json").read_text())
    assert set(metrics["methods"]) == {"crfh", "laser", "integrated"}
    share = 100 * metrics["methods"]["integrated"]["balanced_accuracy"]
    [line] = [line for line in told.out.splitlines() if line.startswith("balanced accuracy")]
    assert line.split()[-1] == f"{share:.1f}"


def test_the_annotated_log(tmp_path: Path, laser_model: Path, log_b: Path) -> None:
    out = tmp_path / "out"
    succeeds("classify", f"model={laser_model}", f"log={log_b}", f"out={out}", "batch=1")
    table = rows(out / "beliefs.csv")
    beliefs = messages(out / "beliefs.mcap", "/placecue/belief")
    assert len(beliefs) == len(table) == 96
    for belief, row in zip(beliefs, table, strict=True):
        assert (belief["stamp"], belief["label"]) == (int(row["stamp"]), row["label"])
        assert belief["cues_used"] == ["laser"]
        assert belief["scores"] == {name: float(row[f"score:{name}"]) for name in ROOMS}
        assert row["label"] == largest(row)
    check_metrics(out)


def test_batches_do_not_matter(tmp_path: Path, model: Path, log_b: Path) -> None:
    outs = [tmp_path / "one", tmp_path / "many"]
    for out, batch in zip(outs, (1, 50), strict=True):
        succeeds("classify", f"model={model}", f"log={log_b}", f"out={out}", f"batch={batch}")
    one, many = (rows(out / "beliefs.csv") for out in outs)
    assert [row["label"] for row in one] == [row["label"] for row in many]
    for first, second in zip(one, many, strict=True):
        for column in (name for name in first if name.startswith("score:")):
            assert float(first[column]) == pytest.approx(float(second[column]), abs=1e-9)


def test_an_unlabelled_log(tmp_path: Path, laser_model: Path) -> None:
    log = write_log(tmp_path / "dark.mcap", [each.relabelled(None) for each in Rooms(seed=1)])
    out = tmp_path / "out"
    told = succeeds("classify", f"model={laser_model}", f"log={log}", f"out={out}")
    assert sorted(path.name for path in out.iterdir()) == [
        *("beliefs.csv", "beliefs.mcap", "report.html")
    ]
    assert {row["truth"] for row in rows(out / "beliefs.csv")} == {""}
    assert "balanced accuracy" not in told.out


def test_part_of_the_log_is_labelled(tmp_path: Path, laser_model: Path) -> None:
    seen = [each if i < 60 else each.relabelled(None) for i, each in enumerate(Rooms(seed=1))]
    out = tmp_path / "out"
    log = write_log(tmp_path / "half.mcap", seen)
    told = succeeds("classify", f"model={laser_model}", f"log={log}", f"out={out}")
    check_metrics(out)
    assert "not scored: 36 without a label, 0 unusable" in told.out
    truth = Counter(row["truth"] for row in rows(out / "beliefs.csv"))
    assert truth == {"": 36, "corridor": 24, "kitchen": 12, "lab": 12, "office": 12}


def test_another_source(tmp_path: Path, laser_model: Path, plan: Path) -> None:
    out = tmp_path / "out"
    where = [f"source.path={plan}", "source.samples=12", "source.beams=61"]
    words = [f"model={laser_model}", "source=floorplan", *where, f"out={out}"]
    succeeds("classify", *words)
    table = rows(out / "beliefs.csv")
    assert len(table) == 12
    assert {row["label"] for row in table} <= set(ROOMS)
    assert {row["truth"] for row in table} <= {"room", "hallway", "doorway"}
