"""``placecue cache``, and commands that run over the same log again."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from command_line import placecue, succeeds
from placecue_cues.crfh import CRFH
from placecue_cues.laser import LaserGeometry

UNSEARCHED = "cues.laser.classifier.search=null"
LASER = ["cue=laser", "integrator=none", UNSEARCHED]
TRAIN = [
    *("cue=[crfh,laser]", "integrator=svm_das", UNSEARCHED),
    *("cues.crfh.classifier.search=null", "integrator.classifier.search=null"),
]


def broken(self: object, *_: object) -> None:
    raise AssertionError("extracted again")


@pytest.fixture
def trained(log_a: Path, log_b: Path, tmp_path: Path) -> Path:
    """A folder where one log was trained on and another classified, with a cache of its own."""
    succeeds("train", *TRAIN, f"log={log_a}", "out=model", "cache.folder=kept")
    succeeds("classify", "model=model", f"log={log_b}", "out=first", "cache.folder=kept")
    return tmp_path


def test_a_second_run_extracts_nothing_and_says_the_same(
    trained: Path, log_a: Path, log_b: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for cue in (CRFH, LaserGeometry):
        monkeypatch.setattr(cue, "extract", broken)
    monkeypatch.setattr(LaserGeometry, "transform", broken)
    kept = "cache.folder=kept"
    succeeds("train", *TRAIN, f"log={log_a}", "out=again", kept)
    succeeds("classify", "model=again", f"log={log_b}", "out=second", kept)
    succeeds("label", "model=again", f"log={log_b}", "out=third", kept)
    first, second = (Path(name, "beliefs.csv").read_bytes() for name in ("first", "second"))
    assert first == second


def test_shows_what_is_kept(trained: Path, log_a: Path) -> None:
    more = [*LASER, "cues.laser.scales=[0.8,1]"]
    succeeds("train", *more, f"log={log_a}", "out=scaled", "cache.folder=kept")
    shown = succeeds("cache", "cache.folder=kept").out.splitlines()
    rows = [line.split() for line in shown]
    assert rows[0] == ["log", "cue,", "version", "samples", "MB", "last", "used", "parameters"]
    assert {tuple(row[:3]) for row in rows[1:-1] if row[2] in "12"} >= {
        ("a.mcap", "crfh", "1"),
        ("b.mcap", "crfh", "1"),
        ("a.mcap", "laser", "2"),
        ("b.mcap", "laser", "2"),
    }
    assert sum("scaled by 0.8" in line and "scales=[0.8, 1]" in line for line in shown) == 1
    assert sum("96" in row for row in rows) == len(rows) - 2
    assert shown[-1].startswith("kept: ")


def test_what_was_learned_fold_by_fold_is_one_line(tmp_path: Path, log_a: Path) -> None:
    words = ["cue=bag_of_words", "integrator=none", "cues.bag_of_words.words=8"]
    words += ["cues.bag_of_words.classifier.search.C=[1]"]
    succeeds("train", *words, f"log={log_a}", "out=words", "cache.folder=kept")
    shown = [line.split() for line in succeeds("cache", "cache.folder=kept").out.splitlines()]
    times = str(len(list(Path("kept", "learned").iterdir())))
    assert int(times) > 3  # all samples, and the folds
    features = ["a.mcap", "bag_of_words", "1", times, "x", "96"]
    learned = ["bag_of_words", "1,", "what", "it", "learned", times, "x"]
    assert sorted(row[:-4] for row in shown[1:-1]) == sorted([features, learned])
    assert all(row[-2:] == ["descriptors=dense_sift,", "words=8"] for row in shown[1:-1])


def test_trims_on_request(trained: Path) -> None:
    told = succeeds("cache", "cache.folder=kept", "unused_days=1").out.splitlines()
    assert told[0] == "removed 0.0 MB"
    assert len(told) == 7
    told = succeeds("cache", "cache.folder=kept", "trim_to=0").out.splitlines()
    assert told[0].startswith("removed ")
    assert told[1] == "kept: 0.0 MB"
    assert not list(Path("kept").rglob("*.npz"))


def test_the_default_place_is_the_user_s_and_null_is_none(
    log_a: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PLACECUE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    laser = [*LASER, f"log={log_a}"]
    succeeds("train", *laser, "out=model", "cache.folder=null")
    assert not (tmp_path / "xdg" / "placecue").exists()
    succeeds("train", *laser, "out=model", "overwrite=true")
    assert list((tmp_path / "xdg" / "placecue").rglob("*.npz"))
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    told = succeeds("cache")
    assert told.out == f"{tmp_path}/home/.cache/placecue: 0.0 MB\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["trim_to=-1"], "trim_to must be a number of at least 0, or null, got -1"),
        (["unused_days=soon"], "unused_days must be a number of at least 0, or null, got 'soon'"),
        (["cache.folder=null"], "there is no cache to look at: give cache.folder=PATH"),
        (["cache.folder=[a]"], "cache.folder must be a path or null, got ['a']"),
    ],
)
def test_refused(words: list[str], said: str) -> None:
    told = placecue("cache", *words)
    assert told.status == 2
    assert said in told.line


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("cache.max_size=-1", "cache.max_size must be a number of at least 0, or null, got -1"),
        ("cache.max_size=big", "cache.max_size must be a number of at least 0, or null, got 'big'"),
        ("cache=5", "cache must be a mapping with 'folder', or null, got 5"),
    ],
)
def test_settings_that_cannot_be(word: str, said: str, log_a: Path) -> None:
    for told in (
        placecue("train", "cue=laser", "integrator=none", f"log={log_a}", word),
        placecue("cache", word),
    ):
        assert (told.status, told.line.split(": ")[-1]) == (2, said.split(": ")[-1])


def test_no_cache_at_all(log_a: Path) -> None:
    succeeds("train", *LASER, f"log={log_a}", "cache=null", "out=model")
    assert (Path("model") / "manifest.json").exists()
    assert not list(Path(os.environ["PLACECUE_CACHE"]).iterdir())
