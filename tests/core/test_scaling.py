"""Scalings, against scikit-learn's and by hand."""

import numpy as np
import pytest
from sklearn.preprocessing import MinMaxScaler, StandardScaler

from placecue import UsageError
from placecue.scaling import scaling

TRAINING = np.random.default_rng(0).gamma(2.0, size=(200, 4)) * [1, 10, 0.1, 5]
OTHER = np.random.default_rng(1).gamma(2.0, size=(50, 4)) * [1, 10, 0.1, 5]


def test_range_is_not_clipped() -> None:
    expected = MinMaxScaler((-1, 1)).fit(TRAINING).transform(OTHER)
    assert scaling("range").fit(TRAINING).transform(OTHER) == pytest.approx(expected)
    assert np.abs(scaling("range").fit(TRAINING).transform(100 * OTHER)).max() > 1


def test_standard() -> None:
    expected = StandardScaler().fit(TRAINING).transform(OTHER)
    assert scaling("standard").fit(TRAINING).transform(OTHER) == pytest.approx(expected)


def test_quantiles_are_ranks_between_minus_one_and_one() -> None:
    scaled = scaling("quantiles").fit(TRAINING).transform(TRAINING)
    ranks = TRAINING.argsort(axis=0).argsort(axis=0) / 199 * 2 - 1
    assert scaled == pytest.approx(ranks, abs=0.03)
    far = scaling("quantiles").fit(TRAINING).transform(np.full((1, 4), 1e9))
    assert far == pytest.approx(np.ones((1, 4)))


def test_ties_lie_in_the_middle_of_their_plateau() -> None:
    # A quarter of the samples below, half of them tied, a quarter above.
    column = np.concatenate([np.linspace(0, 1, 100), np.full(200, 2.0), np.linspace(3, 4, 100)])
    fitted = scaling("quantiles").fit(column[:, None])
    assert fitted.transform(np.array([[2.0]])) == pytest.approx(np.zeros((1, 1)), abs=0.02)


@pytest.mark.parametrize("name", ["range", "standard"])
def test_a_constant_column_becomes_zero(name: str) -> None:
    constant = np.full((10, 1), 3.0)
    assert (scaling(name).fit(constant).transform(np.array([[3.0], [9.0]])) == 0).all()


def test_an_unknown_scaling_is_answered_with_the_nearest() -> None:
    with pytest.raises(UsageError, match="did you mean 'standard'"):
        scaling("standart")
