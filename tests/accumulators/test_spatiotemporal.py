import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.base import clone

from placecue import (
    Boundary,
    Observation,
    OneAgainstAll,
    OneAgainstOne,
    Pose2D,
    Scores,
    SemanticMap,
    UsageError,
)
from placecue.belief import Belief
from placecue_accumulators.node import NodeLeft
from placecue_accumulators.spatiotemporal import SpatioTemporal

CLASSES = ("corridor", "kitchen", "office", "printer")
LAYOUT = OneAgainstAll(CLASSES)


class Doors(Boundary):
    """Doors at known places, so that areas can be tested without a laser."""

    def __init__(self, at=()):
        self.at = at

    def reset(self):
        self.inside_ = None

    def update(self, observation):
        if not hasattr(self, "inside_"):
            self.reset()
        here = np.array([observation.pose.x, observation.pose.y])
        if self.inside_ is not None and np.hypot(*(here - self.inside_)) > 0.6:
            self.inside_ = None
        for door in self.at:
            if self.inside_ is None and np.hypot(*(here - door)) < 0.06:
                self.inside_ = np.array(door)
                return Pose2D(door[0], door[1], observation.pose.theta)
        return None


def way(*corners, step=0.1):
    """Return poses along straight lines between corners, 0.1 m apart, looking ahead."""
    poses = []
    for (x1, y1), (x2, y2) in pairwise(corners):
        length = np.hypot(x2 - x1, y2 - y1)
        for t in np.arange(0, length, step) / length:
            heading = np.arctan2(y2 - y1, x2 - x1)
            poses.append(Pose2D(x1 + t * (x2 - x1), y1 + t * (y2 - y1), float(heading)))
    return poses


def belief_of(values, stamp=0, layout=LAYOUT):
    scores = Scores(np.array([values], dtype=float), layout)
    decision = scores.decide()
    return Belief(stamp, scores, str(decision.labels[0]), float(decision.confidence[0]), ("laser",))


def says(label, margin=0.5, stamp=0):
    return belief_of([margin if name == label else -margin for name in CLASSES], stamp)


def follow(accumulator, poses, belief):
    """Feed poses, a second apart; return what the accumulator said, and when."""
    start = getattr(accumulator, "fed", 0)
    accumulator.fed = start + len(poses)
    said = []
    for i, pose in enumerate(poses, start):
        update = accumulator.update(Observation(i, pose=pose), belief(pose))
        said += [(i, update)] if update else []
    return said


def by_room(pose):
    """Corridor along y = 0; an office above x = 3 and a kitchen above x = 8, behind y = 1."""
    return says("corridor" if pose.y < 1 else "office" if pose.x < 5 else "kitchen")


FLOOR = ((0, 0), (3, 0), (3, 4), (3, 0), (8, 0), (8, 4), (8, 0), (11, 0))


@pytest.fixture
def floor():
    return SpatioTemporal(boundary=Doors([(3.0, 1.0), (8.0, 1.0)]))


def test_a_corridor_with_two_rooms(floor):
    said = follow(floor, way(*FLOOR), by_room)
    made = floor.semantic_map()
    assert [area.label for area in made.areas] == ["corridor", "office", "kitchen"]
    for node in made.nodes:
        if not node.gateway:
            assert made.area(node.area).label == by_room(node).label
    gateways = [(node.x, node.y) for node in made.nodes if node.gateway]
    assert gateways == [(3.0, 1.0), (8.0, 1.0)]
    assert made.classes == CLASSES
    assert made.frame == "odom"
    # Nothing but gateways joins one area to another.
    of = {node.id: node for node in made.nodes}
    crossing = [(a, b) for a, b in made.edges if of[a].area != of[b].area]
    assert all(of[a].gateway or of[b].gateway for a, b in crossing)
    # Left and entered: corridor, office, corridor, kitchen, corridor.
    assert [u.area for _, u in said if u.finished] == [0, 1, 0, 2, 0][:4]
    first = said[0][1]
    assert (first.area, first.label, first.finished) == (0, "corridor", False)


