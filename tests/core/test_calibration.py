"""Sharpness: what makes held-out beliefs as sure as they are right."""

import numpy as np
import pytest
from scipy.special import expit

from placecue import OneAgainstAll, Scores, StoredEvidence
from placecue.errors import DataError
from placecue.learning.calibration import Calibration, calibrated
from placecue.learning.judging import Judged
from placecue.scores import Probabilities

FOUR = ("corridor", "kitchen", "lab", "office")


def judged(values, truth, layout=None):
    scores = Scores(
        np.asarray(values, dtype=float), OneAgainstAll(FOUR) if layout is None else layout
    )
    return Judged(np.asarray(truth), scores, StoredEvidence({"cue": scores}))


@pytest.mark.parametrize("sharpness", [0.5, 3.0])
def test_scores_that_were_drawn_with_a_sharpness_give_it_back(sharpness):
    generator = np.random.default_rng(0)
    values = generator.normal(size=(20000, 4))
    chances = np.exp(sharpness * values)
    chances /= chances.sum(axis=1, keepdims=True)
    drawn = (chances.cumsum(axis=1) < generator.random((20000, 1))).sum(axis=1)
    found = calibrated([judged(values, np.array(FOUR)[drawn])])
    assert found.sharpness == pytest.approx(sharpness, rel=0.05)
    assert found.n == 20000
    expected = -np.log(chances[np.arange(20000), drawn]).mean()
    assert found.log_loss == pytest.approx(expected, abs=0.005)


def test_two_equal_margins_of_which_one_in_four_is_wrong():
    """Two classes by hand: with a margin of 1 between them, log odds of 3 : 1 are right."""
    two = Probabilities(("a", "b"))
    sure, unsure = [[np.exp(-1), 1.0]], [[1.0, np.exp(-1)]]
    values = np.array(sure * 300 + unsure * 300)
    truth = ["b"] * 225 + ["a"] * 75 + ["a"] * 225 + ["b"] * 75
    found = calibrated([judged(values, truth, two)])
    assert expit(found.sharpness) == pytest.approx(0.75, abs=0.002)


def test_it_stays_finite_where_all_is_right_and_grows_with_what_was_seen():
    few, many = (
        calibrated([judged(np.eye(4)[[0, 1, 2, 3] * n], list(FOUR) * n)]).sharpness
        for n in (5, 500)
    )
    assert 1 < few < many < 20


def test_samples_of_no_class_and_without_scores_are_passed_over():
    values = np.vstack([np.eye(4), np.eye(4), np.full((1, 4), np.nan)])
    truth = [*FOUR, *["stairs"] * 4, "lab"]
    assert calibrated([judged(values, truth)]).n == 4
    assert calibrated([judged(values[:1], ["stairs"])]) is None


def test_how_often_cues_agree_is_counted_where_there_are_two():
    sure, other = np.eye(4)[[0, 1, 2, 3]], np.eye(4)[[0, 1, 3, 2]]
    other[0] = np.nan  # a cue that is missing there
    scores = {name: Scores(v, OneAgainstAll(FOUR)) for name, v in (("a", sure), ("b", other))}
    found = calibrated([Judged(np.array(FOUR), scores["a"], StoredEvidence(scores))])
    assert found.agreement == pytest.approx(1 / 3)
    assert calibrated([judged(np.eye(4), FOUR)]).agreement is None


def test_copies_that_know_other_classes_count_too():
    fewer = judged(np.eye(2), ["kitchen", "lab"], OneAgainstAll(("kitchen", "lab")))
    assert calibrated([fewer, judged(np.eye(4), FOUR)]).n == 6


def test_no_sharpness_is_negative():
    with pytest.raises(DataError, match="a sharpness is a positive number, got -1"):
        Calibration(-1.0, 0.5, 10)
