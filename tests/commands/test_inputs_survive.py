"""No command writes onto what it reads, whatever that is called."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import placecue, succeeds
from placecue.atomic import write_text
from placecue.commands.outputs import guarded
from placecue.errors import UsageError

FORCE = "overwrite=true"


def contents(folder: Path) -> dict[str, bytes]:
    """Return all files below a folder."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def refused(*words: str) -> str:
    """Return the line of a command that touches nothing."""
    before = contents(Path())
    told = placecue(*words)
    assert told.status == 2, told
    assert contents(Path()) == before
    return told.line


def itself(log: Path) -> Path:
    return log


def from_elsewhere(log: Path) -> Path:
    (log.parent / "sub").mkdir()
    return Path("sub", "..", log.name)


def hard_link(log: Path) -> Path:
    (log.parent / "hard.mcap").hardlink_to(log)
    return Path("hard.mcap")


def symbolic_link(log: Path) -> Path:
    Path("soft.mcap").symlink_to(log)
    return Path("soft.mcap")


@pytest.fixture
def log(tmp_path: Path, log_a: Path) -> Path:
    return Path(shutil.copy(log_a, tmp_path / "log.mcap"))


@pytest.mark.parametrize("name", [itself, from_elsewhere, hard_link, symbolic_link])
@pytest.mark.parametrize("command", ["convert", "annotate"])
def test_the_log_under_any_name(log: Path, name: Callable[[Path], Path], command: str) -> None:
    words = {"convert": ["source=mcap"], "annotate": ["label_map={lab: office}"]}[command]
    out = name(log)
    line = refused(command, *words, f"log={log}", f"out={out}", FORCE)
    assert line == f"out={out} is what log={log} reads: give another out="
    line = refused(command, *words, f"log={out}", f"out={log}", FORCE)
    assert line == f"out={log} is what log={out} reads: give another out="


@pytest.mark.parametrize(
    ("key", "name"), [("rooms", "rooms.geojson"), ("source.labels", "labels.csv")]
)
def test_labels_are_read_too(log: Path, key: str, name: str) -> None:
    Path(name).write_text(json.dumps({"type": "FeatureCollection", "features": []}))
    words = ["source=mcap", f"log={log}", f"{key}={name}", f"out={name}"]
    assert refused("convert", *words, FORCE).startswith(f"out={name} is what {key}={name} reads")


def test_one_of_several_logs(log: Path, log_b: Path) -> None:
    line = refused("convert", "source=mcap", f"log=[{log_b},{log}]", f"out={log}", FORCE)
    assert line == f"out={log} is what log={log} reads: give another out="


@pytest.mark.parametrize(
    ("command", "name"), [("classify", "beliefs.mcap"), ("label", "annotated.mcap")]
)
def test_the_log_in_the_folder_of_results(
    log: Path, laser_model: Path, command: str, name: str
) -> None:
    Path("d").mkdir()
    Path("d", name).hardlink_to(log)
    line = refused(command, f"model={laser_model}", f"log={log}", "out=d", FORCE)
    assert line == f"out=d holds {name}, which log={log} reads: give another out="


def test_what_an_older_run_wrote_is_read(log: Path, laser_model: Path) -> None:
    """Of another command, whose files would go."""
    succeeds("label", f"model={laser_model}", f"log={log}", "out=d")
    line = refused("classify", f"model={laser_model}", "log=d/annotated.mcap", "out=d", FORCE)
    assert line.startswith("out=d holds annotated.mcap, which log=d/annotated.mcap reads")


@pytest.mark.parametrize("command", ["classify", "label"])
def test_the_model(tmp_path: Path, log: Path, laser_model: Path, command: str) -> None:
    shutil.copytree(laser_model, "model")
    Path("link").symlink_to("model")
    for out in ("model", "link"):
        line = refused(command, "model=model", f"log={log}", f"out={out}", FORCE)
        assert line == f"out={out} is what model=model reads: give another out="


def test_the_feature_cache(log: Path) -> None:
    Path("kept").mkdir()
    words = ["cue=laser", "integrator=none", f"log={log}", "cache.folder=kept"]
    assert refused("train", *words, "out=kept", FORCE).startswith("out=kept is what cache.folder=k")


def test_a_folder_that_is_read_takes_new_files_alone() -> None:
    Path("office").mkdir()
    picture = np.full((20, 20, 3), 99, np.uint8)
    for number in range(3):
        cv2.imwrite(f"office/{number}.png", picture)
    words = ["convert", "source=image_folder", "source.path=.", "out=office/new.mcap"]
    succeeds(*words)
    line = refused(*words, FORCE)
    assert line.startswith("out=office/new.mcap is there already and lies in source.path=., which")


def test_the_writer_refuses_too(log: Path) -> None:
    """Whatever a command writes beside what it has announced."""
    before = log.read_bytes()
    config = {"log": str(log), "source": {"plugin": "mcap", "path": str(log)}, "out": "new.mcap"}
    with guarded(config, None):
        write_text(Path("other.txt"), "text")
        with pytest.raises(UsageError, match=f"cannot write .*: log={log} reads it"):
            write_text(symbolic_link(log), "text")
    assert log.read_bytes() == before
    write_text(log, "when the command is over, it is a file like any other")


def test_names_are_no_paths(log: Path) -> None:
    """A folder that is called like a plugin or a label is not read."""
    Path("office").mkdir()
    Path("office", "notes.txt").write_text("mine")
    source = {"plugin": "office", "path": str(log), "separator": "/"}
    config = {"source": source, "label_map": {"lab": "office"}, "out": "office", "overwrite": True}
    with guarded(config, []):
        written = write_text(Path("office", "new.txt"), "text")
    assert written.read_text() == "text"
