"""The threshold for "unknown" keeps the wanted false-accept rate, and no more than needed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from placecue import DataError, UsageError
from placecue.learning.rejection import choose_threshold


def test_worked_by_hand() -> None:
    confidence = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    correct = [False, True, False, False, True, True, True, False, True, True]
    # Wrong at 0.1, 0.3, 0.4, 0.8. One in four may pass: the threshold lies just above 0.4.
    found = choose_threshold(confidence, correct, 0.25)
    assert found.threshold == pytest.approx(0.4)
    assert found.false_accept_rate == 0.25
    assert found.accept_rate == pytest.approx(5 / 6)
    # None may pass: just above 0.8.
    found = choose_threshold(confidence, correct, 0.0)
    assert (found.false_accept_rate, found.accept_rate) == (0.0, pytest.approx(2 / 6))
    assert choose_threshold(confidence, correct, 1.0).accept_rate == 1.0


def test_without_errors_everything_seen_is_accepted() -> None:
    found = choose_threshold([0.5, 0.7], [True, True])
    assert (found.threshold, found.false_accept_rate, found.accept_rate) == (0.5, 0.0, 1.0)


@given(
    st.lists(st.tuples(st.integers(-9, 9), st.booleans()), min_size=1, max_size=60),
    st.sampled_from([0.0, 0.05, 0.1, 0.5, 1.0]),
)
def test_the_smallest_that_keeps_the_rate(samples: list[tuple[int, bool]], rate: float) -> None:
    confidence = np.array([each for each, _ in samples], dtype=float)
    correct = np.array([each for _, each in samples])
    found = choose_threshold(confidence, correct, rate)
    wrong = confidence[~correct]
    passed = float((wrong >= found.threshold).mean()) if len(wrong) else 0.0
    assert found.false_accept_rate == passed
    assert passed <= rate + 1e-9
    lower = confidence[confidence < found.threshold]
    if len(lower):
        assert (wrong >= lower.max()).mean() > rate


def test_what_cannot_be_is_named() -> None:
    with pytest.raises(UsageError, match="from 0 to 1"):
        choose_threshold([1.0], [True], 5)
    with pytest.raises(DataError, match="got 0 with 0 NaN"):
        choose_threshold([], [])
    with pytest.raises(DataError, match="1 NaN"):
        choose_threshold([np.nan, 1.0], [True, False])
