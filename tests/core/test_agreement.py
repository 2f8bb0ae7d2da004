"""What agreement of cues says of their accuracy: by hand, and by drawing."""

import numpy as np
import pytest

from placecue.agreement import accuracy_of, agreeing, log_odds_lost


def test_pairs_are_counted():
    assert agreeing(["a"]) == (0, 0)
    assert agreeing(["a", "b"]) == (0, 1)
    assert agreeing(["a", "b", "a"]) == (1, 3)


@pytest.mark.parametrize(
    ("accuracy", "classes", "agreement"),
    [(0.9, 2, 0.82), (0.8, 4, 0.64 + 0.04 / 3), (0.6, 3, 0.36 + 0.16 / 2)],
)
def test_accuracy_by_hand(accuracy, classes, agreement):
    assert accuracy_of(agreement, classes) == pytest.approx(accuracy)


def test_accuracy_of_drawn_labels_comes_back():
    rng = np.random.default_rng(0)
    truth = rng.integers(5, size=100_000)

    def said():
        wrong = (truth + rng.integers(1, 5, size=len(truth))) % 5
        return np.where(rng.random(len(truth)) < 0.7, truth, wrong)

    agreement = float((said() == said()).mean())
    assert accuracy_of(agreement, 5) == pytest.approx(0.7, abs=0.01)


def test_less_than_chance_and_all_stay_inside():
    assert accuracy_of(0.0, 4) == pytest.approx(0.27)
    assert accuracy_of(1.0, 4) == pytest.approx(0.98)


def test_log_odds_shrink_by_what_accuracy_loses():
    # 0.9 of two classes are odds of 9 to 1, 0.75 of 3 to 1, which is the root of it.
    assert log_odds_lost(0.82, 0.75**2 + 0.25**2, 2) == pytest.approx(2.0)
    assert log_odds_lost(0.7, 0.9, 3) == 1.0
