"""What changes from recording to recording, and what does not."""

from __future__ import annotations

import json
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from placecue_office import atlas
from placecue_office.arrange import rescattered
from placecue_office.atlas import AtlasBuilder
from placecue_office.camera import blurred
from placecue_office.clutter import Clutter
from placecue_office.floor import Floor, dense
from placecue_office.plan import Furniture, Plan
from placecue_office.plan_file import PLANS, read_plan
from placecue_office.simulator import Office
from placecue_office.world import Life

LIGHTS = ("cloudy", "night", "sunny")


@cache
def plan_of(run: int) -> Plan:
    return Office(run=run).built.plan


def centre(item: Furniture) -> np.ndarray:
    return item.outline.mean(axis=0)


def test_runs_close_in_time_share_furniture_and_posters() -> None:
    for one, two in ((1, 2), (3, 4)):
        for a, b in zip(plan_of(one).panels, plan_of(two).panels, strict=True):
            assert (a.line.tolist(), a.key, a.material) == (b.line.tolist(), b.key, b.material)
        for a, b in zip(plan_of(one).furniture, plan_of(two).furniture, strict=True):
            np.testing.assert_array_equal(a.outline, b.outline)
            assert (a.key, a.material) == (b.key, b.material)


def test_half_a_year_shifts_some_furniture_and_exchanges_some() -> None:
    before, after = plan_of(1), plan_of(3)
    pairs = list(zip(before.furniture, after.furniture, strict=True))
    standing = [(a, b) for a, b in pairs if a.bottom == 0 and not a.moves]
    steps = [float(np.linalg.norm(centre(a) - centre(b))) for a, b in standing]
    shifted = [step for step in steps if step > 0]
    assert 0.4 * len(standing) < len(shifted) <= round(0.65 * len(standing))
    assert all(0.3 <= step <= 0.75 for step in shifted)
    assert 0.5 < np.mean([a.key != b.key for a, b in pairs]) < 0.9
    hung = [a.key != b.key for a, b in zip(before.panels, after.panels, strict=True)]
    assert 0.5 < np.mean(hung) < 1
    assert all(a.key == b.key for a, b in zip(before.panels, after.panels, strict=True) if a.window)


@cache
def clutter_of(run: int, light: str = "cloudy") -> dict[int, tuple[float, ...]]:
    """Return where things of the clutter stand, by key."""
    blocks = Office(run=run, illumination=light).built.blocks
    return {
        block.key: tuple(block.outline.mean(axis=0).round(6))
        for block in blocks
        if 30_000 <= block.key < 40_000
    }


def unmoved(one: dict[int, tuple[float, ...]], two: dict[int, tuple[float, ...]]) -> float:
    return float(np.mean([one[key] == two[key] for key in one]))


def test_a_part_of_the_small_things_is_put_elsewhere_in_each_recording() -> None:
    recordings = {(run, light): clutter_of(run, light) for run in (1, 2) for light in LIGHTS}
    assert all(set(each) == set(recordings[1, "cloudy"]) for each in recordings.values())
    assert len(recordings[1, "cloudy"]) == 15
    # 5 of 15: of a pair (2/3)**2 stay; from light to light 4 more: (11/15)**2 of these.
    close = [unmoved(recordings[1, light], recordings[2, light]) for light in LIGHTS]
    weeks = [
        unmoved(recordings[run, one], recordings[run, two])
        for run in (1, 2)
        for one, two in combinations(LIGHTS, 2)
    ]
    assert 0.3 <= np.mean(close) <= 0.6
    assert 0.1 <= np.mean(weeks) < np.mean(close) - 0.05


def test_drives_that_end_alike_are_recorded_close_together() -> None:
    one, close, weeks = (
        Office(drive=number, illumination="night").built._of_this_time[2] for number in (3, 13, 4)
    )
    places = [[item.outline.tolist() for item in things] for things in (one, close, weeks)]
    assert places[0] == places[1]
    assert places[0] != places[2]


def test_half_a_year_brings_boxes() -> None:
    new = [key for key in clutter_of(3) if key >= 31_000]
    assert 5 <= len(new) <= Life().added  # as many as there is room for
    assert len(clutter_of(3)) == 15 + len(new)


def test_the_drawn_building_is_had_without_clutter_and_people() -> None:
    office = Office(clutter=0, walkers=0, seated=0.0)
    assert not [block for block in office.built.blocks if 30_000 <= block.key < 50_000]


def test_nothing_is_put_where_the_way_is_or_into_a_wall() -> None:
    plan = read_plan(PLANS / "idol2_floor.geojson")
    floor = Floor(plan, dense(plan.tour), 0.4)
    rng = np.random.default_rng(5)
    things = Clutter().scattered(floor, 40, rng)
    assert len(things) == 40
    for thing in rescattered(things, 0.5, Clutter(), floor, rng):
        rooms = plan.room_at(thing.outline)
        assert (rooms == rooms[0]).all()
        assert rooms[0] >= 0
        corners = np.linalg.norm(dense(plan.tour)[:, None] - thing.outline[None], axis=2)
        assert corners.min() > 0.4 - 0.05
        sides = np.linalg.norm(np.diff(thing.outline, axis=0), axis=1)
        assert sides.min() > 0.119
        assert sides.max() < 0.501
        assert 0.35 <= thing.top <= 1.1


