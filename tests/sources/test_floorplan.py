from __future__ import annotations

import json
import logging
import os
from collections import Counter
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from placecue.errors import DataError, UsageError
from placecue.observation import Observation
from placecue_sources.floorplan import FloorPlan

DATA = os.environ.get("PLACECUE_DATA")
needs_data = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")

LEGEND = {50: "kitchen", 100: "office", 150: "corridor", 200: "store"}


@pytest.fixture
def plan(tmp_path: Path) -> str:
    """Draw four places of four classes at 0.05 m a pixel, 10 m by 6 m.

    A corridor 2 m wide runs along the lower edge (y from 0.5 to 2.5). Above it, left to right:
    kitchen (x 0.5 to 3.5), office (4 to 7), store (7.5 to 9.5), up to y = 5.5, each with a door
    1 m wide that belongs to the room.
    """
    picture = np.zeros((120, 200), dtype=np.uint8)

    def fill(x: tuple[float, float], y: tuple[float, float], value: int) -> None:
        rows = slice(round((6 - y[1]) * 20), round((6 - y[0]) * 20))
        picture[rows, round(x[0] * 20) : round(x[1] * 20)] = value

    fill((0.5, 9.5), (0.5, 2.5), 150)
    for x, value in (((0.5, 3.5), 50), ((4.0, 7.0), 100), ((7.5, 9.5), 200)):
        fill(x, (3.0, 5.5), value)
        fill((x[0] + 0.5, x[0] + 1.5), (2.5, 3.0), value)
    picture[0, 0] = 77  # a stray value, not in the legend
    path = tmp_path / "floor.png"
    cv2.imwrite(str(path), picture)
    return str(path)


def source(path: str | list[str], **parameters: Any) -> FloorPlan:
    return FloorPlan(path, **{"legend": LEGEND, "samples": 200, **parameters})


def place_at(x: float, y: float) -> str:
    """Return the class by the drawing's own numbers."""
    if y < 2.5:
        return "corridor"
    return "kitchen" if x < 3.75 else "office" if x < 7.25 else "store"


def test_labels_follow_the_position_and_poses_keep_clear(plan: str) -> None:
    for observation in source(plan):
        pose = observation.pose
        assert pose is not None
        assert pose.frame == "map"
        assert observation.label == place_at(pose.x, pose.y)
        in_corridor = 0.75 < pose.x < 9.25 and pose.y > 0.75
        assert in_corridor or pose.y > 3


def test_ranges_are_those_of_the_drawing(plan: str) -> None:
    """In the corridor the wall on the outer side is a straight line at y = 0.5."""
    compared = 0
    for observation in source(plan, noise=0.0, samples=300, field_of_view=360, beams=360):
        pose, scan = observation.pose, observation.scan
        assert pose is not None
        assert scan is not None
        bearings = scan.angles + pose.theta
        if observation.label != "corridor":
            continue
        down = np.cos(bearings + np.pi / 2) > np.cos(np.deg2rad(40))
        ends = pose.x + scan.ranges * np.cos(bearings)
        down &= (ends > 0.6) & (ends < 9.4)
        expected = (pose.y - 0.5) / -np.sin(bearings[down])
        np.testing.assert_allclose(scan.ranges[down], expected, atol=1e-6)
        compared += down.sum()
    assert compared > 1000


def test_the_first_beam_is_on_the_right(plan: str) -> None:
    scan = next(iter(source(plan))).scan
    assert scan is not None
    np.testing.assert_allclose(np.rad2deg(scan.angles), np.linspace(-90, 90, 361))
    around = next(iter(source(plan, field_of_view=360, beams=4))).scan
    assert around is not None
    np.testing.assert_allclose(np.rad2deg(around.angles), [-180, -90, 0, 90])


def test_noise_has_its_deviation(plan: str) -> None:
    pairs = zip(source(plan, noise=0.0), source(plan, noise=0.05), strict=True)
    difference = np.concatenate(
        [b.scan.ranges - a.scan.ranges for a, b in pairs if a.scan and b.scan]
    )
    assert difference.std() == pytest.approx(0.05, rel=0.02)
    assert abs(difference.mean()) < 0.002


