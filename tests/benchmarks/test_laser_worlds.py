"""What the laser's page rests on: the pairs, the worlds, and what is finished."""

from __future__ import annotations

from collections import Counter
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
SCALE = 20.0


@pytest.fixture
def floors(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("laser_worlds_floor")


@pytest.fixture
def data(floors: ModuleType) -> ModuleType:
    return import_module("laser_worlds_data")


@pytest.fixture
def page(floors: ModuleType) -> ModuleType:
    return import_module("laser_worlds_page")


@pytest.fixture
def floor(floors: ModuleType):
    """Five bare rooms and the corridor's way, with seven boxes along the kitchen's walls."""
    solid = np.ones((660, 280), bool)
    drawn = floors.Floor(solid, ~solid, SCALE, (5.0, 650.0))
    for name in floors.ROOMS:
        solid &= ~drawn.room(name)
    for number in range(7):
        rows, columns = np.nonzero(drawn.room("KT"))
        left, top = columns.min() + 12 * number, rows.min()
        solid[top : top + 8, left : left + 8] = True
    way = np.zeros_like(solid)
    way[:, 115:125] = True
    return floors.Floor(solid, way, SCALE, (5.0, 650.0))


def test_pairs_are_the_paper_s(data: ModuleType) -> None:
    tests = [(train, *test) for train in data.RECORDINGS for test in train.tests()]
    assert len(set(tests)) == 72
    assert Counter(experiment for _, experiment, _ in tests) == {1: 12, 2: 24, 3: 12, 4: 24}
    for train, experiment, test in tests:
        assert (train.light == test.light) == (experiment in (1, 3))
        assert ((train.run > 2) == (test.run > 2)) == (experiment in (1, 2))
    assert all(train.run == test.run for train, experiment, test in tests if experiment == 2)


def test_positions_fall_on_the_cells_that_beams_meet(floor) -> None:
    """A picture's rows go down and y goes up: the two must agree."""
    rows, columns = np.nonzero(~floor.solid)
    centres = np.column_stack([columns - 5.0 + 0.5, 650.0 - rows - 0.5]) / SCALE
    grid = floor.grid(floor.solid)
    assert not grid.occupied[grid.cells(*centres.T)].any()
    assert grid.occupied.sum() == floor.solid.sum()
    np.testing.assert_array_equal(
        floor.pixels(centres).astype(int), np.column_stack([columns, rows])
    )


def test_drawn_furniture_is_found_by_room(floor) -> None:
    found = floor.furniture()
    assert [name for name, _ in found] == ["KT"] * 7
    assert {int(piece.sum()) for _, piece in found} == {64}


def test_nothing_stands_on_the_way_or_in_something_else(floors: ModuleType, floor) -> None:
    world = floors.World(floor, 3)
    (solid, things), (shifted, later) = world._times
    assert (len(things), len(later)) == (15, 17)
    for walls, standing in ((solid, things), (shifted, later)):
        covered = sum(thing.place.astype(int) for thing in standing) + walls
        assert covered.max() == 1
        assert not any((thing.place & floor.way).any() for thing in standing)


def test_what_half_a_year_changes(floors: ModuleType, floor) -> None:
    (solid, things), (shifted, later) = floors.World(floor, 3)._times
    assert sum(a is b for a, b in zip(things, later, strict=False)) == 7  # eight of fifteen moved
    assert [a.sides for a in things] == [b.sides for b in later[:15]]
    assert min(min(thing.sides) for thing in later[15:]) >= 0.35
    # One of seven boxes of 0.4 m went by four to seven cells.
    gone = (solid & ~shifted).sum()
    assert gone == (shifted & ~solid).sum()
    assert 32 <= gone <= 64


def test_recordings_differ_in_few_things_and_come_out_the_same_again(
    floors: ModuleType, floor
) -> None:
    first, again = (floors.World(floor, 3).recorded(0, 1).occupied for _ in range(2))
    np.testing.assert_array_equal(first, again)
    world = floors.World(floor, 3)
    others = [world.recorded(light, run).occupied for light, run in ((0, 2), (1, 1), (0, 3))]
    assert all((first != other).any() for other in others)
    assert (floors.World(floor, 4).recorded(0, 1).occupied != first).any()


def told(recall: float) -> dict[str, object]:
    tests = [
        {"experiment": e, "test": "", "recalls": {"a": recall, "b": 1.0}} for e in (1, 2, 3, 4)
    ]
    return {"chosen": {}, "tests": tests}


def test_a_world_counts_when_all_recordings_are_there(page: ModuleType, tmp_path: Path) -> None:
    results = page.Results(tmp_path / "kept")
    for number, each in enumerate(page.RECORDINGS):
        assert page.in_world(results, 0, "L-AB") == []
        results.keep(page.cell(0, "L-AB", each), 0, [], told(number % 2))
    assert page.in_world(results, 0, "L-AB") == [75.0] * 4
    written = tmp_path / "page.md"
    written.write_text("a\n<!-- table experiments -->\nold\n<!-- end -->\nb\n")
    page.write(written, results, [0, 1], ["L-AB", "L-SVM"])
    assert "| L-AB | 1 | 75.0 | 75.0 | 75.0 | 75.0 |\n<!-- end -->\nb\n" in written.read_text()
    assert "old" not in written.read_text()
