"""Bad data: one line, exit status 1 where nothing is usable, and nothing half-written."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from command_line import Told, placecue
from mcap_logs import Ros2Log
from placecue import LaserScan, Observation
from placecue.observation import EncodedImage
from results import rows
from rooms import ANGLES, RANGE_MAX, Rooms, write_log

LASER = ["cue=laser", "integrator=none", "cues.laser.classifier.search=null"]
CRFH = ["cue=crfh", "integrator=none", "cues.crfh.classifier.search=null"]
EVERY = 8  # one in so many is spoilt where some are
SPOILT = 96 // EVERY
ENDS = {".json", ".mcap", ".csv", ".npz", ".png", ".part", ".geojson"}


def changed(observation: Observation, **parts: object) -> Observation:
    """Return an observation with some parts replaced."""
    kept = {
        "image": observation.image_source,
        "scan": observation.scan,
        "pose": observation.pose,
        "label": observation.label,
    }
    return Observation(observation.stamp, **{**kept, **parts})  # type: ignore[arg-type]


def no_beams(observation: Observation) -> Observation:
    return changed(observation, scan=LaserScan(ANGLES[:0], np.zeros(0), 0.05, RANGE_MAX))


def all_nan(observation: Observation) -> Observation:
    scan = LaserScan(ANGLES, np.full(ANGLES.size, math.nan), 0.05, RANGE_MAX)
    return changed(observation, scan=scan)


def no_picture(observation: Observation) -> Observation:
    return changed(observation, image=EncodedImage(b"these bytes are no picture", "png"))


SPOIL = [
    (no_beams, "laser_model", LASER, "the laser scan is empty (0 beams)"),
    (all_nan, "laser_model", LASER, "none of the 61 beams of the laser scan is valid (all NaN"),
    (no_picture, "model", CRFH, "does not decode (26 bytes)"),
]


def log_of(folder: Path, change: Callable[[Observation], Observation], every: int = 1) -> str:
    """Write the rooms with every so-manyth observation changed; return the word to type."""
    seen = [change(each) if i % every == 0 else each for i, each in enumerate(Rooms())]
    return f"log={write_log(folder / 'spoilt.mcap', seen)}"


def fails(folder: Path, *words: str) -> str:
    """Return the one line that bad data are answered with; nothing may be left behind."""
    before = set(folder.rglob("*"))
    told = placecue(*words)
    assert told.status == 1, told.err
    assert told.out == ""
    made = set(folder.rglob("*")) - before
    assert all(path.is_dir() for path in made), made
    return told.line


def with_model(trained: str, request: pytest.FixtureRequest) -> list[str]:
    """Return the words that choose a model; one of two cues is to have both."""
    both = ["min_cues=2"] if trained == "model" else []
    return [f"model={request.getfixturevalue(trained)}", *both]


def goes_on(*words: str) -> Told:
    told = placecue(*words)
    assert told.status == 0, told.err
    return told


@pytest.mark.parametrize(("change", "trained", "cue", "said"), SPOIL)
@pytest.mark.parametrize("command", ["train", "label"])
def test_some_are_spoilt(
    tmp_path: Path,
    request: pytest.FixtureRequest,
    command: str,
    change: Callable[[Observation], Observation],
    trained: str,
    cue: list[str],
    said: str,
) -> None:
    words = cue if command == "train" else with_model(trained, request)
    told = goes_on(command, *words, log_of(tmp_path, change, EVERY), "out=out")
    assert told.line.startswith(f"{SPOILT} of 96 observations passed over; the first: ")
    assert said in told.line
    if command == "train":
        assert (tmp_path / "out" / "manifest.json").is_file()
        return
    table = rows(tmp_path / "out" / "beliefs.csv")
    assert len(table) == 96
    assert [row["label"] == "" for row in table] == [i % EVERY == 0 for i in range(96)]
    assert f"not scored: 0 without a label, {SPOILT} unusable" in told.out


@pytest.mark.parametrize(("change", "trained", "cue", "said"), SPOIL)
@pytest.mark.parametrize("command", ["train", "classify"])
def test_all_are_spoilt(
    tmp_path: Path,
    request: pytest.FixtureRequest,
    command: str,
    change: Callable[[Observation], Observation],
    trained: str,
    cue: list[str],
    said: str,
) -> None:
    words = cue if command == "train" else with_model(trained, request)
    line = fails(tmp_path, command, *words, log_of(tmp_path, change), "out=out")
    assert line.startswith("no usable observation: 96 of 96 observations passed over; the first: ")
    assert said in line


def test_spoilt_parts_that_no_cue_needs_do_not_matter(tmp_path: Path, laser_model: Path) -> None:
    told = goes_on("label", f"model={laser_model}", log_of(tmp_path, no_picture), "out=out")
    assert told.err == ""


def test_of_two_cues_the_other_goes_on(tmp_path: Path, model: Path) -> None:
    told = goes_on("classify", f"model={model}", log_of(tmp_path, no_picture), "out=out")
    assert told.line.startswith("cue crfh is missing at 96 of 96 observations, which go on without")
    assert {row["cues"] for row in rows(tmp_path / "out" / "beliefs.csv")} == {"laser"}
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert metrics["cues_missing"] == {"crfh": 96}


def test_without_labels(tmp_path: Path) -> None:
    log = log_of(tmp_path, lambda each: each.relabelled(None))
    line = fails(tmp_path, "train", *LASER, log, "out=out")
    assert line.startswith("none of the 96 observations has a label: training needs a label")


def test_one_class_only(tmp_path: Path) -> None:
    log = log_of(tmp_path, lambda each: each.relabelled("lab"))
    line = fails(tmp_path, "train", *LASER, log, "out=out")
    assert line == "all 96 labelled observations are 'lab': training needs two classes or more"


@pytest.mark.parametrize("cue", [LASER, ["cue=[crfh,laser]"]])
def test_a_class_with_one_sample(tmp_path: Path, cue: list[str]) -> None:
    log = log_of(tmp_path, lambda each: each.relabelled("attic"), 96)
    line = fails(tmp_path, "train", *cue, log, "out=out")
    assert line.startswith("class 'attic' has one sample only;")


COMMANDS = {
    "train": [*LASER, "out=out"],
    "classify": ["out=out"],
    "label": ["out=out"],
    "convert": ["source=mcap", "out=out/b.mcap"],
    "info": [],
}
TEXT = b"hello world, this is text"


@pytest.mark.parametrize(
    ("command", "content", "said"),
    [
        ("train", None, "no such log: "),
        ("train", b"", " is empty (0 bytes): not an MCAP file"),
        ("train", b"SQLite format 3\0" + bytes(50), "give it the ending .db3"),
        *((command, TEXT, "is not an MCAP file (it begins with") for command in COMMANDS),
    ],
)
def test_files_that_are_no_log(
    tmp_path: Path, laser_model: Path, command: str, content: bytes | None, said: str
) -> None:
    path = tmp_path / "a.mcap"
    if content is not None:
        path.write_bytes(content)
    needed = [f"model={laser_model}"] if command in ("classify", "label") else []
    line = fails(tmp_path, command, *COMMANDS[command], *needed, f"log={path}")
    assert said in line
    assert str(path) in line


def long_log(path: Path, count: int = 60) -> bytes:
    """Write scans of two places in small chunks; return the file."""
    log = Ros2Log(path, chunk_size=2000)
    for i in range(count):
        log.string(0.1 * i, "corridor" if i < count // 2 else "office")
        log.odom(0.1 * i, 0.1 * i, 0.0, 0.0)
        log.scan(0.1 * i, [1.0 + i % 7, 2.0, 3.0 + i % 3, 4.0, 5.0])
    log.close()
    return path.read_bytes()


@pytest.mark.parametrize("command", COMMANDS)
def test_a_truncated_log_gives_what_is_readable(
    tmp_path: Path, laser_model: Path, command: str
) -> None:
    path = tmp_path / "cut.mcap"
    whole = long_log(path)
    path.write_bytes(whole[: 3 * len(whole) // 5])
    needed = [f"model={laser_model}"] if command in ("classify", "label") else []
    told = goes_on(command, *COMMANDS[command], *needed, f"log={path}")
    assert str(path) in told.line
    if command == "classify":
        assert 20 < len(rows(tmp_path / "out" / "beliefs.csv")) < 60


def test_a_log_cut_before_its_first_message(tmp_path: Path) -> None:
    path = tmp_path / "cut.mcap"
    path.write_bytes(long_log(path)[:60])
    line = fails(tmp_path, "train", *LASER, f"log={path}", "out=out")
    assert str(path) in line


def test_nothing_to_observe(tmp_path: Path) -> None:
    log = Ros2Log(tmp_path / "words.mcap")
    log.string(0.0, "office")
    line = fails(tmp_path, "train", *LASER, f"log={log.close()}", "out=out")
    assert "words.mcap holds no scan that can be read; its topics: /label" in line


def test_an_earlier_result_survives_a_failure(
    tmp_path: Path, laser_model: Path, log_b: Path
) -> None:
    goes_on("label", f"model={laser_model}", f"log={log_b}", "out=out")
    before = {path: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    log = log_of(tmp_path, all_nan)
    words = ["label", f"model={laser_model}", log, "out=out", "overwrite=true"]
    assert placecue(*words).status == 1
    assert {path: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


@pytest.mark.parametrize("source", ["carmen", "floorplan"])
def test_other_sources_say_which_file_is_missing(tmp_path: Path, source: str) -> None:
    told = placecue("convert", f"source={source}", "source.path=nope.log", "out=a.mcap")
    assert told.status in (1, 2)
    assert "nope.log" in told.line
    assert list(tmp_path.iterdir()) == []


def test_a_carmen_log_of_something_else(tmp_path: Path) -> None:
    path = tmp_path / "letter.log"
    path.write_text("Dear reader,\nthis is no log.\n")
    line = fails(tmp_path, "convert", "source=carmen", f"source.path={path}", "out=a.mcap")
    assert "letter.log" in line


def test_a_plan_without_a_place(tmp_path: Path) -> None:
    path = tmp_path / "black.png"
    path.write_bytes(b"no picture")
    line = fails(tmp_path, "convert", "source=floorplan", f"source.path={path}", "out=a.mcap")
    assert "black.png does not decode" in line