def test_what_a_picture_shows_does_not_depend_on_what_else_is_drawn() -> None:
    alone, second = AtlasBuilder(3), AtlasBuilder(3)
    second.look("bookshelf #805030", 1.0, 2.0, key=9)
    second.look("wood #906030", 1.0, 1.0)
    for builder in (alone, second):
        atlas._picture.cache_clear()
        builder.look("poster #c0c0c0", 0.7, 0.9, key=4, face=1)
    texels, starts, _, _ = alone.pack()
    others, begins, _, _ = second.pack()
    np.testing.assert_array_equal(texels, others[begins[-1, 0] :])
    assert starts[0, 0] == 0


# people


@pytest.mark.parametrize("run", [1, 4])
def test_walkers_keep_away_from_the_robot_and_are_seen_by_the_laser(run: int) -> None:
    office, empty = (Office(run=run, walkers=count) for count in (4, 0))
    scans = [(a.scan, b.scan) for a, b in zip(office, empty, strict=True)]
    shorter = [
        (a.ranges < b.ranges - 0.1).sum() for a, b in scans if a is not None and b is not None
    ]
    assert sum(count > 0 for count in shorter) > 10
    nearest = min(float(a.ranges.min()) for a, _ in scans if a is not None)
    bare = min(float(b.ranges.min()) for _, b in scans if b is not None)
    assert nearest > min(bare, 0.3) - 0.05


def test_people_sit_on_chairs() -> None:
    def high(share: float) -> int:
        office = Office(seated=share, clutter=0, walkers=0)
        return sum(block.key == 40_000 for block in office.built.blocks)

    assert high(0.0) == 0
    assert high(1.0) > high(0.3) > 0
    assert high(1.0) % 5 == 0  # two legs, a lap, a body, a head


# camera


def test_a_smear_keeps_the_light_and_is_as_long_as_asked() -> None:
    light = np.zeros((3, 41, 3), dtype=np.float32)
    light[1, 20] = 1.0
    for streak in (2.5, 7.0):
        smeared = blurred(light, streak)
        assert smeared.sum() == pytest.approx(3.0)
        row = smeared[1, :, 0]
        assert row.max() == pytest.approx(1 / streak)
        assert row.sum() / row.max() == pytest.approx(streak)
        assert smeared[0].max() == 0
    np.testing.assert_array_equal(blurred(light, 0.5), light)


def feature(geometry: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    return {"properties": properties, "geometry": {"type": geometry, "coordinates": coordinates}}


@pytest.fixture
def world(tmp_path: Path) -> str:
    """A room with a window that the robot drives away from, and turns back to."""
    room = {"kind": "room", "label": "a", "floor": "tiles", "wall": "tiles", "ceiling": "ceiling"}
    corners = [[0, 0], [8, 0], [8, 4], [0, 4], [0, 0]]
    tour = [[6, 1], [2, 1], [1.2, 2], [2, 3], [6, 3]]
    glass = {"kind": "window", "z": [0.5, 2.5], "material": "window #d8e2ea"}
    features = [
        feature("Polygon", [corners], **room),
        feature("LineString", corners, kind="wall", thickness=0.1),
        feature("LineString", [[7.9, 0.5], [7.9, 3.5]], **glass),
        feature("LineString", tour, kind="tour"),
    ]
    path = tmp_path / "one_room.geojson"
    path.write_text(json.dumps({"name": "one room", "features": features}))
    return str(path)


def test_a_turning_robot_smears_upright_edges(world: str) -> None:
    sharp, smeared = (
        Office(world=world, width=160, height=120, walkers=0, shutter=shutter)
        for shutter in (0.0, 0.03)
    )
    turning = np.abs(np.diff(sharp.true_poses[:, 2]))
    row = int(turning.argmax())
    one, two = (np.asarray(list(each)[row].image, dtype=float) for each in (sharp, smeared))
    steps = [np.abs(np.diff(image, axis=1)).mean() for image in (one, two)]
    assert steps[1] < 0.8 * steps[0]


def test_the_exposure_lags_and_does_not_depend_on_the_order_of_looking(world: str) -> None:
    rows = list(range(5, 65))

    def exposures(lag: float, rows: list[int]) -> dict[int, float]:
        office = Office(world=world, width=64, height=48, exposure_lag=lag, speed=0.5)
        return {row: office.exposure(row) for row in rows}

    lagging, prompt = exposures(1.0, rows), exposures(0.0, rows)
    assert lagging == exposures(1.0, rows[::-1])
    changes = [np.abs(np.diff(list(each.values()))).max() for each in (lagging, prompt)]
    assert changes[0] < 0.7 * changes[1]
    assert np.ptp(list(lagging.values())) <= np.ptp(list(prompt.values()))