def test_what_is_out_of_reach_is_not_measured(plan: str) -> None:
    scans = [observation.scan for observation in source(plan, max_range=1.0, noise=0.0)]
    ranges = np.concatenate([scan.ranges for scan in scans if scan])
    assert np.isinf(ranges).any()
    assert ranges[np.isfinite(ranges)].max() <= 1.0


def same(one: Observation, other: Observation) -> bool:
    assert one.scan is not None
    assert other.scan is not None
    equal = np.array_equal(one.scan.ranges, other.scan.ranges)
    return equal and (one.stamp, one.pose, one.label) == (other.stamp, other.pose, other.label)


@pytest.mark.parametrize("mode", ["random", "drive"])
def test_iterating_again_gives_the_same(plan: str, mode: str) -> None:
    chosen = source(plan, mode=mode, clutter={"office": 0.5})
    first = list(chosen)
    assert all(map(same, first, chosen))
    assert len(first) == chosen.count() == 200
    # More samples begin with the same ones, another seed does not.
    assert all(map(same, first, source(plan, mode=mode, clutter={"office": 0.5}, samples=250)))
    other = source(plan, mode=mode, clutter={"office": 0.5}, seed=1)
    assert not any(map(same, first, other))


def test_stamps_come_at_the_rate(plan: str) -> None:
    stamps = [observation.stamp for observation in source(plan, rate=4.0, samples=3)]
    assert stamps == [250_000_000, 500_000_000, 750_000_000]


def test_balance_by_area_and_by_class(plan: str) -> None:
    # With 0.3 m of clearance: corridor 8.4 x 1.4 m, rooms 2.4 x 1.9 and 1.4 x 1.9 m, and doors.
    areas = {"corridor": 11.76, "kitchen": 4.56, "office": 4.56, "store": 2.66}
    doors = 0.4 * 0.6
    total = sum(areas.values()) + 3 * doors
    counts = Counter(o.label for o in source(plan, samples=4000, beams=2))
    for name, area in areas.items():
        share = (area + (0 if name == "corridor" else doors)) / total
        assert counts[name] / 4000 == pytest.approx(share, abs=0.035)
    counts = Counter(o.label for o in source(plan, samples=402, beams=2, balance="class"))
    assert sorted(counts.values()) == [100, 100, 101, 101]


def test_a_drive_is_one_a_robot_can_drive(plan: str) -> None:
    drive = list(source(plan, mode="drive", samples=1500, beams=2, speed=0.6, rate=5.0))
    poses = np.array([(o.pose.x, o.pose.y, o.pose.theta) for o in drive if o.pose])
    moves = np.diff(poses[:, :2], axis=0)
    steps = np.hypot(*moves.T)
    assert steps.max() <= 0.12 + 1e-9
    assert np.median(steps) > 0.1
    # The robot looks where it goes, and turns on the spot at no more than 1 rad/s.
    moving = steps > 0.05
    ahead = np.arctan2(moves[:, 1], moves[:, 0])[moving] - poses[:-1, 2][moving]
    assert np.mean(np.cos(ahead) > np.cos(np.deg2rad(30))) > 0.97
    turns = np.diff(poses[:, 2])[steps < 1e-9]
    assert turns.size > 0
    assert np.abs(np.angle(np.exp(1j * turns))).max() <= 0.2 + 1e-9
    # It gets everywhere, and keeps clear of the walls of the corridor.
    assert set(Counter(o.label for o in drive)) == set(LEGEND.values())
    assert all(o.label == place_at(o.pose.x, o.pose.y) for o in drive if o.pose)
    assert poses[:, 1].min() > 0.75
    assert poses[:, 0].min() > 0.75
    assert poses[:, 0].max() < 9.25


def test_several_plans_follow_one_another(plan: str, tmp_path: Path) -> None:
    other = tmp_path / "annex.png"
    cv2.imwrite(str(other), np.full((80, 80), 200, dtype=np.uint8))
    both = source([plan, str(other)], samples=10, resolution=[0.05, 0.1])
    seen = list(both)
    assert both.name == "floor+annex"
    assert [o.pose.frame for o in seen if o.pose] == ["floor"] * 10 + ["annex"] * 10
    assert [o.stamp for o in seen] == [k * 200_000_000 for k in range(1, 21)]
    # The annex is 8 m wide at its own resolution.
    assert max(o.pose.x for o in seen[10:] if o.pose) > 4.5


