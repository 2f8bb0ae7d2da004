"""``placecue label`` and ``classify`` without a model: the starter."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import Told, placecue, succeeds
from placecue.semantic_map import SemanticMap
from results import rows

PLAN = ["source=floorplan", "source.mode=drive", "source.samples=40", "source.field_of_view=360"]


def by_starter(*words: str) -> Told:
    told = placecue(*words)
    assert told.status == 0, told.err
    return told


@pytest.fixture(scope="module")
def floor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A hallway of 24 m by 2 m with four rooms of 5 m by 5.5 m on a side, 0.05 m a pixel."""
    picture = np.zeros((180, 500), np.uint8)
    picture[130:170, 10:490] = 115  # hallway
    for left in range(10, 490, 120):
        picture[12:122, left : left + 100] = 77  # room
        picture[122:130, left + 40 : left + 58] = 179  # doorway
    path = tmp_path_factory.mktemp("floor") / "floor.png"
    cv2.imwrite(str(path), picture)
    return path


@pytest.fixture(scope="module")
def drive(floor: Path) -> Path:
    """A log of a drive through it."""
    out = floor.with_name("drive.mcap")
    succeeds("convert", *PLAN, f"source.path={floor}", "source.rate=0.5", f"out={out}")
    return out


def test_a_map_from_nothing_but_a_log(tmp_path: Path, drive: Path) -> None:
    told = by_starter("label", f"log={drive}", f"out={tmp_path / 'out'}")
    [line] = [line for line in told.err.splitlines() if "no model=" in line]
    assert "the starter tells corridor, doorway, room by the laser" in line
    assert "placecue train" in line
    semantic_map = SemanticMap.from_json(
        json.loads((tmp_path / "out" / "semantic_map.json").read_text())
    )
    assert semantic_map.classes == ("corridor", "doorway", "room")
    table = rows(tmp_path / "out" / "beliefs.csv")
    # The plan's hallway is told as a corridor, so that the log is scored.
    assert {row["truth"] for row in table} <= {"corridor", "doorway", "room"}
    right = [row["truth"] == row["label"] for row in table if row["truth"] != "doorway"]
    assert sum(right) / len(right) > 0.6
    assert "balanced accuracy" in told.out


def test_a_model_from_the_moments_that_the_starter_is_unsure_of(
    tmp_path: Path, drive: Path
) -> None:
    """No labels, then five, then a model: with what each command says comes next."""
    asked = tmp_path / "asked"
    told = by_starter("suggest", f"log={drive}", "moments=5", f"out={asked}", "report=false")
    [line] = [line for line in told.out.splitlines() if line.startswith("next: ")]
    words = line.removeprefix("next: placecue ").replace("log=FILE", f"log={drive}").split()
    table = asked / "suggestions.csv"
    assert words[:1] == ["train"]
    assert f"source.labels={table}" in words
    head, *moments = table.read_text().splitlines()
    names = ("hallway", "room")
    given = [line.replace(",,", f",{names[n % 2]},", 1) for n, line in enumerate(moments)]
    table.write_text("\n".join([head, *given]) + "\n")
    succeeds(*words[:-1], f"out={tmp_path / 'model'}", "report=false")
    out = tmp_path / "out"
    succeeds("classify", f"model={tmp_path / 'model'}", f"log={drive}", f"out={out}")
    assert {row["label"] for row in rows(out / "beliefs.csv")} <= set(names)


def test_places_of_the_building(tmp_path: Path, drive: Path) -> None:
    out = tmp_path / "out"
    by_starter("classify", f"log={drive}", "places=[corridor,room]", f"out={out}")
    assert {row["label"] for row in rows(out / "beliefs.csv")} <= {"corridor", "room"}


@pytest.mark.parametrize("places", ["castle,corridor", "corridor"])
def test_places_that_cannot_be(tmp_path: Path, drive: Path, places: str) -> None:
    told = placecue("classify", f"log={drive}", f"places=[{places}]", f"out={tmp_path / 'out'}")
    assert told.status == 2
    assert len(told.err.splitlines()) == 1
    assert "castle" in told.err if "castle" in places else "two or more" in told.err
    assert not (tmp_path / "out").exists()


def test_a_model_has_its_own_places(tmp_path: Path, laser_model: Path, drive: Path) -> None:
    words = [f"model={laser_model}", f"log={drive}", "places=[corridor,room]"]
    told = placecue("classify", *words, f"out={tmp_path / 'out'}")
    assert told.status == 2
    assert "leave out places= or model=" in told.err


def test_two_scanners_in_one_log(tmp_path: Path, floor: Path, drive: Path) -> None:
    half = tmp_path / "half.mcap"
    words = ["source.field_of_view=180", f"source.path={floor}", "source.rate=0.5"]
    succeeds("convert", *PLAN, *words, f"out={half}")
    out = tmp_path / "out"
    by_starter("classify", f"log=[{drive},{half}]", f"out={out}")
    assert len(rows(out / "beliefs.csv")) == 80


def test_images_without_what_looks_for_objects(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("placecue.starter.pipeline.find_spec", lambda name: None)
    for name in ("kitchen", "office"):
        (tmp_path / "images" / name).mkdir(parents=True)
        cv2.imwrite(str(tmp_path / "images" / name / "a.png"), np.zeros((20, 30, 3), np.uint8))
    words = ["source=image_folder", f"source.path={tmp_path / 'images'}"]
    told = placecue("classify", *words, f"out={tmp_path / 'out'}")
    assert told.status == 1
    assert "no laser scans" in told.err
    assert "pip install 'placecue[deep]'" in told.err
    assert len(told.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("scanner", "said"),
    [
        ("source.field_of_view=90", "cover 90 degrees"),
        ("source.max_range=3.5", "reach 3.5 m"),
    ],
)
def test_a_scanner_unlike_those_it_is_made_for(
    tmp_path: Path, floor: Path, scanner: str, said: str
) -> None:
    words = ["source=floorplan", f"source.path={floor}", "source.samples=5"]
    told = by_starter("classify", *words, scanner, f"out={tmp_path / 'out'}")
    assert f"the scans {said}" in told.err
    assert "a guess" in told.err
