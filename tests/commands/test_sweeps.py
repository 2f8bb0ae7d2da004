"""``-m``: one run for each value."""

from __future__ import annotations

import json
from pathlib import Path

from command_line import placecue, succeeds
from placecue.logs import open_log

CRFH = ["cue=crfh", "integrator=none", "cues.crfh.classifier.search=null"]


def manifest(folder: Path) -> dict:
    return json.loads((folder / "manifest.json").read_text())


def test_a_model_for_each_cue(tmp_path: Path, log_a: Path) -> None:
    out = tmp_path / "sweep"
    succeeds("train", "-m", "cue=laser,crfh", "integrator=none", f"log={log_a}", f"out={out}")
    assert sorted(path.name for path in out.iterdir() if path.is_dir()) == ["0", "1"]
    assert list(manifest(out / "0")["pipeline"]["cues"]) == ["laser"]
    assert list(manifest(out / "1")["pipeline"]["cues"]) == ["crfh"]


def test_without_out_the_jobs_share_a_folder(tmp_path: Path, log_a: Path) -> None:
    multiclass = "cues.crfh.classifier.multiclass=oaa,oao"
    succeeds("train", "-m", *CRFH, multiclass, f"log={log_a}")
    [run] = (tmp_path / "runs").iterdir()
    assert sorted(path.name for path in run.iterdir() if path.is_dir()) == ["0", "1"]
    found = [
        manifest(run / job)["pipeline"]["cues"]["crfh"]["classifier"]["multiclass"] for job in "01"
    ]
    assert found == ["oaa", "oao"]


def test_a_log_for_each_seed(tmp_path: Path, plan: Path) -> None:
    name = f"out={tmp_path}/worlds/${{source.seed}}.mcap"
    small = [f"source.path={plan}", "source.samples=3", "source.beams=9"]
    succeeds("convert", "-m", "source=floorplan", "source.seed=0,1", *small, name)
    logs = sorted((tmp_path / "worlds").iterdir())
    assert [path.name for path in logs] == ["0.mcap", "1.mcap"]
    first, second = (next(iter(open_log(path))).pose for path in logs)
    assert first is not None
    assert first != second


def test_a_job_that_fails_does_not_stop_the_others(tmp_path: Path, log_a: Path) -> None:
    out, logs = tmp_path / "sweep", f"log={log_a},{tmp_path}/nope.mcap,{log_a}"
    told = placecue("train", "-m", *CRFH, logs, f"out={out}")
    assert told.status == 1
    assert told.line.startswith("1 of 3 jobs failed: job 1 (")
    assert f"no such log: {tmp_path}/nope.mcap" in told.line
    assert [(out / job / "manifest.json").exists() for job in "012"] == [True, False, True]


def test_a_wrong_value_among_them(tmp_path: Path, log_a: Path) -> None:
    told = placecue("train", "-m", "cue=laser,lasr", "integrator=none", f"log={log_a}")
    assert told.status == 2
    assert "unknown cue 'lasr'; did you mean 'laser'?" in told.line
    told = placecue("classify", "-m", f"log={log_a},{log_a}", f"out={tmp_path}/out")
    assert told.status == 2
    assert told.line.startswith("2 of 2 jobs failed")
    assert "classify needs model=" in told.line
