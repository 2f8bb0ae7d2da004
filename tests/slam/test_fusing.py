"""Match and prior, joined by how much each says of a direction."""

import numpy as np
import pytest

from placecue.slam.fusing import fused, told
from placecue.slam.matching import Match
from placecue.slam.planar import between, carried, compose


def match(information, pose=(0.0, 0.0, 0.0)):
    return Match(np.array(pose), np.asarray(information, dtype=float), 1.0)


def test_walls_on_one_side_tell_nothing_along_them():
    # 100 points on walls along x: all of them tell y and, by their distance ahead, the heading.
    information, untold = told(match(np.diag([1.0, 100.0, 130.0])), 100)
    assert untold == 1
    assert information[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert information[1, 1] == pytest.approx(100 / 0.05**2)


def test_what_is_not_told_stays_as_expected_and_the_rest_follows_the_match():
    expected = np.array([0.4, 0.4, 0.0])
    found = fused(match(np.diag([0.0, 100.0, 900.0])), 100, expected, np.diag([0.04, 0.04, 0.01]))
    assert found.pose[0] == pytest.approx(0.4, abs=1e-6)
    # Of y: 100 points of 5 cm, 0.005 m, against 0.2 m.
    weight = (1 / 0.2**2) / (1 / 0.2**2 + 100 / 0.05**2)
    assert found.pose[1] == pytest.approx(0.4 * weight, rel=1e-6)
    assert np.sqrt(found.covariance[0, 0]) == pytest.approx(0.2, rel=0.01)


def test_a_turn_carries_its_uncertainty_sideways():
    # 0.1 rad of heading before 2 m of way is 0.2 m across at its end.
    after = carried(np.diag([0.0, 0.0, 0.01]), np.array([2.0, 0.0, 0.0]))
    assert after[1, 1] == pytest.approx(0.2**2)
    assert after[0, 0] == pytest.approx(0.0)
    # Checked against a difference: the end pose in its own axes when the start is turned by 1e-4.
    step = np.array([1.0, -0.5, 0.7])
    start = np.array([0.0, 0.0, 1e-4])
    off = between(step, compose(start, step)) / 1e-4
    np.testing.assert_allclose(carried(np.diag([0, 0, 1.0]), step), np.outer(off, off), atol=1e-3)
