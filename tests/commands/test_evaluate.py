"""``placecue evaluate`` and ``placecue report``, end to end over four short logs."""

from __future__ import annotations

import csv
import fcntl
import json
from pathlib import Path

import numpy as np
import pytest

from browser import ran
from command_line import placecue, script, succeeds
from placecue.evaluation.results.store import ResultStore
from rooms import Rooms, write_log

#: One method, for what does not depend on methods.
LASER = ["cue=laser", "integrator=none"]
FEW = ["cues.laser.classifier.search.gamma=[0.01]", "cues.crfh.classifier.search.gamma=[1]"]


@pytest.fixture(scope="module")
def four(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("four")
    return [
        write_log(folder / f"{light}{n}.mcap", Rooms(seed=n, stay=8))
        for n, light in enumerate(("day", "day", "night", "night"))
    ]


def listed(paths: list[Path]) -> str:
    return f"log=[{','.join(map(str, paths))}]"


@pytest.fixture(scope="module")
def evaluated(four: list[Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("evaluated") / "out"
    words = ["cue=[laser,crfh]", "integrator=[gdas]", *FEW, "executor=none"]
    told = succeeds("evaluate", listed(four), *words, f"out={out}", "json=true")
    summary = json.loads(told.out.splitlines()[-1])
    assert (summary["out"], summary["title"]) == (str(out), "3 methods")
    assert summary["results"] == 36
    assert summary["failed"] == 0
    return out


def rows(out: Path) -> list[dict[str, str]]:
    return list(csv.DictReader((out / "results.csv").read_text().splitlines()))


def test_every_ordered_pair_of_every_method_has_a_line(evaluated: Path) -> None:
    found = {(row["method"], row["train"], row["test"]) for row in rows(evaluated)}
    names = ["day0", "day1", "night2", "night3"]
    assert found == {
        (method, train, test)
        for method in ("laser", "crfh", "laser + crfh + gdas")
        for train in names
        for test in names
        if train != test
    }


def test_figures_and_the_page_are_there(evaluated: Path) -> None:
    pictures = {path.name for path in (evaluated / "figures").iterdir()}
    assert {"scores.png", "scores.pdf", "scores.csv", "scores.tex"} <= pictures
    assert (evaluated / "report.html").stat().st_size < 10_000_000


def test_the_page_opens_in_a_browser(evaluated: Path, tmp_path: Path) -> None:
    seen = "return [document.title, document.querySelectorAll('svg').length,"
    seen += " [...document.querySelectorAll('img')].every(i => i.naturalWidth > 0)]"
    (title, pictures, whole), console = ran(evaluated / "report.html", seen, tmp_path)
    assert "3 methods" in title
    assert pictures > 3
    assert whole
    assert not console


def test_started_again_it_computes_nothing(evaluated: Path, four: list[Path]) -> None:
    kept = {path: path.stat().st_mtime_ns for path in evaluated.rglob("*.npz")}
    before = rows(evaluated)
    words = ["cue=[laser,crfh]", "integrator=[gdas]", *FEW, "executor=none"]
    succeeds("evaluate", listed(four), *words, f"out={evaluated}")
    assert {path: path.stat().st_mtime_ns for path in evaluated.rglob("*.npz")} == kept
    assert rows(evaluated) == before


def test_the_report_is_made_again_without_the_logs(evaluated: Path, tmp_path: Path) -> None:
    before = (evaluated / "results.csv").read_bytes()
    (evaluated / "results.csv").unlink()
    succeeds("report", f"out={evaluated}")
    assert (evaluated / "results.csv").read_bytes() == before


def test_runs_are_merged(four: list[Path], tmp_path: Path) -> None:
    words = [*LASER, FEW[0], "executor=none", f"logs={four[0].parent}", "figures=[]"]
    words.append(
        "accumulators={by node: 'accumulator=crf accumulator.same=1', hmm: 'accumulator=hmm'}"
    )
    for light in ("day", "night"):
        pairs = f"pairs={{of {light}: {{same: [light], where: {{light: {light}}}}}}}"
        where = "conditions.pattern='(?P<light>[a-z]+)'"
        succeeds("evaluate", *words, pairs, where, f"out={tmp_path / light}")
    merged = tmp_path / "merged"
    folders = f"merge=[{tmp_path / 'day'},{tmp_path / 'night'}]"
    told = succeeds("report", folders, f"out={merged}")
    assert "of day" in told.out
    assert len(rows(merged)) == 4
    areas = list(csv.DictReader((merged / "areas.csv").read_text().splitlines()))
    assert [(each["experiment"], each["accumulator"], each["pairs"]) for each in areas] == [
        (of, name, "2") for of in ("of day", "of night") for name in ("by node", "hmm")
    ]
    for each in areas:  # the logs have as many samples of each class
        of = [
            float(row["score"]) for row in rows(merged) if row["experiment"] == each["experiment"]
        ]
        assert float(each["single (%)"]) == pytest.approx(50 * sum(of), abs=0.01)
        assert 0 < float(each["way (%)"]) <= 100
    assert "free space (%)" in (merged / "report.html").read_text()
    twice = f"merge=[{tmp_path / 'day'},{tmp_path / 'day'}]"
    assert "that another folder has, too" in placecue("report", twice, f"out={tmp_path / 'x'}").line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([*LASER, "log=[{0},nowhere.mcap]"], "nowhere.mcap"),
        ([*LASER, "log={0}"], "one recording (day0) makes no pair of two"),
        ([*LASER, "log=[{0},{1}]", "pairs={{same: [light]}}"], "asks for 'light'"),
        ([*LASER, "log=[{0},{1}]", "pairs=[[day0,day7]]"], "names a recording 'day7'"),
        ([*LASER, "log=[{0},{1}]", "only=[sift]"], "only: no method 'sift'"),
        ([*LASER, "log=[{0},{1}]", "figures=[{{name: a, kind: pie}}]"], "is of no kind 'pie'"),
        ([*LASER, "log=[{0},{1}]", "figures=bars"], "figures must list mappings"),
        ([*LASER, "log=[{0},{1}]", "paper={{laser: 5}}"], "paper.laser must give percent"),
        ([*LASER, "log=[{0},{1}]", "every=0"], "every"),
        ([*LASER, "log={0}", "pairs=folds", "accumulators=[hmm]"], "label whole recordings"),
        ([*LASER, "log=[{0},{1}]", "accumulators=3"], "accumulators must be a list such as"),
        ([*LASER, "logs=nowhere"], "logs=nowhere is no folder"),
        (["experiment=nothing"], "unknown experiment 'nothing'"),
        ([], "no recordings to evaluate on"),
    ],
)
def test_what_makes_no_sense_is_one_line(
    four: list[Path], tmp_path: Path, words: list[str], said: str
) -> None:
    given = [word.format(*four) for word in words]
    told = placecue("evaluate", *given, f"out={tmp_path / 'out'}", "executor=none")
    assert told.status in (1, 2)
    assert said in told.line


def test_what_is_refused_leaves_an_older_run_as_it_was(evaluated: Path, four: list[Path]) -> None:
    before = (evaluated / "experiment.json").read_bytes()
    for wrong in ("pairs=most", "figures=[{name: a, kind: pie}]"):
        words = [*LASER, wrong, f"out={evaluated}", "executor=none", "overwrite=true"]
        assert placecue("evaluate", listed(four), *words).status == 2
    assert (evaluated / "experiment.json").read_bytes() == before
    assert len(list((evaluated / "results").glob("*.npz"))) == 36


def test_two_runs_do_not_write_into_one_folder(evaluated: Path, four: list[Path]) -> None:
    with (evaluated / ".evaluate.lock").open("a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        told = placecue("evaluate", listed(four), f"out={evaluated}", "executor=none")
    assert "another run is writing into" in told.line


def test_a_method_that_fails_ends_with_status_1_and_the_others_results(
    four: list[Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    words = ["cue=[laser,crfh]", "integrator=[gdas]", *FEW, "executor=none"]
    unequal = "cues.crfh.classifier.multiclass=oao"
    told = placecue("evaluate", listed(four[:2]), *words, unequal, f"out={out}")
    assert told.status == 1
    assert "2 of 6 results could not be made" in told.err
    assert "laser + crfh + gdas" in told.err
    errors = {row["method"]: row["error"] for row in rows(out)}
    assert errors["laser"] == errors["crfh"] == ""
    assert "one_against_one" in errors["laser + crfh + gdas"]
    assert (out / "report.html").is_file()


def test_a_folder_of_something_else_is_not_written_into(four: list[Path], tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    told = placecue("evaluate", listed(four), f"out={tmp_path}", "executor=none")
    assert "is not empty (notes.txt)" in told.line


def test_as_a_process_its_workers_give_the_same_to_the_bit(
    evaluated: Path, four: list[Path], tmp_path: Path
) -> None:
    words = ["cue=[laser,crfh]", "integrator=[gdas]", *FEW, "executor.jobs=2"]
    told = script("evaluate", listed(four[:2]), *words, f"out={tmp_path / 'out'}")
    assert told.status == 0, told.err
    assert len(rows(tmp_path / "out")) == 6
    ours, theirs = ResultStore(tmp_path / "out"), ResultStore(evaluated)
    digests = [path.stem for path in ours.folder.glob("*.npz")]
    assert len(digests) == 6
    for digest in digests:
        found, expected = ours.load(digest), theirs.load(digest)
        np.testing.assert_array_equal(found.decided, expected.decided)
        np.testing.assert_array_equal(found.confidence, expected.confidence)
