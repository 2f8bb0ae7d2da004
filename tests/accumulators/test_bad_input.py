"""Logs as they come: without poses, without scans, cut, begun in a doorway, of one observation."""

from functools import partial

import numpy as np
import pytest

from doorways import doorway, scan_at
from placecue import Observation, OneAgainstAll, Pose2D, Scores
from placecue.belief import Belief
from placecue_accumulators.crf import RandomField
from placecue_accumulators.door import Door
from placecue_accumulators.evidence import ChangedEvidence
from placecue_accumulators.hmm import HiddenMarkov
from placecue_accumulators.relaxation import Relaxation
from placecue_accumulators.spatiotemporal import SpatioTemporal

CLASSES = ("corridor", "kitchen", "office", "printer")
LAYOUT = OneAgainstAll(CLASSES)
SECOND = 1_000_000_000
KINDS = [SpatioTemporal, HiddenMarkov, RandomField, Relaxation]


def says(label, margin=0.5):
    values = [margin if name == label else -margin for name in CLASSES]
    return Belief(0, Scores(np.array([values]), LAYOUT), label, 2 * margin, {})


def joined():
    return SpatioTemporal([Door(), ChangedEvidence()], merge="open")


def through(accumulator, xs, label_at, scans=lambda x: True, start=0):
    """Drive along x through a doorway at the origin, 5 observations a second."""
    walls = doorway()
    for i, x in enumerate(xs):
        pose = Pose2D(float(x), 0.0, 0.0)
        scan = scan_at(walls, pose) if scans(x) else None
        seen = Observation((start + i) * SECOND // 5, pose=pose, scan=scan)
        accumulator.update(seen, label_at(x))
    return accumulator.semantic_map()


@pytest.mark.parametrize("kind", KINDS)
def test_without_poses_areas_are_windows_of_time(kind):
    accumulator = kind()
    for i in range(300):  # a minute
        label = "office" if i < 150 else "kitchen"
        accumulator.update(Observation(i * SECOND // 5), says(label))
    made = accumulator.semantic_map()
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    assert made.nodes == ()
    assert made.areas[1].start == 30 * SECOND
    assert made.areas[0].confidence > 0.9
    (told,) = accumulator.warnings()
    assert "no poses: areas are windows of 10 s" in told


@pytest.mark.parametrize("kind", KINDS)
def test_some_observations_without_a_pose_are_counted(kind):
    accumulator = kind()
    for i in range(60):
        pose = None if 20 <= i < 30 else Pose2D(0.1 * i, 0, 0)
        accumulator.update(Observation(i * SECOND // 5, pose=pose), says("office"))
    made = accumulator.semantic_map()
    assert [area.label for area in made.areas] == ["office"]
    assert accumulator.warnings() == ["10 observations had no pose and are on no map"]


@pytest.mark.parametrize("kind", KINDS)
def test_one_observation_is_a_map(kind):
    accumulator = kind()
    accumulator.update(Observation(0, pose=Pose2D(1, 2, 3)), says("office", 1.5))
    made = accumulator.semantic_map()
    assert [(area.label, area.trajectory) for area in made.areas] == [("office", ((1, 2),))]
    assert [(node.x, node.y, node.area) for node in made.nodes] == [(1, 2, 0)]


def rooms(x):
    return says("office" if x < 0 else "kitchen")


def test_a_door_and_the_evidence_agree_on_two_rooms():
    made = through(joined(), np.arange(-4, 4, 0.1), rooms)
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    assert sum(node.gateway for node in made.nodes) == 1


def test_a_model_without_laser_still_finds_the_rooms():
    accumulator = joined()
    made = through(accumulator, np.arange(-4, 4, 0.1), rooms, scans=lambda x: False)
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    assert not any(node.gateway for node in made.nodes)
    first, second = made.areas
    # The change is noticed before the kitchen is 0.8 m long, and put 0.8 m before that.
    assert max(x for x, _ in first.trajectory) == pytest.approx(0, abs=0.51)
    assert min(x for x, _ in second.trajectory) == pytest.approx(0, abs=0.51)


def test_scans_that_are_missing_at_the_door_are_made_up_for_by_the_evidence():
    made = through(joined(), np.arange(-4, 4, 0.1), rooms, scans=lambda x: abs(x) > 1)
    assert [area.label for area in made.areas] == ["office", "kitchen"]


def test_a_minute_without_scans_within_a_room_changes_nothing():
    whole = through(joined(), np.arange(-4, 4, 0.02), rooms)
    part = through(joined(), np.arange(-4, 4, 0.02), rooms, scans=lambda x: not -7 < x < -1)
    assert [area.label for area in part.areas] == [area.label for area in whole.areas]
    assert [area.trajectory for area in part.areas] == [area.trajectory for area in whole.areas]


def test_scanners_of_180_and_360_degrees_in_one_log_see_the_same_door():
    accumulator, walls = joined(), doorway()
    for i, x in enumerate(np.arange(-4, 4, 0.1)):
        pose = Pose2D(float(x), 0.0, 0.0)
        beams, field = (721, 360.0) if i % 2 else (361, 180.0)
        scan = scan_at(walls, pose, beams, field)
        accumulator.update(Observation(i * SECOND // 5, pose=pose, scan=scan), rooms(x))
    made = accumulator.semantic_map()
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    assert sum(node.gateway for node in made.nodes) == 1


def test_a_log_that_begins_in_the_doorway():
    made = through(joined(), np.arange(0, 4, 0.1), rooms)
    named = [area.label for area in made.areas if area.label != "unknown"]
    assert named == ["kitchen"]
    assert {node.area for node in made.nodes} <= {area.id for area in made.areas}


def test_a_door_that_was_not_seen_on_the_way_in_parts_the_area_on_the_way_out():
    """In without scans and without a change of belief; out with scans."""
    accumulator = SpatioTemporal(Door())
    way = np.arange(-4, 4, 0.1)
    through(accumulator, way, rooms, scans=lambda x: False)
    assert len(accumulator.semantic_map().areas) == 1
    made = through(accumulator, way[::-1], rooms, start=1000)
    assert sorted(area.label for area in made.areas) == ["kitchen", "office"]
    for node in made.nodes:
        if not node.gateway and abs(node.x) > 0.6:
            assert made.area(node.area).label == ("office" if node.x < 0 else "kitchen")
    of = {node.id: node for node in made.nodes}
    assert not any(
        of[a].area != of[b].area for a, b in made.edges if not (of[a].gateway or of[b].gateway)
    )
    for area in made.areas:
        assert {x < 0 for x, _ in area.trajectory if abs(x) > 1} == {area.label == "office"}


def test_an_area_that_swallows_the_drive_is_told():
    accumulator = SpatioTemporal(Door())
    through(accumulator, np.arange(-8, 4, 0.1), rooms, scans=lambda x: False)
    (told,) = accumulator.warnings()
    assert told.startswith("area 0 (kitchen) covers 100 % of the way, and only 3")
    assert "\n" not in told
    assert told.endswith("compare accumulator=crf, which labels node by node and needs no boundary")
    alike = SpatioTemporal(Door())
    through(alike, np.arange(-8, 4, 0.1), lambda x: says("office"), scans=lambda x: False)
    assert alike.warnings() == []


def test_an_hour_of_standing_and_rounds_over_known_ground_hold_nothing_more():
    accumulator, held = joined(), []
    for turn in range(5):
        way = np.arange(-4, 4, 0.1)
        through(accumulator, way if turn % 2 == 0 else way[::-1], rooms, start=turn * 1000)
        belief = rooms(4.0 if turn % 2 == 0 else -4.0)
        for i in range(500):
            pose = Pose2D(4.0 if turn % 2 == 0 else -4.0, 0.0, 0.0)
            accumulator.update(Observation((turn * 1000 + 100 + i) * SECOND, pose=pose), belief)
        made = accumulator.semantic_map()
        evidence = accumulator.journey_.boundaries.each[1]
        assert len(evidence.stretches_) <= 6 / 0.2 + 2
        assert len(accumulator.journey_.recent.since(0)) <= 6 / 0.1 + 3
        held.append((len(made.nodes), len(made.edges), sum(len(a.trajectory) for a in made.areas)))
    assert held[-1] == held[2]
    assert len(made.areas) <= 3


FIELD = partial(RandomField, boundary=[Door()])


def test_nodes_with_doors_part_rooms_where_scans_come_and_go_too():
    way = np.arange(-4, 4, 0.1)
    whole = through(FIELD(), way, rooms)
    assert [area.label for area in whole.areas] == ["office", "kitchen"]
    assert sum(node.gateway for node in whole.nodes) == 1
    assert max(x for x, _ in whole.areas[0].trajectory) <= min(
        x for x, _ in whole.areas[1].trajectory
    )
    blind = through(FIELD(), way, rooms, scans=lambda x: False)
    assert [area.label for area in blind.areas] == ["office", "kitchen"]
    begun = through(FIELD(), np.arange(0, 4, 0.1), rooms)
    assert [area.label for area in begun.areas if area.label != "unknown"] == ["kitchen"]
    assert {node.area for node in begun.nodes} == {area.id for area in begun.areas}


def test_a_room_that_the_robot_only_looks_into_is_an_area():
    way = np.concatenate([np.arange(-4, 0.75, 0.1), np.arange(0.7, -4, -0.1)])
    made = through(FIELD(), way, rooms)
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    assert made.at(0.6, 0.0).label == "kitchen"
    alike = through(FIELD(), way, lambda x: says("office"))
    assert [area.label for area in alike.areas] == ["office"]  # it may have been no door
    entered = through(FIELD(), [*way, *np.arange(-4, 3, 0.1)], lambda x: says("office"))
    assert [area.label for area in entered.areas] == ["office", "office"]


def test_a_door_that_was_not_seen_on_the_way_in_parts_nodes_of_one_label():
    accumulator, way = FIELD(), np.arange(-4, 4, 0.1)
    through(accumulator, way, lambda x: says("office"), scans=lambda x: False)
    assert len(accumulator.semantic_map().areas) == 1
    made = through(accumulator, way[::-1], lambda x: says("office"), start=1000)
    assert [area.label for area in made.areas] == ["office", "office"]
    for area in made.areas:
        assert len({x < 0 for x, _ in area.trajectory if abs(x) > 1}) == 1


@pytest.mark.parametrize("kind", [HiddenMarkov, RandomField, Relaxation])
def test_nodes_hold_nothing_more_of_a_robot_that_stands_and_turns(kind):
    accumulator, held = kind(), []
    for turn in range(4):
        way = np.arange(-2, 2, 0.1)
        through(accumulator, way if turn % 2 == 0 else way[::-1], rooms, start=turn * 1000)
        for i in range(300):
            pose = Pose2D(2.0, 0.0, 0.5 * i)
            accumulator.update(Observation((turn * 1000 + 100 + i) * SECOND, pose=pose), rooms(2.0))
        made = accumulator.semantic_map()
        assert accumulator.here_.sums().bins <= 2 * np.pi / 0.1 + 10  # and those of the way there
        held.append((len(made.nodes), len(made.edges), sum(len(a.trajectory) for a in made.areas)))
    assert held[-1] == held[1]
