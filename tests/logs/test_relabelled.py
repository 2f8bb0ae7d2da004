"""Labels from room polygons and label maps, for any source."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.path import Path as Outline

from placecue.errors import DataError, UsageError
from placecue.labels.label_map import LabelMap
from placecue.labels.relabelled import Relabelled, relabelled
from placecue.labels.rooms import Room, Rooms, read_rooms
from placecue.observation import Observation, Pose2D
from placecue.source import Source


class Walk(Source):
    """Positions along x, one a metre, under labels of its own."""

    name = "walk"
    metadata: ClassVar = {"run": "1"}

    def __init__(self, labels: list[str | None], posed: bool = True) -> None:
        self.labels = labels
        self.posed = posed

    def __iter__(self) -> Iterator[Observation]:
        for x, label in enumerate(self.labels):
            pose = Pose2D(float(x), 0.5, 0.0, "map") if self.posed else None
            yield Observation(x, pose=pose, label=label)

    def digest(self) -> str:
        return f"walk {self.labels}"

    def count(self) -> int:
        return len(self.labels)


def square(x: float, y: float, side: float) -> list[list[float]]:
    return [[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]]


def feature(properties: dict[str, Any], kind: str, coordinates: Any) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def geojson(path: Path, *features: dict[str, Any]) -> str:
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return str(path)


corners = st.lists(
    st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=3, max_size=8, unique=True
)


@given(corners, st.floats(-10, 10), st.floats(-10, 10))
def test_a_convex_room_holds_what_matplotlib_says(
    points: list[tuple[float, float]], x: float, y: float
) -> None:
    angles = [np.arctan2(b, a) for a, b in points]
    ring = np.array([(8 * np.cos(t), 5 * np.sin(t)) for t in sorted(angles)])
    inside = Outline(ring).contains_point((x, y), radius=0.0)
    near = min(np.hypot(*(ring - (x, y)).T)) < 1e-6 or abs(_distance(ring, x, y)) < 1e-9
    assert near or Room("a", (ring,)).holds(x, y) == inside


def _distance(ring: np.ndarray, x: float, y: float) -> float:
    """Return the least distance of a point from the lines through the sides."""
    sides = np.roll(ring, -1, axis=0) - ring
    lengths = np.maximum(np.hypot(*sides.T), 1e-12)
    return float(
        np.min(np.abs(sides[:, 0] * (y - ring[:, 1]) - sides[:, 1] * (x - ring[:, 0])) / lengths)
    )


def test_holes_and_overlaps() -> None:
    hall = Room("hall", (np.array(square(0, 0, 10)), np.array(square(4, 4, 2))))
    niche = Room("niche", (np.array(square(1, 1, 1)),))
    rooms = Rooms([hall, niche])
    assert rooms.at(5, 5) is None
    assert rooms.at(3, 3) == "hall"
    assert rooms.at(1.5, 1.5) == "niche"
    assert rooms.at(-1, 5) is None
    assert rooms.classes == ("hall", "niche")


def test_rooms_of_a_file(tmp_path: Path) -> None:
    path = geojson(
        tmp_path / "rooms.geojson",
        feature({"class": "office"}, "Polygon", [square(0, 0, 2.5)]),
        feature({"label": "lab"}, "MultiPolygon", [[square(3, 0, 1)], [square(4, 0, 1)]]),
        feature({"kind": "door"}, "Polygon", [square(0, 0, 9)]),
        feature({"class": "wall"}, "LineString", square(0, 0, 9)),
        {"type": "Feature", "properties": None, "geometry": None},
    )
    source = relabelled(Walk(["x"] * 7), {"rooms": path})
    assert [each.label for each in source] == ["office"] * 3 + ["lab"] * 2 + [None] * 2
    assert (source.name, source.metadata, source.count()) == ("walk", {"run": "1"}, 7)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("{", "not a GeoJSON"),
        ("[]", "not a GeoJSON"),
        ('{"features": [1]}', "not a GeoJSON"),
        ('{"features": []}', "no polygon with the property class or label"),
        (
            '{"features": [{"properties": {"class": "a"}, "geometry": '
            '{"type": "Polygon", "coordinates": [[[0, 0], [1, 1]]]}}]}',
            "fewer than three points",
        ),
    ],
)
def test_rooms_that_make_no_sense(tmp_path: Path, content: str, said: str) -> None:
    path = tmp_path / "rooms.geojson"
    path.write_text(content)
    with pytest.raises(DataError, match=said) as caught:
        read_rooms(path)
    assert "\n" not in str(caught.value)
    with pytest.raises(DataError, match="cannot read the rooms"):
        read_rooms(tmp_path / "nothing")


def test_rooms_drawn_elsewhere_are_told_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    far = feature({"class": "far"}, "Polygon", [square(100, 100, 1)])
    path = geojson(tmp_path / "rooms.geojson", far)
    for source, said in ((Walk(["a"] * 3), "given in map"), (Walk(["a"], posed=False), "missing")):
        caplog.clear()
        mapped = relabelled(source, {"rooms": path})
        assert [each.label for each in mapped] == [None] * len(source.labels)
        list(mapped)
        (record,) = caplog.records
        assert said in record.message


def test_renamed_merged_and_dropped() -> None:
    names = {"BO": "office", "EO": "office", "PA": None}
    old = ["BO", "EO", "PA", "CR", None]
    kept = relabelled(Walk(old), {"label_map": names})
    assert [each.label for each in kept] == ["office", "office", None, "CR", None]
    dropped = relabelled(Walk(old), {"label_map": names, "unmapped_labels": "drop"})
    assert [each.label for each in dropped] == ["office", "office", None, None, None]
    strict = relabelled(Walk(old), {"label_map": names, "unmapped_labels": "error"})
    with pytest.raises(UsageError, match=r"the label 'CR'; .*available: BO, EO, PA"):
        list(strict)


def test_the_map_is_applied_to_rooms_too() -> None:
    rooms = Rooms([Room("1PO1-A", (np.array(square(0, 0, 1)),))])
    (observation,) = Relabelled(Walk([None]), rooms, LabelMap({"1PO1-A": "office"}))
    assert observation.label == "office"


def test_the_digest_says_under_which_labels() -> None:
    walk = Walk(["a"])
    same = [relabelled(walk, {"label_map": {"a": "b"}}).digest() for _ in range(2)]
    other = relabelled(walk, {"label_map": {"a": "c"}}).digest()
    assert same[0] == same[1]
    assert len({same[0], other, walk.digest()}) == 3
    assert relabelled(walk, {"label_map": None, "rooms": None}) is walk


@pytest.mark.parametrize(
    "config",
    [
        {"label_map": ["a"]},
        {"label_map": {"a": [1]}},
        {"label_map": {"a": ""}},
        {"label_map": {"a": "b"}, "unmapped_labels": "keeep"},
    ],
)
def test_maps_that_make_no_sense(config: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="label"):
        relabelled(Walk(["a"]), config)
