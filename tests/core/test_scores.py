"""Layouts decide as METHODS defines; every case has four classes or more."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from placecue import (
    DataError,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
    Scores,
    UsageError,
)
from placecue.components.build import build, describe
from placecue.components.manager import load_plugins

CLASSES = ("corridor", "kitchen", "office", "printer")
REGISTRY = load_plugins(built_ins_only=True).registry


def test_one_against_all_takes_the_largest_and_the_lead_over_the_runner_up() -> None:
    decision = Scores(np.array([[-1.0, 0.5, 0.2, -3.0]]), OneAgainstAll(CLASSES)).decide()
    assert decision.labels[0] == "kitchen"
    assert decision.confidence[0] == pytest.approx(0.3)
    assert decision.ranking[0].tolist() == [1, 2, 0, 3]


def test_modified_one_against_all_takes_the_nearest_mean() -> None:
    # Distances to the means: 1.9, 0.8, 0.1, 0.5. One-against-all would take the kitchen.
    centred = np.array([[-0.9, 1.2, 0.1, 1.0]]) - np.array([1.0, 2.0, 0.0, 1.5])
    decision = Scores(centred, ModifiedOneAgainstAll(CLASSES)).decide()
    assert decision.labels[0] == "office"
    assert decision.confidence[0] == pytest.approx(0.5 - 0.1)


def test_one_against_one_majority_and_smallest_margin_of_the_winner() -> None:
    # Columns 01 02 03 12 13 23: class 1 beats 0 (0.2), 2 (0.7) and 3 (0.4).
    values = np.array([[-0.2, 0.5, 0.1, 0.7, 0.4, -0.3]])
    decision = Scores(values, OneAgainstOne(CLASSES)).decide()
    assert decision.labels[0] == "kitchen"
    assert decision.confidence[0] == pytest.approx(0.2)


def test_one_against_one_tie_is_voted_among_the_tied() -> None:
    # 0 beats 1 and 2, 1 beats 2 and 3, 3 beats 0 and 2: 0, 1, 3 have two votes each, and among
    # the three each has one; the worst margins are -0.9 (0), -0.2 (1), -0.5 (3): class 1 wins.
    values = np.array([[0.2, 0.3, -0.9, 0.4, 0.5, -0.6]])
    assert Scores(values, OneAgainstOne(CLASSES)).decide().labels[0] == "kitchen"


def test_one_against_one_second_vote_beats_the_margin() -> None:
    # 0 beats 1 (by a hair), 2; 1 beats 2, 3; 3 beats 0; 2 beats 3. Votes: 2, 2, 1, 1.
    # Between the tied 0 and 1 the second vote goes to 0, though 0 lost to 3 by a lot.
    values = np.array([[0.01, 0.5, -3.0, 0.5, 0.5, 0.5]])
    decision = Scores(values, OneAgainstOne(CLASSES)).decide()
    assert decision.labels[0] == "corridor"
    assert decision.confidence[0] == pytest.approx(-3.0)


def test_one_against_one_second_vote_goes_before_the_worst_lost_margin() -> None:
    # a, b, c, d have three votes each, e one and f two. Among the four, a beats b and c, b beats
    # c and d, c beats d, d beats a: two votes each for a and b, one for c and d. Of those two a
    # beat b. By the worst margin among the four c would win (-0.1; a -3, b -0.5, d -1), and by
    # that of a and b among the four, b.
    a_beats, b_beats = [0.5, 0.1, -3.0, 1.0, -1.0], [0.1, 1.0, 1.0, -1.0]
    c_beats, d_beats, e_beats = [1.0, 1.0, 1.0], [1.0, 1.0], [1.0]
    values = np.array([[*a_beats, *b_beats, *c_beats, *d_beats, *e_beats]])
    decision = Scores(values, OneAgainstOne(tuple("abcdef"))).decide()
    assert decision.ranking[0].tolist() == [0, 1, 2, 3, 5, 4]


def test_one_against_one_agrees_with_a_count_of_votes() -> None:
    generator = np.random.default_rng(5)
    values = generator.normal(size=(200, 10))
    layout = OneAgainstOne(("a", "b", "c", "d", "e"))
    labels = Scores(values, layout).decide().labels
    for row, label in zip(values, labels, strict=True):
        votes = [0] * 5
        for value, (i, j) in zip(row, layout.pairs, strict=True):
            votes[i if value > 0 else j] += 1
        assert votes["abcde".index(label)] == max(votes)


@given(arrays(np.float64, (7, 4), elements=st.floats(-1e3, 1e3)))
def test_every_rule_ranks_every_class_once(values: np.ndarray) -> None:
    for layout in (
        OneAgainstAll(CLASSES),
        Probabilities(CLASSES),
        ModifiedOneAgainstAll(CLASSES),
    ):
        decision = layout.decide(values)
        assert (np.sort(decision.ranking, axis=1) == np.arange(4)).all()
        assert (decision.confidence >= 0).all()


@pytest.mark.parametrize(
    "layout",
    [
        OneAgainstAll(CLASSES),
        OneAgainstOne(CLASSES),
        Probabilities(CLASSES),
        ModifiedOneAgainstAll(CLASSES),
    ],
)
def test_layouts_survive_json(layout: OneAgainstAll) -> None:
    spec = json.loads(json.dumps(describe(layout, REGISTRY)))
    assert build(spec, "layout", REGISTRY) == layout


def test_wrong_scores_are_refused_in_one_line() -> None:
    with pytest.raises(DataError, match="6 columns"):
        OneAgainstOne(CLASSES).decide(np.zeros((1, 4)))
    with pytest.raises(DataError, match="1 rows of scores hold NaN"):
        OneAgainstAll(CLASSES).decide(np.array([[np.nan, 0, 0, 0]]))
    with pytest.raises(UsageError, match="two classes"):
        OneAgainstAll(("office",))
    with pytest.raises(UsageError, match="unknown layout 'ranks'; available: decision_list"):
        build({"plugin": "ranks", "classes": ["a", "b"]}, "layout", REGISTRY)
