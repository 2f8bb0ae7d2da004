"""The threshold for "unknown" keeps the wanted false-accept rate, and lies on no sample."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from placecue import DataError, UsageError
from placecue.learning.rejection import choose_threshold


def test_worked_by_hand() -> None:
    confidence = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    correct = [False, True, False, False, True, True, True, False, True, True]
    # Wrong at 0.1, 0.3, 0.4, 0.8. One in four may pass, 0.4 must not: half way from there to 0.5.
    found = choose_threshold(confidence, correct, 0.25)
    assert found.threshold == pytest.approx(0.45)
    assert found.false_accept_rate == 0.25
    assert found.accept_rate == pytest.approx(5 / 6)
    # None may pass: half way from 0.8 to 0.9.
    found = choose_threshold(confidence, correct, 0.0)
    assert found.threshold == pytest.approx(0.85)
    assert (found.false_accept_rate, found.accept_rate) == (0.0, pytest.approx(2 / 6))
    assert choose_threshold(confidence, correct, 1.0).accept_rate == 1.0


def test_without_errors_everything_seen_is_accepted() -> None:
    found = choose_threshold([0.5, 0.7], [True, True])
    assert found.threshold == pytest.approx(0.5)
    assert (found.false_accept_rate, found.accept_rate) == (0.0, 1.0)


def test_the_next_larger_confidence_may_be_an_error_that_passes() -> None:
    found = choose_threshold([0.2, 0.4, 0.8, 0.9], [False, False, True, True], 0.5)
    assert found.threshold == pytest.approx(0.3)
    assert (found.false_accept_rate, found.accept_rate) == (0.5, 1.0)


def test_where_the_surest_is_an_error_nothing_seen_passes() -> None:
    found = choose_threshold([0.3, 0.9, 0.5], [True, False, True], 0.0)
    assert found.threshold == pytest.approx(0.9)
    assert (found.false_accept_rate, found.accept_rate) == (0.0, 0.0)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e4])
@pytest.mark.parametrize("rate", [0.0, 0.25, 1.0])
def test_rounding_of_any_confidence_changes_no_answer(scale: float, rate: float) -> None:
    # What must not pass without right ones of the same confidence, but for the last digits.
    confidence = scale * np.array([-0.5, 0.1, 0.2, 0.4, 0.4, 0.4, 0.6, 0.9, 0.9])
    correct = np.array([False, False, True, False, True, True, True, False, True])
    rounding = 4 * np.finfo(float).eps * scale * np.random.default_rng(0).normal(size=(50, 9))
    expected = {0.0: [], 0.25: [6, 7, 8], 1.0: list(range(9))}[rate]
    for moved in confidence + rounding:
        found = choose_threshold(moved, correct, rate)
        assert found.accept_rate == np.isin(np.flatnonzero(correct), expected).mean()
        for again in confidence + rounding:
            assert np.flatnonzero(again >= found.threshold).tolist() == expected


@given(
    st.lists(st.tuples(st.integers(-9, 9), st.booleans()), min_size=1, max_size=60),
    st.sampled_from([0.0, 0.05, 0.1, 0.5, 1.0]),
)
def test_the_rate_is_kept_and_no_smaller_threshold_would(
    samples: list[tuple[int, bool]], rate: float
) -> None:
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
    with pytest.raises(DataError, match="got 0 samples"):
        choose_threshold([], [])
    with pytest.raises(DataError, match="got 2 samples, 1 of them NaN or infinite"):
        choose_threshold([np.nan, 1.0], [True, False])
    with pytest.raises(DataError, match="1 of them NaN or infinite"):
        choose_threshold([np.inf, 1.0], [True, False])
