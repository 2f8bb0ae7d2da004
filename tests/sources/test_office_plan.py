from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.path import Path as Outline

from placecue.errors import DataError
from placecue_office.blocks import furniture_blocks
from placecue_office.plan import Furniture, Plan
from placecue_office.plan_file import PLANS, read_plan
from placecue_office.scene import build_skin
from placecue_office.simulator import Office

FLOOR = PLANS / "idol2_floor.geojson"


@pytest.fixture(scope="module")
def plan() -> Plan:
    return read_plan(FLOOR)


def features(kind: str) -> list[dict[str, Any]]:
    document = json.loads(FLOOR.read_text())
    return [each for each in document["features"] if each["properties"]["kind"] == kind]


def test_rooms_are_found_as_matplotlib_finds_them(plan: Plan) -> None:
    points = np.random.default_rng(1).uniform([-1, 2], [14, 32], (4000, 2))
    rooms = plan.room_at(points)
    for index, feature in enumerate(features("room")):
        inside = Outline(feature["geometry"]["coordinates"][0]).contains_points(points)
        np.testing.assert_array_equal(rooms == index, inside)


def test_labels_follow_the_rule_of_the_data_set(plan: Plan) -> None:
    points = np.random.default_rng(2).uniform([0, 3.5], [12, 30], (4000, 2))
    for (x, y), room in zip(points, plan.room_at(points), strict=True):
        if room < 0:
            continue
        if y < 8.65:
            expected = "printer_area"
        elif x < 5.05:
            expected = "one_person_office" if y > 20 else "two_person_office"
        else:
            expected = "kitchen" if x > 7.5 else "corridor"
        assert plan.rooms[room].label == expected


def test_doorways_are_as_wide_as_the_door_detector_wants(plan: Plan) -> None:
    doors = [each for each in features("door") if each["properties"]["open"]]
    widths = [float(np.ptp(door["geometry"]["coordinates"], axis=0).max()) for door in doors]
    rooms = [width for width in widths if width < 1.2]  # the printer area has no door, but a portal
    assert len(rooms) == 3
    assert all(0.8 <= width - 2 * 0.03 <= 0.95 for width in rooms)


def test_a_table_is_a_slab_on_legs() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    slab, *legs = furniture_blocks(Furniture("table", square, 0.0, 0.73, "wood", "wood", "wood"))
    assert (round(slab.bottom, 6), slab.top) == (0.69, 0.73)
    assert len(legs) == 4
    assert {(round(leg.bottom, 6), round(leg.top, 6)) for leg in legs} == {(0.0, 0.69)}


def write(folder: Path, *changed: dict[str, Any]) -> Path:
    room = {"kind": "room", "label": "a", "floor": "tiles", "wall": "paint", "ceiling": "ceiling"}
    square = [[[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]]
    known = [
        feature("Polygon", square, **room),
        feature("LineString", [[1, 1], [3, 2]], kind="tour"),
    ]
    path = folder / "mine.geojson"
    path.write_text(json.dumps({"name": "mine", "features": [*known, *changed]}))
    return path


def feature(geometry: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    return {"properties": properties, "geometry": {"type": geometry, "coordinates": coordinates}}


def test_a_plan_of_ones_own(tmp_path: Path) -> None:
    plan = read_plan(write(tmp_path))
    assert [room.label for room in plan.rooms] == ["a"]
    assert plan.bounds() == (0.0, 0.0, 4.0, 3.0)


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (feature("LineString", [[0, 0], [1, 0]], kind="wal"), "did you mean 'wall'"),
        (feature("LineString", [[0, 0], [1, 0]], kind="wall"), "lacks 'thickness'"),
    ],
)
def test_a_broken_plan_is_told_in_one_line(
    tmp_path: Path, broken: dict[str, Any], said: str
) -> None:
    with pytest.raises(DataError, match=said) as raised:
        read_plan(write(tmp_path, broken))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("text", ["", "[]", '{"name": "x"}', '{"name": "x", "features": []}'])
def test_what_is_no_plan(tmp_path: Path, text: str) -> None:
    path = tmp_path / "none.geojson"
    path.write_text(text)
    with pytest.raises(DataError, match=r"plan"):
        read_plan(path)


def test_a_wall_across_the_room_leaves_no_way(tmp_path: Path) -> None:
    wall = feature("LineString", [[2, 0], [2, 3]], kind="wall", thickness=0.2)
    with pytest.raises(DataError, match=r"no way from \[[01]\.\d+, [01]\.\d+\] to \[[23]\."):
        Office(world=str(write(tmp_path, wall))).count()
    assert Office(world=str(write(tmp_path))).count() > 3


def test_a_tour_needs_room_and_two_places(tmp_path: Path) -> None:
    world = str(write(tmp_path))
    with pytest.raises(DataError, match="clear of everything"):
        Office(world=world, robot_radius=2.0).count()
    line = '{"type": "LineString", "coordinates": [[1, 1], [3, 2]]}'
    plan = Path(world).read_text()
    assert line in plan
    Path(world).write_text(plan.replace(line, '{"type": "Point", "coordinates": [2, 2]}'))
    with pytest.raises(DataError, match="does not go anywhere"):
        Office(world=world).count()


def test_unknown_furniture_and_material(tmp_path: Path) -> None:
    outline = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    with pytest.raises(DataError, match="did you mean 'table'"):
        furniture_blocks(Furniture("tabel", outline, 0.0, 1.0, "wood", "wood", "wood"))
    blocks = furniture_blocks(Furniture("box", outline, 0.0, 1.0, "wod", "wood", "wood"))
    with pytest.raises(DataError, match="did you mean 'wood'"):
        build_skin(read_plan(write(tmp_path)), blocks, seed=0)
