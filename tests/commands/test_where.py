"""``placecue where``: which room a position of a map lies in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from command_line import placecue, succeeds
from placecue import Area, SemanticMap

SURE = {"kitchen": 0.125, "office": 0.875}
TIE = {"kitchen": 0.5, "office": 0.5}
SQUARE = (((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)),)
MAP = SemanticMap(
    (
        Area(
            0,
            "office",
            0.875,
            probabilities=SURE,
            frame="map",
            trajectory=((1.0, 1.0),),
            surface=(SQUARE,),
        ),
        Area(7, "unknown", 0.0, probabilities=TIE, frame="map", trajectory=((9.0, 9.0),)),
    ),
    (),
    (),
    ("kitchen", "office"),
    "map",
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "semantic_map.json").write_text(json.dumps(MAP.to_json()))
    return tmp_path


def test_the_room_and_how_sure(folder: Path) -> None:
    told = succeeds("where", f"map={folder}", "x=0.1", "y=1.9").out
    assert told == "office 87.5 % (area 0): office 87.5 %, kitchen 12.5 %\n"
    told = succeeds("where", f"map={folder / 'semantic_map.json'}", "x=9", "y=9.5").out
    assert told == "unknown (area 7): kitchen 50.0 %, office 50.0 %\n"


def test_as_json(folder: Path) -> None:
    told = succeeds("where", f"map={folder}", "x=1", "y=1", "json=true").out
    assert json.loads(told) == {
        "area": 0,
        "label": "office",
        "confidence": 0.875,
        "probabilities": SURE,
    }


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["x=5", "y=1"], 1, "(5, 1) lies in no area of "),
        (["x=5", "y=1"], 1, "in frame 'map': the robot was between (1.0, 1.0) and (9.0, 9.0)"),
        (["x=9", "y=9.5", "within=0.2"], 1, "(9, 9.5) lies in no area"),
        (["x=left", "y=1"], 2, "x is 'left': give a number of metres, such as x=1.5"),
        (["x=1"], 2, "where needs y=..."),
    ],
)
def test_no_answer_is_said_why(folder: Path, words: list[str], status: int, said: str) -> None:
    told = placecue("where", f"map={folder}", *words)
    assert told.status == status
    assert said in told.err
    assert told.err.count("\n") == 1


@pytest.mark.parametrize(
    ("content", "said"),
    [("{", "is not JSON"), ("[]", "is not a semantic map"), ("{}", "not a semantic map: expected")],
)
def test_what_is_no_map_is_refused(tmp_path: Path, content: str, said: str) -> None:
    (tmp_path / "m.json").write_text(content)
    told = placecue("where", f"map={tmp_path / 'm.json'}", "x=0", "y=0")
    assert (told.status, said in told.err) == (1, True), told.err
    told = placecue("where", f"map={tmp_path / 'none.json'}", "x=0", "y=0")
    assert "cannot read the map" in told.err
