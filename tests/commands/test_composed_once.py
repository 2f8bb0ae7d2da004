"""The config of a run is composed once; what asks for a sweep is left to Hydra."""

from __future__ import annotations

from pathlib import Path

import pytest
from hydra._internal.config_loader_impl import ConfigLoaderImpl

from command_line import placecue, succeeds

COMPOSE = ConfigLoaderImpl.load_configuration


def test_a_run_composes_once(log_a: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    composed = []

    def counted(self: ConfigLoaderImpl, *words: object, **options: object) -> object:
        composed.append(words)
        return COMPOSE(self, *words, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(ConfigLoaderImpl, "load_configuration", counted)
    succeeds("info", f"log={log_a}")
    assert len(composed) == 1


@pytest.mark.parametrize(
    ("encoding", "names"), [("cdr,json", {"a_0.mcap", "a_1.mcap"}), ("json", {"a.mcap"})]
)
def test_a_mode_that_sweeps(tmp_path: Path, log_a: Path, encoding: str, names: set[str]) -> None:
    words = ["source=mcap", f"log={log_a}", f"encoding={encoding}", "hydra.mode=MULTIRUN"]
    succeeds("convert", *words, f"hydra.sweep.dir={tmp_path / 'jobs'}", "out=a.mcap")
    assert {path.name for path in tmp_path.glob("*.mcap")} == names
    assert (tmp_path / "jobs").is_dir()  # of a sweep, of however many jobs


def test_several_values_without_a_sweep(log_a: Path) -> None:
    told = placecue("convert", "source=mcap", f"log={log_a}", "encoding=cdr,json", "out=a.mcap")
    assert told.status == 2
    assert "--multirun" in told.line
