"""The source ``plans``: what it draws is a building, and the same each time."""

from __future__ import annotations

from collections import Counter

import cv2
import numpy as np
import pytest

from placecue import UsageError
from placecue.components.build import build
from placecue.components.manager import load_plugins
from placecue_sources.plan import WALL, Plan
from placecue_sources.plans.drawing import CLASSES
from placecue_sources.plans.rectangle import Rectangle, border
from placecue_sources.plans.source import Plans

REGISTRY = load_plugins(built_ins_only=True).registry
NUMBERS = range(6)


@pytest.fixture(scope="module")
def drawn() -> list[Plan]:
    source = Plans(plans=len(NUMBERS), seed=3)
    return [source.plan(number) for number in NUMBERS]


def share(plan: Plan, label: str) -> float:
    return float((plan.labels == CLASSES.index(label)).sum() / (plan.labels != WALL).sum())


def test_every_plan_has_every_class(drawn: list[Plan]) -> None:
    for plan in drawn:
        assert share(plan, "room") > 0.3, plan.name
        assert share(plan, "corridor") > 0.02, plan.name
        assert 0 < share(plan, "doorway") < 0.2, plan.name


def test_plans_differ(drawn: list[Plan]) -> None:
    sizes = {plan.labels.shape for plan in drawn}
    assert len(sizes) == len(drawn)
    assert len({round(share(plan, "corridor"), 3) for plan in drawn}) == len(drawn)


def test_most_rooms_are_reached_from_a_corridor(drawn: list[Plan]) -> None:
    """From the largest corridor most of the free space can be walked to."""
    reached = []
    for plan in drawn:
        free = (plan.labels != WALL).astype(np.uint8)
        _, parts = cv2.connectedComponents(free, connectivity=4)
        corridors = parts[plan.labels == CLASSES.index("corridor")]
        largest = np.bincount(corridors).argmax()
        reached.append((parts == largest).sum() / free.sum())
    assert np.median(reached) > 0.9


def test_doorways_are_in_walls(drawn: list[Plan]) -> None:
    """Wall within 0.7 m of nearly every cell of a doorway, which is not so of rooms."""
    for plan in drawn:
        near = plan.clearance() < 0.7
        at_door = near[plan.labels == CLASSES.index("doorway")].mean()
        assert at_door > 0.85, plan.name


def test_the_same_seed_gives_the_same_scans() -> None:
    first, again = (list(Plans(plans=1, samples=6, seed=5)) for _ in range(2))
    assert [each.label for each in first] == [each.label for each in again]
    for one, other in zip(first, again, strict=True):
        assert one.scan is not None
        assert other.scan is not None
        np.testing.assert_array_equal(one.scan.ranges, other.scan.ranges)
    assert Plans(seed=5).digest() == Plans(seed=5).digest() != Plans(seed=6).digest()


def test_classes_are_balanced_and_labels_are_those_of_the_pose() -> None:
    source = Plans(plans=2, samples=9, seed=4)
    scans = list(source)
    assert len(scans) == source.count() == 18
    assert Counter(each.label for each in scans) == dict.fromkeys(CLASSES, 6)
    assert len({each.scene for each in scans}) == 2
    for each in scans[:9]:
        assert each.pose is not None
        assert source.plan(0).label_at(each.pose.x, each.pose.y) == each.label


@pytest.mark.parametrize("degrees", [180.0, 270.0, 360.0])
def test_scanners(degrees: float) -> None:
    source = Plans(
        plans=3,
        samples=3,
        seed=2,
        field_of_view=[degrees],
        beams_per_degree=[2, 2],
        max_range=[8.0, 12.0],
        missing=0.2,
    )
    reach, invalid = set(), 0
    for each in source:
        scan = each.scan
        assert scan is not None
        beams = 2 * int(degrees)
        assert scan.ranges.size == beams
        covered = np.ptp(scan.angles) * (beams / (beams - 1) if degrees == 360 else 1)
        assert covered == pytest.approx(np.radians(degrees))
        assert 8 <= scan.range_max <= 12
        reach.add(scan.range_max)
        invalid += int((~scan.valid()).sum())
    assert len(reach) == 3
    assert invalid > 0


def test_built_by_its_name() -> None:
    assert isinstance(build({"plugin": "plans", "plans": 2}, "source", REGISTRY), Plans)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"plans": 0}, "plans is 0"),
        ({"styles": ["castle"]}, "castle.*office"),
        ({"styles": []}, "styles is no list"),
        ({"field_of_view": [400.0]}, "field_of_view is 400"),
        ({"max_range": [10.0, 5.0]}, "the largest max_range is 5"),
        ({"noise": [0.1]}, "give two numbers"),
        ({"missing": 1.5}, "missing is 1.5"),
        ({"resolution": 0}, "resolution is 0"),
    ],
)
def test_wrong_parameters(parameters: dict[str, object], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        next(iter(Plans(**parameters)))  # type: ignore[arg-type]


def test_border() -> None:
    west, east = Rectangle(0, 0, 2, 3), Rectangle(2, 1, 4, 5)
    wall = border(west, east)
    assert wall is not None
    assert (wall.upright, wall.at, wall.start, wall.end) == (True, 2, 1, 3)
    assert border(east, west) is None
    assert border(west, Rectangle(2, 3, 4, 5)) is None