def test_areas_know_their_times_and_positions(floor):
    follow(floor, way(*FLOOR), by_room)
    corridor, office, _ = floor.semantic_map().areas
    assert corridor.start == 0
    assert corridor.end == len(way(*FLOOR)) - 1
    # The office lasts from the door (40 steps on) until the door is passed again.
    assert office.start == pytest.approx(40, abs=2)
    assert office.end == pytest.approx(100, abs=10)
    assert min(y for _, y in office.trajectory) >= 0.9
    assert max(y for _, y in office.trajectory) == pytest.approx(4.0, abs=0.11)


def test_the_map_is_plain_data(floor):
    follow(floor, way(*FLOOR), by_room)
    made = floor.semantic_map()
    assert SemanticMap.from_json(json.loads(json.dumps(made.to_json()))) == made


def test_driving_in_circles_adds_nothing(floor):
    sizes = []
    for _ in range(6):
        follow(floor, way(*FLOOR, (0, 0)), by_room)
        made = floor.semantic_map()
        held = sum(len(area.trajectory) for area in made.areas)
        sizes.append((len(made.areas), len(made.nodes), len(made.edges), held))
        assert len(floor.journey_.of_area) <= 31
        assert len(floor.journey_.of_node) <= 31
    assert sizes[1] == sizes[-1]
    assert [area.label for area in made.areas] == ["corridor", "office", "kitchen"]


def test_turning_back_in_the_door_continues_the_area(floor):
    follow(floor, way((0, 0), (3, 0), (3, 1.2), (3, 0), (6, 0)), by_room)
    assert [area.label for area in floor.semantic_map().areas] == ["corridor"]


def test_a_loop_joins_what_a_false_door_has_cut():
    square = ((0, 0), (6, 0), (6, 6), (0, 6), (0, 0), (1, 0))
    accumulator = SpatioTemporal(boundary=Doors([(6.0, 3.0)]))
    poses = way(*square)
    follow(accumulator, poses[:-30], lambda _: says("printer"))
    assert len(accumulator.semantic_map().areas) == 2
    follow(accumulator, poses[-30:], lambda _: says("printer"))
    made = accumulator.semantic_map()
    assert [(area.id, area.label) for area in made.areas] == [(0, "printer")]
    assert {node.area for node in made.nodes} == {0}
    assert len(made.area(0).trajectory) >= 24 / 0.2 - 4


def test_same_neighbours_are_merged_in_the_map_given_out():
    poses = way((0, 0), (6, 0))
    cut = SpatioTemporal(boundary=Doors([(3.0, 0.0)]))
    follow(cut, poses, lambda _: says("office"))
    assert len(cut.semantic_map().areas) == 2
    whole = SpatioTemporal(boundary=Doors([(3.0, 0.0)]), merge="all")
    follow(whole, poses, lambda _: says("office"))
    (area,) = whole.semantic_map().areas
    assert (area.id, area.label, area.margin) == (0, "office", pytest.approx(1.0))


def test_node_left_makes_an_area_of_each_node():
    accumulator = SpatioTemporal(boundary=NodeLeft(1.0))
    follow(accumulator, way((0, 0), (10, 0), (0, 0)), lambda p: says("kitchen"))
    made = accumulator.semantic_map()
    assert len(made.areas) == len(made.nodes) >= 9
    assert [node.area for node in made.nodes] == list(range(len(made.nodes)))
    assert not any(node.gateway for node in made.nodes)
    assert {area.label for area in made.areas} == {"kitchen"}


def test_beliefs_that_are_not_sure_enough_are_dropped():
    accumulator = SpatioTemporal(boundary=Doors(), label_probability=0.0)
    sure, unsure = says("office", 0.05), says("kitchen", 0.049)  # confidences 0.1 and 0.098
    for i, belief in enumerate([unsure] * 20 + [sure]):
        accumulator.update(Observation(i, pose=Pose2D(i * 0.3, 0, 0)), belief)
    (area,) = accumulator.semantic_map().areas
    assert area.label == "office"
    assert area.margin == pytest.approx(0.1)


def test_beliefs_that_the_pipeline_calls_unknown_are_dropped():
    accumulator = SpatioTemporal(boundary=Doors(), label_probability=0.0)
    rejected = replace(says("kitchen", 0.9), label="unknown")  # of confidence 1.8 all the same
    for i in range(4):
        accumulator.update(Observation(i, pose=Pose2D(i * 0.2, 0, 0)), rejected)
    assert accumulator.semantic_map().areas[0].label == "unknown"
    accumulator.update(Observation(4, pose=Pose2D(0.8, 0, 0)), says("office", 0.1))
    (area,) = accumulator.semantic_map().areas
    assert (area.label, area.margin) == ("office", pytest.approx(0.2))


