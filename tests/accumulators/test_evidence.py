"""The change point in the stream of beliefs, against every cut tried one by one."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue import Observation, Pose2D, UsageError
from placecue_accumulators.evidence import ChangedEvidence, best_cut

M = 4


def sure_of(label, probability=0.85):
    return np.where(np.arange(M) == label, probability, (1 - probability) / (M - 1))


def drive(boundary, labels, step=0.1, start=0.0, probability=0.85):
    """Drive along x, a belief every ``step``; return (x, where the change was put) if noticed."""
    noticed = []
    for i, label in enumerate(labels):
        x = start + step * i
        seen = Observation(i, pose=Pose2D(x, 0, 0))
        assert boundary.update(seen) is None
        behind = boundary.believe(seen, sure_of(label, probability))
        if behind is not None:
            noticed.append((x, x - behind))
    return noticed


@settings(max_examples=50, deadline=None)
@given(st.integers(2, 9), st.integers(1, 3), st.integers(0, 999), st.booleans())
def test_the_best_cut_is_that_of_trying_all_classes_and_places(n, shortest, seed, again):
    rows = np.log(np.random.default_rng(seed).dirichlet(np.ones(M), n))
    known = np.log(np.random.default_rng(seed + 1000).dirichlet(np.ones(M))) if again else None
    first = np.zeros(M) if known is None else known
    one = max(first[c] + sum(row[c] for row in rows) for c in range(M))
    gains = {
        cut: max(
            first[a] + sum(row[a] for row in rows[:cut]) + sum(row[b] for row in rows[cut:])
            for a, b in product(range(M), repeat=2)
        )
        - one
        for cut in range(0 if again else shortest, n - shortest + 1)
    }
    cut, gain = best_cut(rows, shortest, known)
    if not gains:
        assert (cut, gain) == (0, 0.0)
        return
    assert gain == pytest.approx(max(gains.values()))
    assert gains[cut] == pytest.approx(gain)


def test_a_change_is_put_where_it_was_and_noticed_within_the_delay():
    boundary = ChangedEvidence()
    [(noticed, put)] = drive(boundary, [0] * 60 + [2] * 60)
    assert put == pytest.approx(6.0, abs=0.21)
    assert 6.0 + 0.6 < noticed <= 6.0 + boundary.delay


def test_the_delay_is_what_the_likelihoods_say():
    # A stretch says log(0.9 * 0.85 + 0.1 / 4) = -0.236 of its own class and
    # log(0.9 * 0.05 + 0.025) = -2.659 of each other: a difference of 2.424. Of it 0.4 counts, so
    # that a change after as much of another place is 0.969 a stretch more likely, and 3 are
    # passed with the fourth stretch; it is complete when the fifth begins, 0.8 m on.
    boundary = ChangedEvidence(shortest=0.2, threshold=3.0, independent=0.4)
    [(noticed, put)] = drive(boundary, [0] * 40 + [1] * 40, step=0.2)
    assert (noticed, put) == (pytest.approx(8.8), pytest.approx(8.0))


def test_there_and_back_are_two_changes():
    noticed = drive(ChangedEvidence(), [0] * 40 + [1] * 20 + [0] * 40)
    assert [put for _, put in noticed] == [
        pytest.approx(4.0, abs=0.21),
        pytest.approx(6.0, abs=0.21),
    ]


@pytest.mark.parametrize("wrong", [1, 3])
def test_single_errors_change_nothing(wrong):
    labels = [0] * 200
    labels[50:150:20] = [wrong] * 5
    assert drive(ChangedEvidence(), labels, step=0.2) == []


def test_how_long_the_robot_stands_counts_for_nothing():
    boundary = ChangedEvidence()
    drive(boundary, [0] * 40)
    assert drive(boundary, [1] * 5000, step=0.0, start=4.0) == []
    assert len(boundary.stretches_) <= 6 / 0.2 + 2


def test_beliefs_without_content_end_nothing():
    assert drive(ChangedEvidence(), [0] * 100 + [1] * 100, probability=1 / M) == []


def test_entering_another_area_begins_anew():
    boundary = ChangedEvidence()
    drive(boundary, [0] * 60)
    boundary.enter()
    assert drive(boundary, [1] * 60, start=6.0) == []


def test_areas_join_unless_two_are_likelier():
    boundary = ChangedEvidence(rejoin=3.0)
    office, kitchen = np.log(sure_of(0)), np.log(sure_of(1))
    # Two are likelier by the smaller of the two leads: log(0.85 / 0.05) = 2.83.
    assert boundary.joins(office, kitchen)
    assert not boundary.joins(2 * office, 2 * kitchen)
    assert boundary.joins(9 * office, 9 * office)
    assert boundary.joins(np.zeros(M), 9 * kitchen)
    of_one_class = ChangedEvidence(rejoin=0.0)
    assert of_one_class.joins(office, 9 * office)
    assert not of_one_class.joins(office, 0.1 * kitchen)


@pytest.mark.parametrize(
    ("name", "value"),
    [("step", 0), ("shortest", 0.1), ("window", 1.0), ("threshold", 0), ("doubt", 1.0)],
)
def test_impossible_parameters_are_errors(name, value):
    with pytest.raises(UsageError, match=name):
        ChangedEvidence(**{name: value}).check_parameters()


def test_what_was_seen_on_earlier_visits_is_the_place_before():
    """An area that is entered again and left after 0.3 m, too short to be a place by itself."""
    boundary = ChangedEvidence()
    boundary.reset()
    assert drive(boundary, [0] * 3 + [2] * 30) == []
    boundary.reset()
    boundary.recall(3 * np.log(sure_of(0)))
    [(noticed, put)] = drive(boundary, [0] * 3 + [2] * 30)
    assert put == pytest.approx(0.3, abs=0.21)
    assert noticed < 2
