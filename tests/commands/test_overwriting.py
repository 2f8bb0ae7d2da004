"""Results are replaced only where that is asked for, and then nothing older stays beside them."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import placecue, succeeds
from placecue.commands.names import COMMANDS

SEARCH = "cues.laser.classifier.search"
LASER = ["cue=laser", "integrator=none", f"{SEARCH}.C=[1,10]", f"{SEARCH}.gamma=[0.01]"]
FORCE = "overwrite=true"
CLASSIFIED = {"beliefs.csv", "beliefs.mcap", "metrics.json", "report.html"}


def names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def words_for(command: str, log: Path, model: Path) -> list[str]:
    return {
        "train": [*LASER, f"log={log}"],
        "classify": [f"model={model}", f"log={log}"],
        "label": [f"model={model}", f"log={log}"],
        "convert": ["source=mcap", f"log={log}"],
        "annotate": [f"log={log}", "label_map={lab: office}"],
        "info": [f"log={log}"],
        "demo": ["source.samples=4"],
    }[command]


@pytest.mark.parametrize("command", ["train", "classify", "label", "demo"])
def test_a_folder_that_is_not_empty(command: str, log_a: Path, laser_model: Path) -> None:
    Path("out", "sub").mkdir(parents=True)
    for name in ("a.txt", "b.txt", "c.txt", "sub/d.txt"):
        Path("out", name).write_text("mine")
    told = placecue(command, *words_for(command, log_a, laser_model), "out=out")
    assert (told.status, told.out) == (2, "")
    assert told.line == (
        "out=out is not empty (a.txt, b.txt, c.txt, ...): give overwrite=true to replace results, "
        "or another out="
    )
    assert names(Path("out")) == {"a.txt", "b.txt", "c.txt", "sub/d.txt"}


@pytest.mark.parametrize("command", ["convert", "annotate", "info"])
def test_a_file_that_is_there(command: str, log_a: Path) -> None:
    out = Path("way.png" if command == "info" else "b.mcap")
    words = [command, *words_for(command, log_a, log_a), f"out={out}"]
    succeeds(*words)
    first = out.stat().st_ino, out.read_bytes()
    told = placecue(*words)
    assert (told.status, told.out) == (2, "")
    assert told.line == (
        f"out={out} is there already: give overwrite=true to replace it, or another out="
    )
    assert (out.stat().st_ino, out.read_bytes()) == first
    out.write_bytes(b"older")
    succeeds(*words, FORCE)
    assert out.read_bytes() == first[1]


def test_a_dangling_link_is_there(log_a: Path) -> None:
    Path("b.mcap").symlink_to("nowhere")
    told = placecue("convert", "source=mcap", f"log={log_a}", "out=b.mcap")
    assert "out=b.mcap is there already" in told.line


def test_a_device_is_never_replaced(log_a: Path) -> None:
    told = placecue("convert", "source=mcap", f"log={log_a}", "out=/dev/null", FORCE)
    assert (told.status, told.line) == (2, "out=/dev/null is no ordinary file; give another out=")
    assert Path("/dev/null").is_char_device()


def test_every_command_that_writes_can_be_told(log_a: Path) -> None:
    needed = {"convert": ["source=mcap"]}
    for command in COMMANDS:
        shown = succeeds(command, *needed.get(command, []), "--help").out
        assert ("\noverwrite: false\n" in shown) == ("\nout: " in shown)


def test_it_is_true_or_false(log_a: Path) -> None:
    told = placecue("info", f"log={log_a}", "out=way.png", "overwrite=maybe")
    assert (told.status, told.line) == (2, "overwrite must be true or false, got 'maybe'")


def test_nothing_of_another_command_stays(log_a: Path, laser_model: Path) -> None:
    words = [f"model={laser_model}", f"log={log_a}", "out=out"]
    succeeds("label", *words)
    Path("out", "notes.txt").write_text("mine")
    assert "semantic_map.json" in names(Path("out"))
    succeeds("classify", *words, FORCE)
    assert names(Path("out")) == {*CLASSIFIED, "notes.txt"}


def test_nothing_of_another_training_stays(log_a: Path) -> None:
    probability = "cues.laser.classifier.probability=sigmoid"
    succeeds("train", *LASER, f"log={log_a}", "out=out", probability)
    trained = {"arrays.npz", "config.yaml", "manifest.json", "report.html", "state.json"}
    extra = {"reliability.png", "search/laser.md"}
    assert names(Path("out")) - {"search/laser.png"} == trained | extra
    Path("out", "search", "notes.txt").write_text("mine")
    crfh = ["cue=crfh", "integrator=none", "cues.crfh.classifier.search=null"]
    succeeds("train", *crfh, f"log={log_a}", "out=out", FORCE)
    assert names(Path("out")) == {*trained, "search/notes.txt"}


def test_a_model_that_is_overwritten_by_beliefs(log_a: Path, laser_model: Path) -> None:
    succeeds("train", *LASER, f"log={log_a}", "out=out")
    succeeds("classify", f"model={laser_model}", f"log={log_a}", "out=out", FORCE)
    assert names(Path("out")) == CLASSIFIED
    assert not Path("out", "search").exists()


def test_files_that_only_look_like_results_stay(log_a: Path, laser_model: Path) -> None:
    Path("out").mkdir()
    for name in ("config.yaml", "manifest.json", "semantic_map.png"):
        Path("out", name).write_text("{}")
    succeeds("classify", f"model={laser_model}", f"log={log_a}", "out=out", FORCE)
    assert names(Path("out")) == {*CLASSIFIED, "config.yaml", "manifest.json", "semantic_map.png"}


def test_a_run_that_fails_leaves_the_older_one(log_a: Path, laser_model: Path) -> None:
    succeeds("label", f"model={laser_model}", f"log={log_a}", "out=out")
    before = {path: path.read_bytes() for path in Path("out").iterdir()}
    told = placecue("classify", f"model={laser_model}", "log=nope.mcap", "out=out", FORCE)
    assert told.status == 1
    assert {path: path.read_bytes() for path in Path("out").iterdir()} == before


def test_a_run_that_fails_late_leaves_one_run_only(
    log_a: Path, laser_model: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["classify", f"model={laser_model}", "out=out"]
    succeeds(*words, f"log={log_a}")
    monkeypatch.setattr("placecue.commands.classify.write_json", lambda *_: 1 / 0)
    assert placecue(*words, f"log={log_a}", FORCE).status == 1
    assert names(Path("out")) == CLASSIFIED - {"metrics.json", "report.html"}