def test_viewpoints_where_no_belief_was_accepted_age_the_others():
    accumulator = SpatioTemporal(boundary=Doors(), forget_after=2, label_probability=0.0)
    beliefs = [says("kitchen", 0.9), None, says("kitchen", 0.01), says("office", 0.1)]
    for i, belief in enumerate(beliefs):
        accumulator.update(Observation(i, pose=Pose2D(i * 0.3, 0, 0)), belief)
    (area,) = accumulator.semantic_map().areas
    # The first bin was left three viewpoints ago, though only one belief was accepted since.
    assert (area.label, area.margin) == ("office", pytest.approx(0.2))
    assert area.scores["kitchen"] == pytest.approx(-0.1)


def test_an_area_is_unknown_until_the_accumulated_belief_is_sure():
    accumulator = SpatioTemporal(boundary=Doors(), label_confidence=0.3)
    rows = [[0.2, 0, -1, -1], [0.0, 0.2, -1, -1], [0.9, 0, -1, -1]]
    labels = []
    for i, row in enumerate(rows):
        accumulator.update(Observation(i, pose=Pose2D(i * 0.4, 0, 0)), belief_of(row))
        (area,) = accumulator.semantic_map().areas
        labels.append((area.label, area.margin))
    # Sums over bins: 0.2 / 0; 0.1 / 0.1; 1.1 / 3 against 0.2 / 3, a lead of 0.3.
    assert labels == [("unknown", 0.0), ("unknown", 0.0), ("corridor", pytest.approx(0.3))]
    assert area.scores == pytest.approx(
        {"corridor": 1.1 / 3, "kitchen": 0.2 / 3, "office": -1, "printer": -1}
    )


def test_one_against_one_decides_by_votes_on_the_sums():
    layout = OneAgainstOne(CLASSES)  # co|ki co|of co|pr ki|of ki|pr of|pr
    rows = [[0.6, 0.2, 0.4, 0.5, 0.5, 0.5], [-0.2, 0.6, 0.8, 0.7, 0.9, 0.5]]
    accumulator = SpatioTemporal(boundary=Doors())
    for i, row in enumerate([rows[0], *[rows[1]] * 9]):  # the second nine times in one bin
        pose = Pose2D(0.4 * min(i, 1), 0, 0)
        accumulator.update(Observation(i, pose=pose), belief_of(row, layout=layout))
    (area,) = accumulator.semantic_map().areas
    # The mean of the two bins: 0.2 0.4 0.6 0.6 0.7 0.5; corridor beats all, by 0.2 at least.
    assert (area.label, area.margin) == ("corridor", pytest.approx(0.2))
    assert area.scores["corridor|kitchen"] == pytest.approx(0.2)


def test_a_revisited_area_starts_from_what_is_stored_at_its_nodes():
    accumulator = SpatioTemporal(boundary=Doors([(3.0, 1.0)]), prior_bins=6)
    follow(accumulator, way((3, 0), (3, 4), (3, 0)), by_room)
    assert accumulator.semantic_map().area(1).scores["office"] == pytest.approx(0.5)
    follow(accumulator, way((3, 0), (3, 1.9)), lambda p: says("kitchen") if p.y > 1.15 else None)
    # The poses from y = 1.2 to 1.8, all after the door, fall into the four bins 1.2, 1.4, 1.6, 1.8
    # and say -0.5 for the office; six bins' worth of 0.5 is stored.
    area = accumulator.semantic_map().area(1)
    assert area.label == "office"
    assert area.scores["office"] == pytest.approx((6 * 0.5 - 4 * 0.5) / 10)
    follow(accumulator, way((3, 1.9), (3, 3.9)), lambda _: says("kitchen"))
    assert accumulator.semantic_map().area(1).label == "kitchen"


