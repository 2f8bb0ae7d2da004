"""``unknown.false_accept_rate``, from the command line to beliefs, scores and the map."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from command_line import Told, placecue, succeeds
from placecue import LaserScan, Observation
from placecue.components.manager import load_plugins
from placecue.storage.model import load_model
from results import check_metrics, messages, rows
from rooms import ANGLES, RANGE_MAX, ROOMS, SECOND, START, Rooms, write_log

REGISTRY = load_plugins(built_ins_only=True).registry
LASER = ["cue=laser", "integrator=none", "cues.laser.classifier.search=null"]
RATE = "unknown.false_accept_rate"


@pytest.fixture(scope="module")
def noisy(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two logs in which every fifth scan is of the next room, so that no model can be right."""
    folder = tmp_path_factory.mktemp("noisy")
    logs = []
    for seed in (0, 1):
        walk = list(Rooms(rounds=4, seed=seed))
        mixed = [
            each if i % 5 else each.relabelled(walk[(i + 12) % len(walk)].label)
            for i, each in enumerate(walk)
        ]
        logs.append(write_log(folder / f"{seed}.mcap", mixed))
    return logs


@pytest.fixture(scope="module")
def careful(noisy: list[Path], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Told]:
    """A model that accepts one wrong decision in ten, and what training told."""
    out = tmp_path_factory.mktemp("careful") / "model"
    return out, succeeds("train", *LASER, f"log={noisy[0]}", f"out={out}", f"{RATE}=0.1")


def test_training_tells_the_threshold_and_its_rates(careful: tuple[Path, Told]) -> None:
    model, told = careful
    found = load_model(model, REGISTRY).rejection_
    assert found is not None
    assert found.n_wrong + found.n_right == Rooms(rounds=4).count()
    [line] = [line for line in told.out.splitlines() if line.startswith("unknown: ")]
    assert line == (
        f"unknown: below a confidence of {found.threshold:.3g}; on held-out samples this keeps "
        f"{100 * found.accept_rate:.1f} % of the {found.n_right} right decisions and accepts "
        f"{100 * found.false_accept_rate:.1f} % of the {found.n_wrong} wrong ones"
    )
    assert 0.1 - 1 / found.n_wrong <= found.false_accept_rate <= 0.1


def test_classify(tmp_path: Path, careful: tuple[Path, Told], noisy: list[Path]) -> None:
    model, _ = careful
    out = tmp_path / "out"
    told = succeeds("classify", f"model={model}", f"log={noisy[1]}", f"out={out}")
    table = rows(out / "beliefs.csv")
    threshold = json.loads((model / "state.json").read_text())["rejection"]["threshold"]
    for row in table:
        assert (row["label"] == "unknown") == (float(row["confidence"]) < threshold)
    labels = Counter(row["label"] for row in table)
    assert set(labels) == {*ROOMS, "unknown"}
    check_metrics(out)
    metrics = json.loads((out / "metrics.json").read_text())["methods"]["integrated"]
    assert metrics["unknown"] == labels["unknown"] / len(table)
    named = [row for row in table if row["label"] != "unknown"]
    right = sum(row["label"] == row["truth"] for row in named) / len(named)
    assert metrics["accuracy_of_named"] == right
    assert (
        f"unknown: {100 * metrics['unknown']:.1f} % of all; of the others {100 * right:.1f} % are "
        "right"
    ) in told.out
    head, *lines = told.out.splitlines()
    assert head.split()[-2:] == ["unknown", "(%)"]
    for line in lines[: len(ROOMS)]:
        name, *_, unknown = line.split()
        of_class = [row["label"] for row in table if row["truth"] == name]
        assert unknown == f"{100 * of_class.count('unknown') / len(of_class):.1f}"
    beliefs = messages(out / "beliefs.mcap", "/placecue/belief")
    assert [each["label"] for each in beliefs] == [row["label"] for row in table]


def test_label(tmp_path: Path, careful: tuple[Path, Told], noisy: list[Path]) -> None:
    model, _ = careful
    out = tmp_path / "out"
    told = succeeds("label", f"model={model}", f"log={noisy[1]}", f"out={out}")
    assert "unknown (%)" in told.out
    areas = json.loads((out / "semantic_map.json").read_text())["areas"]
    assert {area["label"] for area in areas} & set(ROOMS)
    assert {row["label"] for row in rows(out / "beliefs.csv")} == {*ROOMS, "unknown"}
    check_metrics(out)


def test_a_place_never_trained_on(tmp_path: Path, careful: tuple[Path, Told]) -> None:
    model, _ = careful
    far = LaserScan(ANGLES, np.full(ANGLES.size, 25.0), 0.05, RANGE_MAX)
    hall = [Observation(START + number * SECOND, scan=far, label="hall") for number in range(20)]
    log = write_log(tmp_path / "hall.mcap", hall)
    succeeds("classify", f"model={model}", f"log={log}", f"out={tmp_path / 'out'}")
    assert {row["label"] for row in rows(tmp_path / "out" / "beliefs.csv")} == {"unknown"}


def test_without_it_nothing_is_said_of_unknown(
    tmp_path: Path, laser_model: Path, log_b: Path
) -> None:
    told = succeeds("classify", f"model={laser_model}", f"log={log_b}", f"out={tmp_path / 'o'}")
    assert "unknown" not in told.out


@pytest.mark.parametrize(
    ("word", "rate"),
    [(f"{RATE}=0.2", 0.2), ("unknown={false_accept_rate:0.2}", 0.2), ("unknown=null", None)],
)
def test_every_way_to_write_it(tmp_path: Path, log_a: Path, word: str, rate: float | None) -> None:
    out = tmp_path / "m"
    succeeds("train", *LASER, f"log={log_a}", f"out={out}", word)
    unknown = load_model(out, REGISTRY).unknown
    assert (None if unknown is None else unknown.false_accept_rate) == rate


@pytest.mark.parametrize(
    ("word", "said"),
    [
        (f"{RATE}=2", "false_accept_rate must be from 0 to 1, got 2"),
        (f"{RATE}=few", "unknown: false_accept_rate must be a number, got 'few'"),
        ("unknown=0.05", "unknown must be a mapping with 'false_accept_rate', or null, got 0.05"),
        ("unknown.rate=0.1", "there is no 'rate' in unknown; available: false_accept_rate"),
        ("+unknown.rate=0.1", "unknown has no parameter 'rate'; available: false_accept_rate"),
    ],
)
def test_a_wrong_value_is_answered_in_one_line(log_a: Path, word: str, said: str) -> None:
    told = placecue("train", *LASER, f"log={log_a}", "out=out", word)
    assert told.status == 2
    assert said in told.line


def test_a_class_called_unknown(tmp_path: Path) -> None:
    walk = [each.relabelled("unknown") if each.label == "lab" else each for each in Rooms()]
    log = write_log(tmp_path / "log.mcap", walk)
    words = ["train", *LASER, f"log={log}", f"out={tmp_path / 'm'}"]
    told = placecue(*words, f"{RATE}=0.1")
    assert told.status == 1
    assert "there are samples of a class called 'unknown'" in told.line
    succeeds(*words, f"{RATE}=0.1", "label_map={unknown: null}")
    succeeds(*words, "overwrite=true")
