"""Files of rooms as people's programs write them, and as nobody should."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from placecue.errors import DataError
from placecue.labels.rooms import read_rooms

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]


def rooms(path: Path, *coordinates: Any, before: str = "", shape: str = "Polygon") -> Path:
    features = [
        {
            "type": "Feature",
            "properties": {"class": "hall"},
            "geometry": {"type": shape, "coordinates": each},
        }
        for each in coordinates
    ]
    text = json.dumps({"type": "FeatureCollection", "features": features})
    path.write_text(before + text, "utf-8")
    return path


def test_a_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    path = rooms(tmp_path / "r.geojson", [SQUARE], before="\ufeff")
    assert read_rooms(path).at(1, 1) == "hall"


@pytest.mark.parametrize("shape", ["Polygon", "MultiPolygon"])
def test_an_empty_polygon_is_no_room(tmp_path: Path, shape: str) -> None:
    square = [SQUARE] if shape == "Polygon" else [[SQUARE], []]
    path = rooms(tmp_path / "r.geojson", [], square, shape=shape)
    assert [room.label for room in read_rooms(path).rooms] == ["hall"]


@pytest.mark.parametrize(
    "wrong", [[[[0, 0], [10**400, 0], [4, 4]]], [[[0, 0], [1e308, -1e308], ["x", 0]]], [[7]], [7]]
)
def test_numbers_that_are_none_are_refused_in_one_line(tmp_path: Path, wrong: Any) -> None:
    with pytest.raises(DataError, match="malformed") as raised:
        read_rooms(rooms(tmp_path / "r.geojson", wrong))
    assert len(str(raised.value)) < 400


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 100_000])
def test_brackets_nested_very_deep_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "r.geojson"
    path.write_text(text)
    with pytest.raises(DataError, match=r"nested deeper than limits\.depth=100 allows"):
        read_rooms(path)
