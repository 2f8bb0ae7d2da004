"""``placecue doctor``: what is wrong, and how it is told."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import pytest

from command_line import placecue, succeeds


def test_an_installation_without_faults(tmp_path: Path) -> None:
    told = succeeds("doctor", f"cache.folder={tmp_path}/cache").out
    assert f"numpy {version('numpy')}" in told
    for what in ("python", "plugins", "GPU", "cache", "extra ray", "extra dask", "output"):
        assert any(line[6:].startswith(f"{what}: ") for line in told.splitlines()), what
    assert not any(line.startswith("wrong") for line in told.splitlines())
    assert list(tmp_path.iterdir()) == []


def test_a_log_and_a_model(log_a: Path, laser_model: Path) -> None:
    told = succeeds("doctor", str(log_a), str(laser_model)).out
    assert f"ok    log {log_a}, scan: /scan (the only scan topic)" in told
    assert f"ok    log {log_a}: 96 observations" in told
    assert "4 classes (corridor, kitchen, lab, office)" in told


def test_as_json(log_a: Path) -> None:
    findings = json.loads(succeeds("doctor", str(log_a), "--json").out)
    assert {each["state"] for each in findings} <= {"ok", "note"}
    assert all(set(each) == {"state", "what", "found", "mend"} for each in findings)


def test_a_log_that_needs_a_choice_and_one_that_is_none(two_lasers: Path, tmp_path: Path) -> None:
    told = placecue("doctor", str(two_lasers))
    assert told.status == 1
    assert "wrong log " in told.out
    assert "source.scan_topic=/" in told.out
    text = tmp_path / "notes.mcap"
    text.write_text("hello")
    told = placecue("doctor", str(text))
    assert told.status == 1
    assert "is not an MCAP file" in told.line


def test_a_broken_model_and_a_cache_that_cannot_be(laser_model: Path, tmp_path: Path) -> None:
    broken = tmp_path / "model"
    broken.mkdir()
    (broken / "manifest.json").write_text('{"format": "placecue/model"}')
    file = tmp_path / "file"
    file.write_text("")
    told = placecue("doctor", f"model={broken}", f"cache.folder={file}")
    assert told.status == 1
    lines = told.out.splitlines()
    assert any(line.startswith(f"wrong model {broken}: ") for line in lines)
    assert f"wrong cache: {file} cannot be written; give cache.folder=PATH" in told.out
    assert told.line.startswith("2 things are wrong, the first: cache: ")


@pytest.mark.parametrize("words", [["json=maybe"], ["nope=1"]])
def test_wrong_words(words: list[str]) -> None:
    assert placecue("doctor", *words).status == 2