def test_clutter_stands_in_its_class_only(plan: str) -> None:
    def shortest(**parameters: Any) -> dict[str, float]:
        found: dict[str, list[float]] = {}
        for o in source(plan, samples=600, noise=0.0, balance="class", **parameters):
            assert o.scan is not None
            found.setdefault(str(o.label), []).append(float(np.median(o.scan.ranges)))
        return {name: float(np.mean(values)) for name, values in found.items()}

    bare, full = shortest(), shortest(clutter={"office": 2.0}, clutter_sizes=[0.1, 0.4])
    assert full["office"] < 0.8 * bare["office"]
    assert full["kitchen"] == pytest.approx(bare["kitchen"], rel=0.1)


def test_a_class_too_narrow_or_absent_is_said(plan: str, caplog: pytest.LogCaptureFixture) -> None:
    list(source(plan, legend={**LEGEND, 220: "lift"}, samples=5))
    assert "floor has no place of the class lift" in caplog.text
    list(source(plan, clearance=0.97, samples=5))
    assert not [r for r in caplog.records if "nowhere in" in r.message]
    list(source(plan, clearance=1.1, samples=5))
    assert "nowhere in corridor, store is 1.1 m away" in caplog.text


def test_places_behind_a_narrow_door_are_said(plan: str, caplog: pytest.LogCaptureFixture) -> None:
    seen = list(source(plan, mode="drive", clearance=0.6, samples=50))
    assert {o.label for o in seen} == {"corridor"}
    assert "gets into 1 of 4 places" in caplog.text


def geojson(folder: Path, *features: dict[str, Any]) -> str:
    path = folder / "floor.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": list(features)}))
    return str(path)


def room(name: str, *corners: tuple[float, float], hole: Any = None) -> dict[str, Any]:
    rings = [[*corners, corners[0]]] + ([[*hole, hole[0]]] if hole else [])
    shape = {"type": "Polygon", "coordinates": rings}
    return {"type": "Feature", "properties": {"class": name}, "geometry": shape}


def wall(*points: tuple[float, float]) -> dict[str, Any]:
    shape = {"type": "LineString", "coordinates": points}
    return {"type": "Feature", "properties": {"wall": True}, "geometry": shape}


def square(x: float, y: float, w: float, h: float) -> tuple[tuple[float, float], ...]:
    return (x, y), (x + w, y), (x + w, y + h), (x, y + h)


def test_geojson_rooms_doors_holes_and_walls(tmp_path: Path) -> None:
    path = geojson(
        tmp_path,
        room("office", *square(-10, 5, 4, 4)),
        room("kitchen", *square(-5.8, 5, 4, 4), hole=square(-4.3, 6.5, 1, 1)),
        room("door", *square(-6.1, 6, 0.4, 1)),
        room("store", *square(-10, 9, 8, 2)),
        wall((-10, 9), (-6, 9)),
    )
    plan = FloorPlan(path, samples=1500, noise=0.0, clearance=0.15, field_of_view=360, beams=4)
    names = set()
    for o in plan:
        assert o.pose is not None
        assert o.scan is not None
        x, y = o.pose.x, o.pose.y
        names.add(o.label)
        assert not (-4.3 < x < -3.3 and 6.5 < y < 7.5), "a hole is no free space"
        if o.label in ("office", "kitchen"):
            assert (o.label == "office") == (x < -5.8)
        assert (o.label == "store") == (y > 9)
    assert names == {"office", "kitchen", "door", "store"}
    # The wall closes office against store, and kitchen and store are one space.
    upwards = FloorPlan(path, samples=400, noise=0.0, field_of_view=360, beams=721)
    for o in upwards:
        if o.pose is None or o.scan is None or not (-9.5 < o.pose.x < -6.5 and o.pose.y < 8.8):
            continue
        up = np.argmin(np.abs(np.angle(np.exp(1j * (o.scan.angles + o.pose.theta - np.pi / 2)))))
        assert o.scan.ranges[up] == pytest.approx(9 - o.pose.y, abs=0.12)