def test_what_a_node_has_stored_is_scaled_down_before_more_is_stored():
    accumulator = SpatioTemporal(boundary=NodeLeft(1.0), forget_after=None, prior_bins=2)
    out = [Pose2D(x, 0, 0) for x in (0.0, 0.2, 0.4, 0.6)]
    back = [Pose2D(x, 0, 0) for x in (0.4, 0.2, 0.0)]
    next_node = [Pose2D(1.4, 0, 0)]
    follow(accumulator, out, lambda _: says("office"))
    follow(accumulator, next_node, lambda _: None)
    follow(accumulator, back, lambda _: says("kitchen"))
    follow(accumulator, [*next_node, back[0]], lambda _: None)
    area = accumulator.semantic_map().area(0)
    # Stored: four bins of 0.5 for the office, then two bins' worth of that and three of -0.5.
    assert area.scores["office"] == pytest.approx((2 * 0.5 - 3 * 0.5) / 5)
    assert area.label == "kitchen"


def test_full_turns_lead_to_other_bins():
    accumulator = SpatioTemporal(boundary=Doors(), forget_after=None)
    headings = np.arange(0, 4 * np.pi, 0.1)
    wrapped = (headings + np.pi) % (2 * np.pi) - np.pi
    for i, theta in enumerate(wrapped):
        accumulator.update(Observation(i, pose=Pose2D(0, 0, float(theta))), says("office"))
    assert len(accumulator.journey_.of_area) == len(headings)


def test_updates_are_given_one_at_a_time_and_none_is_lost():
    accumulator = SpatioTemporal(boundary=NodeLeft(1.0))
    said = follow(accumulator, way((0, 0), (3.5, 0)), lambda p: says("office"))
    events = [(update.area, update.finished) for _, update in said]
    assert events[:5] == [(0, False), (0, True), (1, False), (1, True), (2, False)]


def test_standing_between_two_nodes_heaps_up_no_updates():
    accumulator = SpatioTemporal(boundary=NodeLeft(1.0))
    follow(accumulator, way((0, 0), (1.2, 0)), lambda p: says("office"))
    for i in range(500):
        pose = Pose2D(0.5 + 0.1 * (i % 2), 0, 0)
        accumulator.update(Observation(100 + i, pose=pose), says("office"))
    assert len(accumulator.journey_.news) <= 2


@pytest.mark.parametrize("pose", [None, Pose2D(np.nan, 0, 0), Pose2D(0, np.inf, 0)])
def test_observations_without_a_pose_are_passed_over(pose):
    accumulator = SpatioTemporal(boundary=Doors())
    assert accumulator.update(Observation(0, pose=pose), says("office")) is None
    assert accumulator.semantic_map().nodes == ()


def test_nothing_seen_is_an_empty_map():
    made = SpatioTemporal().semantic_map()
    assert (made.areas, made.nodes, made.edges, made.classes) == ((), (), (), ())


def test_without_beliefs_areas_are_unknown():
    accumulator = SpatioTemporal()  # the default boundary needs scans, and there are none
    follow(accumulator, way((0, 0), (5, 0)), lambda _: None)
    (area,) = accumulator.semantic_map().areas
    assert (area.label, area.confidence, area.scores) == ("unknown", 0.0, {})


def test_scores_that_are_no_numbers_are_dropped():
    accumulator = SpatioTemporal(boundary=Doors())
    spoilt = Belief(0, Scores(np.full((1, 4), np.nan), LAYOUT), "office", 1.0, ())
    accumulator.update(Observation(0, pose=Pose2D(0, 0, 0)), spoilt)
    accumulator.update(Observation(1, pose=Pose2D(0.5, 0, 0)), says("kitchen"))
    assert accumulator.semantic_map().areas[0].label == "kitchen"


def test_a_change_of_layout_is_an_error():
    accumulator = SpatioTemporal(boundary=Doors())
    accumulator.update(Observation(0, pose=Pose2D(0, 0, 0)), says("office"))
    other = belief_of([0.5] * 6, layout=OneAgainstOne(CLASSES))
    with pytest.raises(UsageError, match=r"from one_against_all of 4 .* to one_against_one of 4"):
        accumulator.update(Observation(1, pose=Pose2D(0, 0, 0)), other)
    accumulator.reset()
    accumulator.update(Observation(1, pose=Pose2D(0, 0, 0)), other)


