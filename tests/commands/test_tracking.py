"""``tracking=mlflow``: runs are kept in MLflow's own store."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from command_line import placecue, succeeds

TRAIN = ["cue=laser", "integrator=none", "cues.laser.classifier.search=null"]


def test_without_it_nothing_is_imported(tmp_path: Path, log_a: Path) -> None:
    before = "mlflow" in sys.modules
    succeeds("train", *TRAIN, f"log={log_a}", "out=plain")
    assert ("mlflow" in sys.modules) == before
    assert not (tmp_path / "plain" / "mlruns.db").exists()


def test_it_has_to_be_installed(monkeypatch: pytest.MonkeyPatch, log_a: Path) -> None:
    import placecue_tracking.mlflow_run as tracked

    monkeypatch.setattr(tracked, "find_spec", lambda name: None)
    told = placecue("train", *TRAIN, f"log={log_a}", "out=m", "tracking=mlflow")
    assert told.status == 2
    assert told.line.startswith("tracking=mlflow needs MLflow, which is not installed: pip install")


def test_a_model_and_its_scores(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    pytest.importorskip("mlflow", reason="tracking=mlflow needs placecue[mlflow]")
    from mlflow import MlflowClient

    succeeds("train", *TRAIN, f"log={log_a}", "out=m", "tracking=mlflow")
    succeeds("classify", "model=m", f"log={log_b}", "out=c", "tracking=mlflow")
    for name, files in {"m": {"manifest.json", "arrays.npz"}, "c": {"beliefs.csv"}}.items():
        client = MlflowClient(f"sqlite:///{tmp_path / name / 'mlruns.db'}")
        experiment = client.get_experiment_by_name("placecue")
        assert experiment is not None
        [run] = client.search_runs([experiment.experiment_id])
        assert run.info.status == "FINISHED"
        assert run.data.params["log"] == str(log_a if name == "m" else log_b)
        assert files <= {each.path for each in client.list_artifacts(run.info.run_id)}
    told = json.loads((tmp_path / "c" / "metrics.json").read_text())["methods"]["integrated"]
    assert run.data.metrics == {"balanced_accuracy/integrated": told["balanced_accuracy"]}


def test_a_run_that_begins_badly_leaves_nothing(tmp_path: Path) -> None:
    pytest.importorskip("mlflow", reason="tracking=mlflow needs placecue[mlflow]")
    told = placecue("train", *TRAIN, "log=nope.mcap", "out=m", "tracking=mlflow")
    assert told.line == "no such log: nope.mcap"
    assert list(tmp_path.rglob("mlruns.db")) == []
