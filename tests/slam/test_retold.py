"""A map whose poses are learned late: the same as if they had been known from the beginning."""

from dataclasses import replace

import numpy as np
import pytest

from placecue import Boundary, Observation, OneAgainstAll, Pose2D, Scores
from placecue.belief import Belief
from placecue.correction import Correction
from placecue.slam.journal import Journal
from placecue.slam.planar import between, compose
from placecue.slam.retold import Retold
from placecue_accumulators.spatiotemporal import SpatioTemporal
from slam_rooms import ROUND, carried_and_back, corrected_carried, drifting, drive, ring

LAYOUT = OneAgainstAll(("corridor", "kitchen", "office", "printer"))
#: The middles of the four sides of the block, each one place, with a door between two.
SIDES = ((6, 1), (11, 5), (6, 9), (1, 5))


class DoorsAt(Boundary):
    """Doors that the robot sees beside it at some times, whatever pose it is told."""

    def __init__(self, stamps=()):
        self.stamps = stamps

    def reset(self):
        pass

    def update(self, observation):
        return observation.pose if observation.stamp in self.stamps else None


def believed(number):
    """Return what is believed at a moment: the side of the block that the robot truly is at."""
    side = int(np.argmin([np.hypot(*(ROUND[number, :2] - middle)) for middle in SIDES]))
    scores = Scores(np.where(np.arange(4) == side, 0.5, -0.5)[None], LAYOUT)
    return Belief(number, scores, LAYOUT.classes[side], 1.0, {})


#: The first moment on each side of the block, and on the first side again.
DOORS = tuple(n for n in range(1, len(ROUND)) if believed(n).label != believed(n - 1).label)


def accumulator(doors=DOORS):
    return SpatioTemporal(boundary=DoorsAt(doors), label_probability=0.4)


def labelled(made, observations, believed=believed):
    for number, observation in enumerate(observations):
        if observation.correction is not None:
            made.corrected(observation.correction)
        made.update(observation, believed(number))
    made.finish()
    return made.semantic_map()


def learned_late():
    """Return the drive as it is told where two loops are noticed: half way, and at the start."""
    drifted, now, known = drifting(ROUND, stretch=1.05, veer=0.02), ROUND.copy(), 0
    told = []
    for number, stamp in enumerate(range(len(ROUND))):
        if number in (120, 195):
            # So far the poses were those of wheels that went on from the last known place.
            then, known = now.copy(), number
        offset = between(drifted[known], drifted[number])
        now[number] = compose(ROUND[known], offset)
        news = None
        if known == number and known:
            before = then[:number]
            news = Correction(np.arange(number), before, ROUND[:number].copy(), "map")
            now[:number] = ROUND[:number]
        told.append(Observation(stamp, pose=Pose2D(*now[number].tolist(), "map"), correction=news))
    return told


@pytest.fixture(scope="module")
def from_the_beginning():
    """The map of a robot that knew where it was at each moment, as far as it ever knew."""
    told = learned_late()
    poses = [ROUND[n] if n <= 195 else None for n in range(len(ROUND))]
    placed = [
        observation if pose is None else Observation(n, pose=Pose2D(*pose.tolist(), "map"))
        for n, (observation, pose) in enumerate(zip(told, poses, strict=True))
    ]
    return labelled(accumulator(), placed)


def test_the_map_is_that_of_a_second_reading(from_the_beginning):
    made = labelled(Retold(accumulator()), learned_late())
    assert [area.label for area in made.areas] == [area.label for area in from_the_beginning.areas]
    assert len({area.label for area in made.areas}) == len(made.areas) == 4
    assert made.edges == from_the_beginning.edges
    for node, again in zip(made.nodes, from_the_beginning.nodes, strict=True):
        assert (node.area, node.gateway) == (again.area, again.gateway)
        assert np.hypot(node.x - again.x, node.y - again.y) < 1e-6


def test_without_it_late_news_break_the_map_off(from_the_beginning):
    made = labelled(accumulator(), learned_late())
    assert len(made.areas) > len(from_the_beginning.areas)