def test_another_frame_begins_a_part_of_its_own():
    accumulator = SpatioTemporal(boundary=Doors())
    follow(accumulator, way((0, 0), (2.5, 0)), lambda _: says("office"))
    elsewhere = [replace(pose, frame="map") for pose in way((0, 0), (2.5, 0))]
    follow(accumulator, elsewhere, lambda _: says("kitchen"))
    made = accumulator.semantic_map()
    assert [(a.label, a.frame) for a in made.areas] == [("office", "odom"), ("kitchen", "map")]
    assert made.frame == "odom"
    part = {node.id: node.area for node in made.nodes}
    assert set(part.values()) == {0, 1}  # though the positions are the same
    assert all(part[a] == part[b] for a, b in made.edges)
    (told,) = accumulator.warnings()
    assert "frame of the poses changed 1 times, to map" in told


def test_no_edge_leads_over_a_jump():
    accumulator = SpatioTemporal(boundary=Doors())
    follow(accumulator, way((0, 0), (2.5, 0)), lambda _: says("office"))
    follow(accumulator, way((50, 0), (52.5, 0)), lambda _: says("office"))
    made = accumulator.semantic_map()
    at = {node.id: node.x for node in made.nodes}
    assert max(abs(at[a] - at[b]) for a, b in made.edges) < 2
    assert len(made.areas) == 2
    assert accumulator.warnings()[0].startswith("the pose jumped 1 times")


def test_a_minute_without_observations_breaks_the_way_off():
    """The robot was seen 20 m further on: there was time for it, and nobody knows the way."""
    accumulator = SpatioTemporal(boundary=Doors())
    follow(accumulator, way((0, 0), (2.5, 0)), lambda _: says("office"))
    for step, pose in enumerate(way((22.5, 0), (25, 0))):
        seen = Observation(60 * 10**9 + step * 10**8, pose=pose)
        accumulator.update(seen, says("kitchen"))
    made = accumulator.semantic_map()
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    at = {node.id: node.x for node in made.nodes}
    assert max(abs(at[a] - at[b]) for a, b in made.edges) < 2
    assert accumulator.warnings() == [
        "the log has 1 gaps over which the robot drove on unseen: the map is broken off there"
    ]


def test_a_robot_that_was_carried_to_where_it_has_been_is_there():
    accumulator = SpatioTemporal(boundary=Doors())
    follow(accumulator, way((0, 0), (5, 0)), lambda _: says("office"))
    follow(accumulator, way((0, 0), (5, 0)), lambda _: says("office"))
    made = accumulator.semantic_map()
    assert len(made.areas) == 1
    assert (0, len(made.nodes) - 1) not in made.edges


@pytest.mark.parametrize(
    ("name", "value"), [("bin_x", 0), ("node_spacing", -1), ("prior_bins", -1)]
)
def test_impossible_parameters_are_errors(name, value):
    with pytest.raises(UsageError, match=name):
        SpatioTemporal(**{name: value}).reset()


def test_it_clones_and_its_boundary_is_its_own():
    boundary = Doors([(3.0, 1.0)])
    accumulator = SpatioTemporal(boundary=boundary, forget_after=7)
    follow(accumulator, way((3, 0), (3, 2)), by_room)
    copy = clone(accumulator)
    assert copy.get_params()["forget_after"] == 7
    assert copy.get_params()["boundary__at"] == [(3.0, 1.0)]
    assert not hasattr(boundary, "inside_")
    assert copy.semantic_map().nodes == ()


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(1, 5), min_size=30, max_size=30), st.integers(0, 99))
def test_how_long_the_robot_stands_changes_neither_label_nor_scores(stays, seed):
    rng = np.random.default_rng(seed)
    beliefs = [belief_of(row) for row in rng.normal(size=(30, 4))]
    once, longer = SpatioTemporal(boundary=Doors()), SpatioTemporal(boundary=Doors())
    for i, (stay, belief) in enumerate(zip(stays, beliefs, strict=True)):
        moment = Observation(i, pose=Pose2D(0.4 * i, 0, 0))
        once.update(moment, belief)
        for _ in range(stay):
            longer.update(moment, belief)
    a, b = once.semantic_map().areas[0], longer.semantic_map().areas[0]
    assert a.label == b.label
    assert a.confidence == pytest.approx(b.confidence)
    assert a.scores == pytest.approx(b.scores)
