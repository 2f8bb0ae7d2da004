"""The accumulators that label nodes first, on a drive of two rooms with errors."""

import json
from dataclasses import replace

import numpy as np
import pytest
from sklearn.base import clone

from placecue import Boundary, Observation, Pose2D, Scores, SemanticMap, UsageError
from placecue.belief import Belief
from placecue.scores import OneAgainstAll
from placecue_accumulators.crf import RandomField
from placecue_accumulators.hmm import HiddenMarkov
from placecue_accumulators.neighbours import Neighbours
from placecue_accumulators.node import NodeLeft
from placecue_accumulators.relaxation import Relaxation
from placecue_accumulators.spatiotemporal import SpatioTemporal

CLASSES = ("corridor", "kitchen", "office", "printer")
LAYOUT = OneAgainstAll(CLASSES)
KINDS = [HiddenMarkov, RandomField, Relaxation]


def says(label, margin=0.5):
    values = [margin if name == label else -margin for name in CLASSES]
    scores = Scores(np.array([values]), LAYOUT)
    return Belief(0, scores, label, 2 * margin, {})


def drive(accumulator, xs, label_at, start=0, frame="odom"):
    for i, x in enumerate(xs):
        pose = Pose2D(float(x), 0.0, 0.0, frame)
        accumulator.update(Observation(start + i, pose=pose), label_at(x))
    return accumulator.semantic_map()


def two_rooms(x):
    """An office up to x = 10, then a kitchen; between 4 and 5 the beliefs waver, wrongly."""
    if 4 < x < 5:
        return says("printer", 0.1)
    return says("office" if x < 10 else "kitchen")


WAY = np.arange(0, 20, 0.1)


@pytest.mark.parametrize("kind", KINDS)
def test_neighbours_mend_an_error_and_two_rooms_stay_two(kind):
    made = drive(kind(), WAY, two_rooms)
    assert [area.label for area in made.areas] == ["office", "kitchen"]
    for node in made.nodes:
        if not 9 < node.x < 11:  # a node there has seen both
            assert made.area(node.area).label == ("office" if node.x < 10 else "kitchen")
    for area in made.areas:
        assert sum(area.probabilities.values()) == pytest.approx(1)
        assert area.confidence == area.probabilities[area.label] <= 1
    assert SemanticMap.from_json(json.loads(json.dumps(made.to_json()))) == made


@pytest.mark.parametrize("kind", KINDS)
def test_driving_there_and_back_adds_no_nodes(kind):
    accumulator = kind()
    once = drive(accumulator, WAY, two_rooms)
    again = drive(accumulator, WAY[::-1], two_rooms, start=1000)
    assert len(again.nodes) == len(once.nodes)
    assert [area.label for area in again.areas] == ["office", "kitchen"]


@pytest.mark.parametrize("kind", KINDS)
def test_rejected_beliefs_label_nothing(kind):
    rejected = replace(says("office"), label="unknown")
    made = drive(kind(), WAY, lambda _: rejected)
    assert {area.label for area in made.areas} == {"unknown"}
    assert all(area.confidence == 0 for area in made.areas)


@pytest.mark.parametrize("kind", KINDS)
def test_a_tie_is_unknown(kind):
    tie = Scores(np.array([[0.3, -0.5, 0.3, -0.5]]), LAYOUT)
    made = drive(kind(), WAY, lambda _: Belief(0, tie, "corridor", 0.2, {}))
    assert {area.label for area in made.areas} == {"unknown"}


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_one_observation_and_another_frame(kind):
    assert kind().semantic_map().areas == ()
    accumulator = kind()
    made = drive(accumulator, [0.0], lambda _: says("office", 1.5))
    assert [(area.label, len(area.trajectory)) for area in made.areas] == [("office", 1)]
    made = drive(accumulator, WAY, two_rooms, start=10, frame="map")
    assert {area.frame for area in made.areas} == {"odom", "map"}
    assert not any((a == 0) != (b == 0) for a, b in made.edges)


@pytest.mark.parametrize("kind", KINDS)
def test_impossible_parameters_are_errors(kind):
    with pytest.raises(UsageError, match="node_spacing"):
        kind(node_spacing=0).reset()
    assert clone(kind(doubt=0.1)).doubt == 0.1


def told(label, other, agreement):
    """A belief of two cues, of which the second says something else."""
    belief = says(label)
    cues = {"first": belief.scores, "second": says(other).scores}
    return replace(belief, cue_scores=cues, agreement=agreement)


@pytest.mark.parametrize("kind", [*KINDS, SpatioTemporal])
def test_where_cues_disagree_as_never_in_training_less_is_told_and_said(kind):
    made = {}
    for name, other in (("alike", "office"), ("apart", "kitchen")):
        accumulator = kind()
        made[name] = drive(accumulator, WAY, lambda _, other=other: told("office", other, 0.9))
        lines = accumulator.warnings()
        assert [line.startswith("the cues say the same of 0 %") for line in lines] == (
            [True] if name == "apart" else []
        )
    sure, unsure = ({n.id: n.probabilities for n in made[name].nodes} for name in made)
    assert any(sure.values())
    for node in (each for each, found in sure.items() if found):
        assert unsure[node]["office"] < sure[node]["office"]


