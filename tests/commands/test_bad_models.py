"""Model folders that are none, or damaged, or made by a plugin that is not there."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from command_line import placecue

Damage = Callable[[Path], Any]


def edited(**changes: Any) -> Damage:
    """Return a damage that changes entries of the manifest; None takes one out."""

    def damage(folder: Path) -> None:
        path = folder / "manifest.json"
        manifest = {**json.loads(path.read_text()), **changes}
        path.write_text(json.dumps({k: v for k, v in manifest.items() if v is not None}))

    return damage


def cut(name: str) -> Damage:
    return lambda folder: (folder / name).write_bytes((folder / name).read_bytes()[:100])


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (shutil.rmtree, "is not a model folder: it does not exist"),
        (lambda folder: (folder / "manifest.json").unlink(), "it has no readable manifest.json"),
        (lambda folder: (folder / "state.json").unlink(), "is damaged (FileNotFoundError"),
        (lambda folder: (folder / "arrays.npz").unlink(), "is damaged (FileNotFoundError"),
        (cut("manifest.json"), "manifest.json is damaged"),
        (cut("state.json"), "state.json is not the file that its manifest describes"),
        (cut("arrays.npz"), "arrays.npz is not the file that its manifest describes"),
        (edited(format="something else"), "is not the manifest of a placecue model"),
        (edited(format_version=99), "is a model of format 99; this placecue "),
        (edited(pipeline=None), "is damaged (KeyError: 'pipeline'); train it again"),
        (edited(digests=None), "is damaged (KeyError: 'digests'); train it again"),
        (edited(pipeline=[1, 2]), "is damaged"),
    ],
)
def test_damaged_models(
    tmp_path: Path, laser_model: Path, log_b: Path, damage: Damage, said: str
) -> None:
    folder = tmp_path / "model"
    shutil.copytree(laser_model, folder)
    damage(folder)
    command = "label" if "state" in said else "classify"
    told = placecue(command, f"model={folder}", f"log={log_b}", "out=out")
    assert told.status == 1, told.err
    assert said in told.line
    assert str(folder) in told.line
    assert not (tmp_path / "out").exists()


def test_a_plugin_that_is_not_installed_is_named(
    tmp_path: Path, laser_model: Path, log_b: Path
) -> None:
    folder = tmp_path / "model"
    shutil.copytree(laser_model, folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    missing = {
        "kind": "cue",
        "name": "spread",
        "distribution": "placecue-thirdparty",
        "version": "3.1",
    }
    edited(plugins=[*manifest["plugins"], missing])(folder)
    told = placecue("classify", f"model={folder}", f"log={log_b}", "out=out")
    assert told.status == 2
    assert "needs cue 'spread' of the plugin placecue-thirdparty 3.1, which is not" in told.line
    assert "pip install placecue-thirdparty" in told.line


def test_a_log_in_place_of_a_model(tmp_path: Path, log_b: Path) -> None:
    told = placecue("classify", f"model={log_b}", f"log={log_b}", "out=out")
    assert told.status == 1
    assert f"{log_b} is not a model folder" in told.line
    assert list(tmp_path.iterdir()) == []


def test_a_log_that_lacks_what_the_model_needs(
    tmp_path: Path, model: Path, two_lasers: Path
) -> None:
    words = [f"model={model}", f"log={two_lasers}", "source.scan_topic=/front", "out=out"]
    told = placecue("classify", *words)
    assert told.status == 1
    assert told.line.startswith("no usable observation: 20 of 20 observations passed over")
    assert "no image" in told.line
    assert all(path.is_dir() for path in tmp_path.rglob("*"))