def test_geojson_property_can_be_named(tmp_path: Path) -> None:
    feature = room("x", *square(0, 0, 4, 4))
    feature["properties"] = {"kind": "hall"}
    path = geojson(tmp_path, feature)
    assert {o.label for o in FloorPlan(path, class_property="kind", samples=5)} == {"hall"}
    with pytest.raises(DataError, match="no polygon with the property 'class'"):
        list(FloorPlan(path, samples=5))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not a GeoJSON"),
        ("[]", "not a GeoJSON"),
        ('{"features": [{"geometry": {"type": "Polygon"}}]}', "malformed"),
        ('{"features": [{"properties": {"class": "a"}, "geometry": {"type": "Polygon", '
         '"coordinates": [[["a", 1], [2, 3]]]}}]}', "malformed"),
        ('{"features": [{"properties": {"class": "a"}, "geometry": {"type": "Polygon", '
         '"coordinates": [[[0, 0], [90000, 0], [90000, 90000]]]}}]}', "are the coordinates metres"),
    ],
)  # fmt: skip
def test_bad_geojson_is_a_data_error(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.geojson"
    path.write_text(text)
    with pytest.raises(DataError, match=message) as caught:
        list(FloorPlan(str(path)))
    assert "\n" not in str(caught.value)


def test_bad_files(plan: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no file"):
        list(source(str(tmp_path / "none.png")))
    text = tmp_path / "text.png"
    text.write_text("no picture")
    with pytest.raises(DataError, match="does not decode"):
        list(source(str(text)))
    with pytest.raises(DataError, match=r"no pixel of a value in the legend \(9\); it has 0, 50"):
        list(source(plan, legend={9: "room"}))


@pytest.mark.parametrize("mode", ["random", "drive"])
def test_clearance_that_leaves_nothing(plan: str, mode: str) -> None:
    with pytest.raises(DataError, match="smaller clearance"):
        list(source(plan, mode=mode, clearance=5.0))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"mode": "drvie"}, "did you mean 'drive'"),
        ({"balance": "none"}, "available: area, class"),
        ({"samples": 0}, "samples is 0; give a whole number of at least 1"),
        ({"beams": "many"}, "whole number"),
        ({"noise": -0.1}, "noise is -0.1"),
        ({"speed": "fast"}, "speed is 'fast'; give a number"),
        ({"resolution": 0}, "resolution is 0"),
        ({"resolution": [0.05, 0.05]}, "2 resolutions for 1 plans"),
        ({"legend": {"grey": "room"}}, "not a grey value"),
        ({"legend": {300: "room"}}, "0 to 255"),
        ({"clutter": {"offic": 1.0}}, "did you mean 'office'"),
        ({"clutter_sizes": [1.0, 0.1]}, "at least 1"),
    ],
)
def test_wrong_parameters_are_usage_errors(
    plan: str, parameters: dict[str, Any], message: str
) -> None:
    with pytest.raises(UsageError, match=message) as caught:
        list(source(plan, **parameters))
    assert "\n" not in str(caught.value)


def test_legend_keys_may_be_words(plan: str) -> None:
    """A command line gives keys as text."""
    worded = source(plan, legend={str(k): v for k, v in LEGEND.items()})
    assert all(map(same, worded, source(plan)))


def test_digest_follows_content_and_parameters(plan: str) -> None:
    digest = source(plan).digest()
    assert digest == source(plan).digest()
    assert digest != source(plan, noise=0.02).digest()
    picture = cv2.imread(plan, cv2.IMREAD_GRAYSCALE)
    picture[30, 30] = 0
    cv2.imwrite(plan, picture)
    assert digest != source(plan).digest()


@needs_data
@pytest.mark.parametrize("mode", ["random", "drive"])
@pytest.mark.parametrize("name", ["Fr52", "Fr101", "intel", "lab_ipa", "lab_d_furniture"])
def test_every_class_of_a_real_map_gets_samples(name: str, mode: str) -> None:
    path = str(Path(str(DATA)) / "maps" / f"{name}.png")
    counts = Counter(o.label for o in FloorPlan(path, mode=mode, samples=1500, beams=2))
    assert set(counts) == {"room", "hallway", "doorway"}
    assert min(counts.values()) >= 10


@needs_data
def test_drives_warn_of_what_they_do_not_reach(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        next(iter(FloorPlan(str(Path(str(DATA)) / "maps" / "intel.png"), mode="drive")))
    assert "gets into 38 of 39 places" in caplog.text
