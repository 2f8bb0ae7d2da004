"""A model goes on learning from a few labels, and says which moments it wants labelled."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from command_line import placecue, succeeds
from placecue.components.manager import load_plugins
from placecue.storage.model import load_model
from placecue.suggesting import choose
from results import rows
from rooms import Rooms, write_log

GIST = ["cue=gist", "integrator=none", "classifier@cues.gist.classifier=nearest_mean"]


@pytest.fixture(scope="module")
def gist_model(shared: Path, log_a: Path) -> Path:
    """Of all rooms but the office."""
    out = shared / "gist"
    succeeds("train", *GIST, "label_map={office: null}", f"log={log_a}", f"out={out}")
    return out


def model_of(folder: Path) -> object:
    registry = load_plugins(built_ins_only=True).registry
    return load_model(folder, registry).cues["gist"].classifier


def test_a_new_place_is_learned_without_the_old_log(
    gist_model: Path, log_a: Path, log_b: Path
) -> None:
    before = (gist_model / "manifest.json").read_bytes()
    words = ["teach", f"model={gist_model}", f"log={log_a}", "out=taught"]
    told = succeeds(*words, "label_map={corridor: null, kitchen: null, lab: null}").out
    assert "learned 24 samples: office 24" in told
    assert "new: office" in told
    assert "of these the model had 24 wrong" in told  # a class that it did not know
    assert (gist_model / "manifest.json").read_bytes() == before
    succeeds("train", *GIST, f"log={log_a}", "out=whole")
    taught, whole = model_of(Path("taught")), model_of(Path("whole"))
    for name in ("classes_", "counts_", "sums_"):
        np.testing.assert_array_equal(getattr(taught, name), getattr(whole, name))
    logs = json.loads(Path("taught", "manifest.json").read_text())["logs"]
    assert [each["name"] for each in logs] == [log_a.name] * 2
    succeeds("classify", "model=taught", f"log={log_b}", "out=c")
    found = [row["label"] for row in rows(Path("c", "beliefs.csv")) if row["truth"] == "office"]
    assert found.count("office") > 18


def test_suggested_moments_are_filled_in_and_given_back(gist_model: Path, tmp_path: Path) -> None:
    log = write_log(tmp_path / "new.mcap", Rooms(seed=3))
    words = [f"model={gist_model}", f"log={log}"]
    told = succeeds("suggest", *words, "moments=8", "out=s")
    assert "8 moments" in told.out
    table = Path("s", "suggestions.csv")
    lines = rows(table)
    assert list(lines[0])[:4] == ["start", "end", "label", "suggested"]
    assert [line["number"] for line in lines] == [str(number) for number in range(1, 9)]
    starts, ends = ([float(line[key]) for line in lines] for key in ("start", "end"))
    assert all(end <= start for end, start in zip(ends, starts[1:], strict=False))
    page = Path("s", "report.html").read_text()
    assert page.count("data:image/jpeg;base64,") == 8

    told = placecue("teach", *words, f"labels={table}", "out=t")
    assert (told.status, told.line) == (
        1,
        f"{table} holds no labels: fill in the column label of a line or more",
    )
    truth = {each.stamp: each.label for each in Rooms(seed=3)}
    for line in lines[:5]:
        middle = (float(line["start"]) + float(line["end"])) / 2
        line["label"] = str(truth[min(truth, key=lambda stamp: abs(stamp - middle * 1e9))])
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(lines[0]))
        writer.writeheader()
        writer.writerows(lines)
    rename = "label_map={office: study}"
    told = succeeds("teach", *words, f"labels={table}", "out=t", rename)
    assert "learned 5 samples" in told.out
    assert "office" not in told.out
    counts = model_of(Path("t")).counts_.sum() - model_of(gist_model).counts_.sum()
    assert counts == 5


def test_moments_of_two_logs_of_one_time_are_told_apart(gist_model: Path, tmp_path: Path) -> None:
    small = [write_log(tmp_path / f"{n}.mcap", Rooms(1, 2, n)) for n in (4, 5)]
    words = [f"model={gist_model}", f"log=[{small[0]},{small[1]}]", "report=false"]
    succeeds("suggest", *words, "moments=99", "out=s")
    found = [(line["start"], line["log"]) for line in rows(Path("s", "suggestions.csv"))]
    assert len(set(found)) == 16
    assert {log for _, log in found} == {"4.mcap", "5.mcap"}


def test_labels_of_times_that_the_log_has_not_are_told(gist_model: Path, tmp_path: Path) -> None:
    log = write_log(tmp_path / "new.mcap", Rooms(1, 2, 6))
    words = ["teach", f"model={gist_model}", f"log={log}", "labels=l.csv", "out=t"]
    Path("l.csv").write_text("start,end,label\n1,2,lab\n1700000000,1700000000.1,lab\n")
    told = placecue(*words)
    assert "learned 1 samples: lab 1" in told.out
    assert told.line == (
        "1 of 2 labels of l.csv are of times at which new.mcap has no observation: they teach "
        "nothing"
    )
    Path("l.csv").write_text("start,end,label\n1700000099,1700000100,lab\n")
    told = placecue(*words, "overwrite=true")
    assert told.status == 1
    assert "the intervals of l.csv never meet the log: they span 1700000099" in told.line


def test_what_is_chosen_is_unsure_and_unlike() -> None:
    # Three heaps of ten; the model is unsure of the last one only, least in its middle.
    generator = np.random.default_rng(0)
    heaps = np.repeat([[10.0, 0], [0, 10], [-10, -10]], 10, axis=0)
    looks = heaps + generator.normal(size=(30, 2)) * 0.1
    confidence = np.concatenate([np.full(20, 0.9), np.linspace(0.5, 0.1, 10)])
    chosen = choose(confidence, looks, 3)
    assert chosen[0] == 29
    assert {row // 10 for row in chosen} == {0, 1, 2}
    assert len(set(choose(confidence, looks, 100))) == len(choose(confidence, looks, 100)) == 30
    assert choose(np.zeros(4), np.ones((4, 2)), 3) == [0]


def test_what_cannot_be_taught_says_so(
    model: Path, laser_model: Path, gist_model: Path, log_b: Path
) -> None:
    told = placecue("teach", f"model={laser_model}", f"log={log_b}", "out=t")
    assert told.status == 2
    assert "the classifier of cue laser (SVM) cannot learn further samples" in told.line
    assert "classifier@cues.laser.classifier=nearest_mean" in told.line
    told = placecue("teach", f"model={model}", f"log={log_b}", "out=t")
    assert told.status == 2
    assert "this model integrates crfh, laser" in told.line
    told = placecue("teach", f"model={gist_model}", f"log={log_b}", f"out={gist_model}")
    assert told.status == 2
    none = "label_map={corridor: null, kitchen: null, lab: null, office: null}"
    told = placecue("teach", f"model={gist_model}", f"log={log_b}", "out=t", none)
    assert told.status == 1
    assert not Path("t", "manifest.json").exists()
    told = placecue("suggest", f"model={gist_model}", f"log={log_b}", "out=s", "moments=0")
    assert (told.status, told.line) == (2, "moments is 0; give a whole number of at least 1")


def test_a_class_that_is_nearly_a_known_one_is_told(gist_model: Path, log_b: Path) -> None:
    told = placecue(
        "teach", f"model={gist_model}", f"log={log_b}", "out=t", "label_map={office: kitchn}"
    )
    assert told.status == 0
    assert "has learned from" not in told.err
    again = placecue("teach", "model=t", f"log={log_b}", "out=u", "label_map={office: kitchn}")
    assert f"the model has learned from {log_b.name} before: its samples count once more" == (
        again.line
    )
    assert "'kitchn' is a new class beside 'kitchen': label_map={kitchn: kitchen}" in told.err
