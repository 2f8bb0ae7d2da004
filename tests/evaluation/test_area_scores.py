"""What a map is worth, counted by hand on a drive through two rooms."""

import numpy as np
import pytest

from placecue import Area, Node, Observation, Pose2D, SemanticMap
from placecue.evaluation.area_scores import AreaTally
from placecue.free_space import FREE, UNSEEN, Grid
from placecue.semantic_map import AreaUpdate

SECOND = 1_000_000_000


def drive(updates=None, labels=("office", "kitchen"), ignored=()):
    """Ten positions in each of two rooms, 0.2 m and a second apart; the second thrice each."""
    tally, updates = AreaTally(ignored), updates or {}
    for step in range(20):
        seen = Observation(step * SECOND, pose=Pose2D(0.2 * step, 0, 0), label=labels[step >= 10])
        for _ in range(3 if step >= 10 else 1):
            tally.observe(seen, None, updates.get(step))
    return tally


def mapped(*areas):
    """A map of areas (label, first step, last step), with a node in the middle of each."""
    return SemanticMap(
        areas=tuple(
            Area(
                number,
                label,
                0.9,
                probabilities={label: 0.9},
                trajectory=tuple((0.2 * step, 0.0) for step in range(first, last + 1)),
            )
            for number, (label, first, last) in enumerate(areas)
        ),
        nodes=tuple(
            Node(number, 0.1 * (first + last), 0, number)
            for number, (_, first, last) in enumerate(areas)
        ),
        edges=(),
        classes=("kitchen", "office"),
    )


def test_a_border_in_the_wrong_place_costs_its_share_of_the_way():
    scores = drive().scores(mapped(("office", 0, 12), ("kitchen", 13, 19)))
    assert scores.way == pytest.approx(17 / 20)
    assert (scores.areas, scores.right, scores.nodes) == (2, 2, 1.0)


def test_one_area_over_both_has_half_of_the_way_and_is_right_by_most_of_it():
    scores = drive().scores(mapped(("office", 0, 19)))
    assert scores.way == 0.5
    assert (scores.areas, scores.right) == (1, 1)


def test_only_areas_of_more_than_ten_observations_are_large():
    scores = drive().scores(mapped(("kitchen", 0, 9), ("kitchen", 10, 19)))
    assert (scores.right, scores.areas, scores.large_right, scores.large) == (1, 2, 1, 1)


def test_unknown_is_wrong_and_counted():
    scores = drive().scores(mapped(("office", 0, 9), ("unknown", 10, 19)))
    assert (scores.way, scores.unknown) == (0.5, 0.5)


def test_labels_that_are_passed_over_count_nowhere():
    scores = drive(ignored=["kitchen"]).scores(mapped(("office", 0, 19)))
    assert (scores.way, scores.areas) == (1.0, 1)


def test_the_delay_runs_from_coming_in_until_the_label_is_right():
    updates = {3: AreaUpdate(0, "office", 0.9), 14: AreaUpdate(1, "kitchen", 0.9)}
    scores = drive(updates).scores(mapped(("office", 0, 9), ("kitchen", 10, 19)))
    assert scores.delay == pytest.approx(3.5)  # of 3 and 4 s
    assert scores.never == 0
    late = drive({3: AreaUpdate(0, "office", 0.9)})
    scores = late.scores(mapped(("office", 0, 9), ("kitchen", 10, 19)))
    assert scores.delay == pytest.approx(6.0)  # of 3 s and the 9 s of the other stay
    assert scores.never == 0.5


def test_an_area_that_is_finished_is_not_where_the_robot_is():
    updates = {3: AreaUpdate(0, "office", 0.9, finished=True)}
    assert drive(updates).scores(mapped(("office", 0, 19))).never == 1.0


def test_free_space_is_right_where_it_is_reached_from_what_is_right():
    states = np.full((5, 40), UNSEEN)
    states[1:4] = FREE
    grid = Grid(states, 0.1, -0.05, -0.25, "odom")
    scores = drive().scores(mapped(("office", 0, 9), ("office", 10, 19)), grid)
    assert scores.free == pytest.approx(0.5, abs=0.03)
    known = drive().scores(mapped(("office", 0, 19)), grid, lambda x, y: "office")
    assert known.free == 1.0


def test_a_map_in_time_has_no_places():
    made = SemanticMap((Area(0, "office", 0.9),), (), (), ("office", "kitchen"))
    scores = drive().scores(made)
    assert (scores.way, scores.areas, scores.nodes) == (0, 0, 0)


def test_distributions_stand_beside_what_is_true():
    areas, nodes = drive().distributions(mapped(("office", 0, 12), ("kitchen", 13, 19)))
    assert [(each.truth, dict(each.probabilities)) for each in areas] == [
        ("office", {"office": 0.9}),
        ("kitchen", {"kitchen": 0.9}),
    ]
    assert nodes == []  # nothing is said of them