@pytest.mark.parametrize("kind", [*KINDS, SpatioTemporal])
def test_a_temperature_makes_probabilities_flatter(kind):
    plain, flat = (drive(kind(temperature=t), WAY, two_rooms) for t in (1.0, 2.0))
    for one, other in zip(plain.nodes, flat.nodes, strict=True):
        if one.probabilities:
            first, second = (sorted(node.probabilities.values()) for node in (one, other))
            assert second[-1] <= first[-1]
    assert flat.areas[0].confidence < plain.areas[0].confidence
    with pytest.raises(UsageError, match="temperature"):
        kind(temperature=0).reset()


def test_the_hmm_holds_no_more_than_its_lag():
    short, long = HiddenMarkov(lag=20), HiddenMarkov(lag=10_000)
    for i in range(6):
        way = WAY if i % 2 == 0 else WAY[::-1]
        one = drive(short, way, two_rooms, start=1000 * i)
        other = drive(long, way, two_rooms, start=1000 * i)
    assert len(short.visits_) <= 20 < len(long.visits_)
    assert [area.label for area in one.areas] == [area.label for area in other.areas]


def test_the_hmm_knows_where_it_is():
    accumulator = HiddenMarkov()
    drive(accumulator, WAY[:90], two_rooms)
    assert CLASSES[accumulator.filtered().argmax()] == "office"
    drive(accumulator, WAY[90:], two_rooms, start=90)
    assert CLASSES[accumulator.filtered().argmax()] == "kitchen"


def test_what_is_said_on_the_way_is_what_the_map_says_of_the_node():
    accumulator = RandomField()
    for part in (WAY[:35], WAY[35:65]):  # of so short a chain no part is out of reach
        drive(accumulator, part, lambda _: says("office"))
        accumulator.at_ = accumulator.said_ = None  # say it again
        pose = Pose2D(float(part[-1]), 0.0, 0.0)
        update = accumulator.update(Observation(100, pose=pose), says("kitchen", 0.1))
        made = accumulator.semantic_map()
        assert (update.area, update.label) == (0, "office")
        assert update.confidence == pytest.approx(made.nodes[-1].probabilities["office"])


class DoorsAt(Boundary):
    """Doors across the way at known places."""

    def __init__(self, at=()):
        self.at = at

    def reset(self):
        pass

    def update(self, observation):
        pose = observation.pose
        near = [x for x in self.at if abs(pose.x - x) < 0.06]
        return Pose2D(near[0], 0.0, pose.theta) if near else None


@pytest.mark.parametrize("kind", KINDS)
def test_a_door_parts_areas_of_one_label_and_belongs_to_the_first(kind):
    accumulator = kind(boundary=[DoorsAt((10.0,))])
    made = drive(accumulator, WAY, lambda _: says("office"))
    assert [area.label for area in made.areas] == ["office", "office"]
    first, second = made.areas
    assert max(x for x, _ in first.trajectory) <= 10.0 < min(x for x, _ in second.trajectory) + 0.1
    [door] = [node for node in made.nodes if node.gateway]
    assert (door.x, door.area, door.probabilities) == (10.0, first.id, {})
    again = drive(accumulator, WAY[::-1], lambda _: says("office"), start=500)
    assert (len(again.nodes), len(again.areas)) == (len(made.nodes), 2)


def test_what_is_said_of_areas_is_in_the_map():
    accumulator, said = RandomField(boundary=[DoorsAt((5.0,))]), []
    for i, x in enumerate(WAY):
        update = accumulator.update(Observation(i, pose=Pose2D(float(x), 0, 0)), two_rooms(x))
        said += [update] if update else []
    areas = {area.id: area.label for area in accumulator.semantic_map().areas}
    assert list(areas.values()) == ["office", "office", "kitchen"]
    assert [u.area for u in said] == list(areas)
    assert {u.area: u.label for u in said} == areas


@pytest.mark.parametrize("kind", KINDS)
def test_a_log_that_begins_in_a_door_and_a_boundary_that_is_no_place(kind):
    made = drive(kind(boundary=DoorsAt((0.0,))), [0.0], lambda _: says("office"))
    assert [node.gateway for node in made.nodes] == [False, True]
    assert {node.area for node in made.nodes} == {area.id for area in made.areas}
    with pytest.raises(UsageError, match="NodeLeft"):
        kind(boundary=NodeLeft()).reset()


@pytest.mark.parametrize("kind", KINDS)
def test_one_strange_belief_at_a_new_node_does_not_change_where_the_robot_is(kind):
    accumulator = kind()
    drive(accumulator, WAY[:42], lambda _: says("office"))
    there = Pose2D(5.2, 0, 0)
    assert accumulator.update(Observation(42, pose=there), says("kitchen", 0.15)) is None
    assert accumulator.update(Observation(43, pose=there), says("kitchen", 9.0)).label == "kitchen"


def test_learned_transitions_rule_out_what_never_follows(tmp_path):
    never = np.where(np.eye(4, dtype=bool), 1.0, 0.0)
    Neighbours(CLASSES, never).write(tmp_path / "t.json")
    short = WAY[:120]  # of more kitchen nobody could be talked out
    made = drive(HiddenMarkov(transitions=str(tmp_path / "t.json")), short, two_rooms)
    assert [area.label for area in made.areas] == ["office"]
    assert len(drive(HiddenMarkov(), short, two_rooms).areas) == 2


def test_learned_weights_of_a_field_are_read(tmp_path):
    apart = np.where(np.eye(4, dtype=bool), 50.0, 0.0)
    Neighbours(CLASSES, apart).write(tmp_path / "w.json")
    made = drive(RandomField(weights=str(tmp_path / "w.json")), WAY, two_rooms)
    assert len(made.areas) == 1
