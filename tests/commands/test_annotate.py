"""``placecue annotate`` and ``info``, and labels from rooms in every command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from command_line import placecue, succeeds
from placecue.logs import open_log


@pytest.fixture
def rooms(tmp_path: Path) -> Path:
    """Two rooms: left and right of x = 5."""
    path = tmp_path / "rooms.geojson"
    features = [
        {
            "type": "Feature",
            "properties": {"class": name},
            "geometry": {
                "type": "Polygon",
                "coordinates": [[[x, -99], [x + 99, -99], [x + 99, 99], [x, 99], [x, -99]]],
            },
        }
        for name, x in (("west", -94), ("east", 5))
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def side(x: float) -> str:
    return "west" if x < 5 else "east"


def test_rooms_are_written_into_a_copy(log_a: Path, rooms: Path, tmp_path: Path) -> None:
    out = tmp_path / "sub" / "copy.mcap"
    said = succeeds("annotate", f"log={log_a}", f"rooms={rooms}", f"out={out}").out
    assert "on /placecue/label" in said
    before = list(open_log(log_a))
    after = list(open_log(out, label_topic="/placecue/label"))
    assert [each.stamp for each in after] == [each.stamp for each in before]
    assert [each.label for each in after] == [side(e.pose.x) for e in before if e.pose]
    assert [each.label for each in open_log(out, label_topic="/label")] == [
        each.label for each in before
    ]


def test_a_label_map_is_written_into_a_copy(log_a: Path, tmp_path: Path) -> None:
    names = sorted({each.label for each in open_log(log_a) if each.label})
    out = tmp_path / "copy.mcap"
    first = f"label_map={{{names[0]}:null}}"
    succeeds("annotate", f"log={log_a}", first, "unmapped_labels=keep", f"out={out}")
    labels = {each.label for each in open_log(out, label_topic="/placecue/label")}
    assert labels == {None, *names[1:]}


def test_convert_takes_rooms_too(log_a: Path, rooms: Path, tmp_path: Path) -> None:
    out = tmp_path / "b.mcap"
    succeeds(
        "convert",
        "source=mcap",
        f"log={log_a}",
        f"rooms={rooms}",
        "label_map={west:left,east:right}",
        f"out={out}",
    )
    found = list(open_log(out))
    assert {each.label for each in found} <= {"left", "right"}
    assert all(
        each.label == ("left" if each.pose.x < 5 else "right") for each in found if each.pose
    )


def test_info_shows_coverage_and_the_way(log_a: Path, rooms: Path, tmp_path: Path) -> None:
    said = succeeds("info", f"log={log_a}").out
    assert "largest gap (s)" in said
    assert "100.0 % with a label" in said
    assert "the way, " in said
    assert any(0x2800 < ord(letter) < 0x2900 for letter in said)
    said = succeeds("info", f"log={log_a}", f"rooms={rooms}").out
    assert "west: " in said
    far = tmp_path / "far.geojson"
    corners = [[[900, 0], [901, 0], [901, 1], [900, 0]]]
    shape = {"type": "Polygon", "coordinates": corners}
    room = {"type": "Feature", "properties": {"class": "west"}, "geometry": shape}
    far.write_text(json.dumps({"type": "FeatureCollection", "features": [room]}))
    told = placecue("info", f"log={log_a}", f"rooms={far}")
    assert "not one of 96 observations lies in a room; the poses are given in odom" in told.line
    picture = tmp_path / "way.png"
    assert "way.png" in succeeds("info", f"log={log_a}", f"out={picture}").out
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_info_of_several_logs_takes_no_picture(log_a: Path, log_b: Path) -> None:
    assert succeeds("info", f"log=[{log_a},{log_b}]").out.count("observations, ") == 2
    told = placecue("info", f"log=[{log_a},{log_b}]", "out=way.png")
    assert told.status == 2
    assert "takes the way of one log" in told.line


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["out=c.mcap"], 2, "annotate needs labels to write"),
        (["rooms=nothing.geojson", "out=c.mcap"], 1, "cannot read the rooms nothing.geojson"),
        (["rooms={rooms}", "out={log}"], 2, "out={log} is what log={log} reads: give another out="),
        (["rooms={rooms}", "topic=/label", "out=c.mcap"], 2, "has a topic /label already"),
        (
            ["label_map={{none:such}}", "unmapped_labels=drop", "out=c.mcap"],
            1,
            "not one observation",
        ),
        (["label_map=[1]", "out=c.mcap"], 2, "label_map must map old labels to new ones"),
    ],
)
def test_what_cannot_be_annotated(
    log_a: Path, rooms: Path, tmp_path: Path, words: list[str], status: int, said: str
) -> None:
    filled = [word.format(rooms=rooms, log=log_a) for word in words]
    told = placecue("annotate", f"log={log_a}", *filled)
    assert told.status == status
    assert said.format(log=log_a) in told.line
    assert [path.name for path in tmp_path.iterdir()] == ["rooms.geojson"]
