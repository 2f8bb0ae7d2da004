"""Model folders that are none, or damaged, or made by a plugin that is not there."""

from __future__ import annotations

import json
import os
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from command_line import placecue, succeeds
from folders import reseal
from placecue_cues.laser import LaserGeometry

Damage = Callable[[Path], Any]


def edited(**changes: Any) -> Damage:
    """Return a damage that changes entries of the manifest; None takes one out."""

    def damage(folder: Path) -> None:
        path = folder / "manifest.json"
        manifest = {**json.loads(path.read_text()), **changes}
        path.write_text(json.dumps({k: v for k, v in manifest.items() if v is not None}))
        reseal(folder)

    return damage


def cut(name: str) -> Damage:
    return lambda folder: (folder / name).write_bytes((folder / name).read_bytes()[:100])


def piped(name: str) -> Damage:
    def damage(folder: Path) -> None:
        (folder / name).unlink()
        os.mkfifo(folder / name)

    return damage


def linked(name: str, target: str) -> Damage:
    def damage(folder: Path) -> None:
        (folder / name).unlink()
        (folder / name).symlink_to(target)

    return damage


def unsealed(folder: Path) -> None:
    """Change a parameter without making the digest right."""
    path = folder / "manifest.json"
    path.write_text(path.read_text().replace('"C": 100.0', '"C": 900.0', 1))


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (shutil.rmtree, "is not a model folder: it does not exist"),
        (lambda folder: (folder / "manifest.json").unlink(), "it has no readable manifest.json"),
        (lambda folder: (folder / "state.json").unlink(), "state.json is missing"),
        (lambda folder: (folder / "arrays.npz").unlink(), "arrays.npz is missing"),
        (piped("state.json"), "state.json is no plain file"),
        (piped("manifest.json"), "manifest.json is no plain file"),
        (linked("arrays.npz", "/dev/zero"), "arrays.npz is a link"),
        (linked("manifest.json", "/dev/zero"), "manifest.json is a link"),
        (cut("manifest.json"), "manifest.json is damaged"),
        (cut("state.json"), "state.json is not the file that its manifest describes"),
        (cut("arrays.npz"), "arrays.npz is not the file that its manifest describes"),
        (edited(format="something else"), "is not the manifest of a placecue model"),
        (edited(format_version=99), "is a model of format 99; this placecue "),
        (edited(pipeline=None), "its entry 'pipeline' is missing or no dict"),
        (edited(files=None), "its entry 'files' is missing or no dict"),
        (edited(files={}), "its 'files' are not state.json and arrays.npz"),
        (edited(classes=["corridor", "lab"]), "has other classes than the manifest"),
        (edited(plugins=[]), "its manifest does not name all components of its pipeline"),
        (edited(pipeline=[1, 2]), "its entry 'pipeline' is missing or no dict"),
        (edited(pipeline={"cues": {}, "integrator": None}), "is damaged"),
        (unsealed, "manifest.json is damaged: it is not what was written"),
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
        "component_version": "1",
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


def test_a_model_of_other_versions(
    tmp_path: Path, laser_model: Path, log_b: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(LaserGeometry, "version", "the next")
    words = [f"model={laser_model}", f"log={log_b}", "cache.folder=null"]
    for command in ("classify", "label"):
        told = placecue(command, *words, "out=out")
        assert told.status == 2
        assert "cue 'laser' of version" in told.line
        assert "and version the next is installed" in told.line
        assert "other_versions=warn" in told.line
        assert not (tmp_path / "out").exists()
        told = placecue(command, *words, f"out={command}", "other_versions=warn")
        assert told.status == 0
        assert "and version the next is installed" in told.err
    told = placecue("classify", *words, "out=out", "other_versions=sometimes")
    assert "other_versions must be refuse or warn, got 'sometimes'" in told.line


def test_a_model_of_format_1_says_how_to_train_it_again(
    tmp_path: Path, laser_model: Path, log_b: Path
) -> None:
    folder = tmp_path / "old model"
    shutil.copytree(laser_model, folder)
    edited(format_version=1)(folder)
    told = placecue("classify", f"model={folder}", f"log={log_b}", "out=out")
    assert told.status == 1
    assert "is a model of format 1; this placecue" in told.line
    command = shlex.split(told.line.partition("train it again as it was, ")[2])
    assert command[:2] == ["placecue", "train"]
    succeeds(*command[1:-1], "out=new")
    succeeds("classify", "model=new", f"log={log_b}", "out=out")


def test_a_log_in_place_of_a_model(tmp_path: Path, log_b: Path) -> None:
    told = placecue("classify", f"model={log_b}", f"log={log_b}", "out=out")
    assert told.status == 1
    assert f"{log_b} is not a model folder" in told.line
    assert list(tmp_path.iterdir()) == []


def test_a_log_that_lacks_what_the_model_needs(
    tmp_path: Path, model: Path, two_lasers: Path
) -> None:
    words = [f"model={model}", f"log={two_lasers}", "source.scan_topic=/front", "out=out"]
    told = placecue("classify", *words, "min_cues=2")
    assert told.status == 1
    assert told.line.startswith("no usable observation: 20 of 20 observations passed over")
    assert "no image" in told.line
    assert all(path.is_dir() for path in tmp_path.rglob("*"))
