"""Words of the command line stay what was typed where they are paths or labels."""

from __future__ import annotations

from pathlib import Path

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import ChoiceSweep

from placecue.commands.label_names import read_names, with_names
from placecue.errors import UsageError
from placecue.labels.relabelled import relabelled
from placecue.observation import Observation
from placecue.words import as_typed
from rooms import Rooms


def value(word: str) -> object:
    return OverridesParser.create().parse_override(as_typed(word)).value()


@pytest.mark.parametrize(
    "path",
    [
        *("2024_01_05", "20240105", "1e5", "007", "true", "nan", "1.50", "0", "a.mcap"),
        *("Büro 1/läuft.mcap", "it's.mcap", "a=b.mcap", "run (1).mcap", "日本/1", "C:\\x\\y"),
        *("a;b", "a&b", "x#y", '"', "'", "\\", "a\\'b", "~/runs", "[ab", "x]"),
    ],
)
@pytest.mark.parametrize("key", ["out", "log", "source.path", "source.labels", "+rooms"])
def test_a_path_stays_what_was_typed(key: str, path: str) -> None:
    assert value(f"{key}={path}") == path


def test_lists_and_sweeps_of_paths() -> None:
    assert value("log=[2024_01_05,b.mcap]") == ["2024_01_05", "b.mcap"]
    assert value("log=[Büro 1.mcap, b.mcap]") == ["Büro 1.mcap", "b.mcap"]
    sweep = value("out=2024_01_05,b")
    assert isinstance(sweep, ChoiceSweep)
    assert [getattr(each, "text", each) for each in sweep.list] == ["2024_01_05", "b"]


@pytest.mark.parametrize(
    "word",
    ["limits.chunk=1_000", "batch=4", "out='2024_01_05'", "cue=[crfh,laser]", "-m", "log=null"],
)
def test_other_words_are_left_alone(word: str) -> None:
    assert as_typed(word) == word


@pytest.mark.parametrize(
    "given",
    ["{Büro 1: office}", '{"Büro 1": office}', "'{\"Büro 1\": office}'", "{'Büro 1': office}"],
)
def test_labels_of_any_letters_are_renamed(given: str) -> None:
    text = value(f"label_map={given}")
    assert isinstance(text, str)
    assert read_names(text) == {"Büro 1": "office"}


def test_a_map_that_hydra_reads_is_left_to_it() -> None:
    assert value("label_map={BO:office,PA:null}") == {"BO": "office", "PA": None}


def test_a_map_of_labels_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "names.yaml"
    path.write_text("\ufeffcorridor: couloir\n厨房: cuisine\nhall: null\n", "utf-8")
    assert read_names(str(path)) == {"corridor": "couloir", "厨房": "cuisine", "hall": None}
    source = relabelled(Rooms(), with_names({"label_map": str(path)}))
    first: Observation = next(iter(source))
    assert first.label is not None


@pytest.mark.parametrize("given", ["{a: [}", "nowhere.yaml"])
def test_what_is_no_map_is_refused(given: str) -> None:
    with pytest.raises(UsageError, match="is no map"):
        read_names(given)
