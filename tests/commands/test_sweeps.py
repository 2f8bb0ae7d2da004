"""``-m``: one run for each value."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from omegaconf import OmegaConf

from command_line import placecue, succeeds
from placecue.commands.numbered import swept_keys, tells_jobs_apart
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


def test_the_table_at_the_end(tmp_path: Path, laser_model: Path, log_a: Path, log_b: Path) -> None:
    words = [f"model={laser_model}", f"log={log_a},{log_b}", f"out={tmp_path}/sweep"]
    told = succeeds("classify", "-m", *words, "cache.folder=null").out
    heading, first, second = told.rstrip().splitlines()[-3:]
    assert heading.split() == ["job", "log", "balanced", "accuracy", "(%)"]
    for number, (line, log) in enumerate(((first, log_a), (second, log_b))):
        metrics = json.loads((tmp_path / "sweep" / str(number) / "metrics.json").read_text())
        share = metrics["methods"]["integrated"]["balanced_accuracy"]
        assert line.split()[0] == str(number)
        assert line.split()[-1] == f"{100 * share:.1f}"
        assert log.name in told
    assert [path.name for path in tmp_path.iterdir()] == ["sweep"]


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
    told = placecue("label", "-m", f"log={log_a}", "model=nowhere,there", f"out={tmp_path}/out")
    assert told.status == 1
    assert told.line.startswith("2 of 2 jobs failed")
    assert "there" in told.line


def test_one_out_for_all_is_numbered(tmp_path: Path, log_a: Path) -> None:
    (tmp_path / "own").mkdir()
    options = ["-m", "--config-dir", "own"]
    words = ["convert", *options, "source=mcap", f"log={log_a}", "encoding=cdr,json"]
    succeeds(*words, "out=made/a.mcap")
    assert sorted(path.name for path in (tmp_path / "made").iterdir()) == ["a_0.mcap", "a_1.mcap"]
    kinds = {open_log(tmp_path / "made" / f"a_{job}.mcap").topics[0].encoding for job in "01"}
    assert kinds == {"cdr", "json"}
    told = placecue(*words, "out=made/a.mcap")
    assert told.line.startswith("2 of 2 jobs failed: job 0 (")
    assert "out=made/a_0.mcap is there already" in told.line


def test_a_copy_for_each_log(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    labels = "label_map={lab: office}"
    succeeds("annotate", "-m", f"log={log_a},{log_b}", labels, "out=copy.mcap")
    for job, log in zip("01", (log_a, log_b), strict=True):
        copy = open_log(tmp_path / f"copy_{job}.mcap", label_topic="/placecue/label")
        assert [each.pose for each in copy.trail()] == [each.pose for each in open_log(log).trail()]


@pytest.mark.parametrize(
    ("out", "swept", "apart"),
    [
        ("a.mcap", {"encoding"}, False),
        ("a.mcap", {"out"}, True),
        ("a.mcap", {"out", "encoding"}, False),
        ("${encoding}.mcap", {"encoding"}, True),
        ("${encoding}.mcap", {"encoding", "source.seed"}, False),
        ("${encoding}/${source.seed}.mcap", {"encoding", "source.seed"}, True),
        ("${name}.mcap", {"encoding"}, True),  # which is made of it
        ("${source.plugin}.mcap", {"source"}, True),  # a choice of a group
        ("${sources}.mcap", {"source"}, False),
        ("${itself}.mcap", {"encoding"}, False),
    ],
)
def test_an_out_that_names_what_changes_keeps_its_name(
    out: str, swept: set[str], apart: bool
) -> None:
    source = {"plugin": "office", "seed": 0}
    rest = {"name": "run_${encoding}", "sources": "two", "itself": "${itself}"}
    config = OmegaConf.create({"out": out, "encoding": "cdr", "source": source, **rest})
    assert tells_jobs_apart(config, swept) == apart


def test_what_is_swept() -> None:
    words = ["encoding=cdr,json", "source.seed=range(3)", "log=[a,b]", "out='a,b'", "~world"]
    assert swept_keys(words, ["source.run"]) == {"encoding", "source.seed", "source.run"}


def test_the_benchmark_of_twelve_names_its_logs(tmp_path: Path) -> None:
    """Its option sweeps by itself, and says so in out."""
    small = ["source.samples=2", "source.width=32", "source.height=24", "source.beams=9"]
    only = ["source.illumination=night", "source.run=1,2"]
    succeeds("convert", "-m", "world=office_idol", "out_dir=of", *only, *small)
    names = sorted(path.name for path in (tmp_path / "of" / "world0").iterdir())
    assert names == ["idol_night1.mcap", "idol_night2.mcap"]


@pytest.mark.parametrize(
    ("launcher", "package"),
    [
        ("joblib", "hydra_plugins.hydra_joblib_launcher"),
        ("submitit_local", "hydra_plugins.hydra_submitit_launcher"),
    ],
)
def test_jobs_in_processes_of_their_own(
    tmp_path: Path, log_a: Path, launcher: str, package: str
) -> None:
    pytest.importorskip(package, reason="hydra/launcher= needs placecue[slurm]")
    multiclass = "cues.crfh.classifier.multiclass=oaa,oao"
    words = ["-m", f"hydra/launcher={launcher}", *CRFH, multiclass, f"log={log_a}", "out=sweep"]
    assert placecue("train", *words).status == 0
    assert [path.name for path in tmp_path.iterdir()] == ["sweep"]
    found = [
        manifest(tmp_path / "sweep" / job)["pipeline"]["cues"]["crfh"]["classifier"]["multiclass"]
        for job in "01"
    ]
    assert found == ["oaa", "oao"]


def test_a_sweep_leaves_results_only(tmp_path: Path, log_a: Path) -> None:
    succeeds("train", "-m", *CRFH, f"log={log_a},{log_a}", "out=sweep")
    assert [path.name for path in tmp_path.iterdir()] == ["sweep"]