def test_poses_that_moved_a_little_at_the_very_end_count():
    observations = learned_late()[:60]
    news = Correction(np.array([0]), np.zeros((1, 3)), np.array([[0.0, 0.04, 0.0]]))
    last = observations[-1].placed(observations[-1].pose, news)
    before = labelled(accumulator(), observations)
    after = labelled(Retold(accumulator()), [*observations[:-1], last])
    assert [node.y for node in after.nodes[:-1]] == [
        pytest.approx(node.y + 0.04) for node in before.nodes[:-1]
    ]


def test_while_it_catches_up_the_way_has_no_jump():
    """A robot on a straight line whose poses are moved by 5 m goes on, and is moved afterwards."""
    made, believe = Retold(SpatioTemporal(boundary=DoorsAt())), believed(0)
    straight = [Observation(n, pose=Pose2D(0.2 * n, 0.0, 0.0, "map")) for n in range(40)]
    stamps = np.array([straight[0].stamp])
    news = Correction(stamps, np.zeros((1, 3)), np.array([[5.0, 0.0, np.pi / 2]]))
    for observation in straight[:30]:
        made.update(observation, believe)
    made.corrected(news)
    known = len(made.semantic_map().nodes)
    for number in range(30, 40):
        moved = Pose2D(5.0, 0.2 * number, np.pi / 2, "map")
        made.update(Observation(number, pose=moved), believe)
    made.finish()
    assert not made.warnings()
    nodes = made.semantic_map().nodes
    assert known < len(nodes)
    assert [round(node.x, 6) for node in nodes] == [5.0] * len(nodes)
    assert nodes[-1].y > 6.0


def test_a_journal_gives_back_what_was_seen():
    journal, seen = Journal(), drive(ring(), ROUND[:3], ROUND[:3])
    for number, observation in enumerate(seen):
        journal.add(observation, None if number == 1 else believed(number))
    assert len(journal) == 3
    for number, observation in enumerate(seen):
        again, belief = journal.read(number)
        assert (again.stamp, again.pose) == (observation.stamp, observation.pose)
        np.testing.assert_array_equal(again.scan.ranges, observation.scan.ranges)
        np.testing.assert_array_equal(again.scan.angles, observation.scan.angles)
        expected = None if number == 1 else believed(number)
        assert (belief is None) == (expected is None)
        assert belief is None or replace(belief, scores=None) == replace(expected, scores=None)


def test_a_robot_that_knows_a_place_again_late_makes_the_map_of_a_second_reading():
    """From scans to areas: told once, and told with the poses that were known at the end."""
    pytest.importorskip("small_gicp")
    pytest.importorskip("gtsam")
    true, _, back = carried_and_back()
    source, told = corrected_carried()
    elsewhere = np.flatnonzero(true[:, 0] > 50)
    trajectory, stamps = source.mapper.trajectory, [each.stamp for each in told]
    at = np.searchsorted(trajectory.stamps(), stamps, side="right") - 1
    final = trajectory.poses(source.mapper.poses)[at].tolist()
    again = [each.placed(Pose2D(*pose, "map")) for each, pose in zip(told, final, strict=True)]
    at_once = [each.placed(each.pose) for each in told]
    doors = [stamps[elsewhere[0]], stamps[-back]]

    def room(number):
        return believed(DOORS[0] if number in elsewhere else 0)

    def made(observations, accumulator):
        return labelled(accumulator, observations, room)

    once = made(told, Retold(accumulator(doors)))
    twice, uncorrected = (made(each, accumulator(doors)) for each in (again, at_once))
    assert areas(once) == areas(twice)
    assert farthest(once, twice) < 0.05
    assert farthest(uncorrected, twice) > 1.0


def areas(made):
    """The areas of a map, each with its label and its nodes: whether they are doors."""
    nodes = {area.id: [n.gateway for n in made.nodes if n.area == area.id] for area in made.areas}
    return [(area.label, nodes[area.id]) for area in made.areas]


def farthest(one, other):
    """How far a node of one map is from all of another, m, at most."""
    there = np.array([(node.x, node.y) for node in other.nodes])
    return max(np.hypot(*(there - [node.x, node.y]).T).min() for node in one.nodes)
