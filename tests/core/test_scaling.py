"""Scalings, against scikit-learn's and by hand."""

import numpy as np
import pytest
from scipy import sparse
from sklearn.preprocessing import MinMaxScaler, StandardScaler

from placecue import UsageError
from placecue.scaling import (
    FamilyScaling,
    QuantileScaling,
    RangeScaling,
    Scaling,
    StandardScaling,
    UnitLength,
    UnitSpread,
)

TRAINING = np.random.default_rng(0).gamma(2.0, size=(200, 4)) * [1, 10, 0.1, 5]
OTHER = np.random.default_rng(1).gamma(2.0, size=(50, 4)) * [1, 10, 0.1, 5]


def test_range_is_not_clipped() -> None:
    expected = MinMaxScaler((-1, 1)).fit(TRAINING).transform(OTHER)
    assert RangeScaling().fit(TRAINING).transform(OTHER) == pytest.approx(expected)
    assert np.abs(RangeScaling().fit(TRAINING).transform(100 * OTHER)).max() > 1


def test_standard() -> None:
    expected = StandardScaler().fit(TRAINING).transform(OTHER)
    assert StandardScaling().fit(TRAINING).transform(OTHER) == pytest.approx(expected)


def test_unit_length_after_another_scaling() -> None:
    rows = np.array([[3.0, 4], [0, 0], [-5, 0]])
    found = UnitLength().fit(rows).transform(rows)
    assert found.tolist() == [[0.6, 0.8], [0, 0], [-1, 0]]
    standard = StandardScaler().fit(TRAINING).transform(OTHER)
    expected = standard / np.linalg.norm(standard, axis=1, keepdims=True)
    found = UnitLength(StandardScaling()).fit(TRAINING).transform(OTHER)
    assert found == pytest.approx(expected)
    with pytest.raises(UsageError, match="must be a Scaling"):
        UnitLength("standard").fit(TRAINING)  # type: ignore[arg-type]


def test_quantiles_are_ranks_between_minus_one_and_one() -> None:
    scaled = QuantileScaling().fit(TRAINING).transform(TRAINING)
    ranks = TRAINING.argsort(axis=0).argsort(axis=0) / 199 * 2 - 1
    assert scaled == pytest.approx(ranks, abs=0.03)
    far = QuantileScaling().fit(TRAINING).transform(np.full((1, 4), 1e9))
    assert far == pytest.approx(np.ones((1, 4)))


def test_ties_lie_in_the_middle_of_their_plateau() -> None:
    # A quarter of the samples below, half of them tied, a quarter above.
    column = np.concatenate([np.linspace(0, 1, 100), np.full(200, 2.0), np.linspace(3, 4, 100)])
    fitted = QuantileScaling().fit(column[:, None])
    assert fitted.transform(np.array([[2.0]])) == pytest.approx(np.zeros((1, 1)), abs=0.02)


@pytest.mark.parametrize("scaling", [RangeScaling(), StandardScaling()])
def test_a_constant_column_becomes_zero(scaling: Scaling) -> None:
    constant = np.full((10, 1), 3.0)
    assert (scaling.fit(constant).transform(np.array([[3.0], [9.0]])) == 0).all()


def test_how_many_quantiles_are_kept_is_a_parameter() -> None:
    assert QuantileScaling(n_quantiles=5).fit(TRAINING).quantiles_.shape == (5, 4)
    for wrong in (1, 2.5, True):
        with pytest.raises(UsageError, match=r"scaling\.n_quantiles is .*; give a whole number"):
            QuantileScaling(n_quantiles=wrong).fit(TRAINING)  # type: ignore[arg-type]


#: Three gaps and one size, each from -1 to 1 once scaled by its range.
FAMILIES = ("gaps", "size", "gaps", "gaps")
CORNERS = np.array([[0.0, 2.0, 0.0, 0.0], [4.0, 6.0, 9.0, 100.0]])


def distance(scaling: Scaling) -> float:
    """Squared distance between the corners, scaled: 2 squared in each column before weighing."""
    low, high = scaling.transform(CORNERS)
    return float(((high - low) ** 2).sum())


def test_families_count_the_same_whatever_their_size() -> None:
    fitted = FamilyScaling(RangeScaling()).train(CORNERS, FAMILIES)
    third = 1 / np.sqrt(3)
    assert fitted.transform(CORNERS)[1] == pytest.approx([third, 1, third, third])
    assert distance(fitted) == pytest.approx(4 + 4)


@pytest.mark.parametrize(("weight", "expected"), [(0.25, 4 + 1), (0, 4), (3.0, 4 + 12)])
def test_a_family_may_weigh_more_or_less(weight: float, expected: float) -> None:
    scaling = FamilyScaling(RangeScaling(), weights={"gaps": weight})
    assert distance(scaling.train(CORNERS, FAMILIES)) == pytest.approx(expected)


def test_without_families_it_is_the_other_scaling() -> None:
    plain = QuantileScaling().fit(TRAINING).transform(OTHER)
    for fitted in (FamilyScaling().fit(TRAINING), FamilyScaling().train(TRAINING, None)):
        np.testing.assert_array_equal(fitted.transform(OTHER), plain)


def test_families_reach_the_scaling_inside() -> None:
    both = FamilyScaling(FamilyScaling(RangeScaling())).train(CORNERS, FAMILIES)
    assert distance(both) == pytest.approx(4 + 4 / 3)


@pytest.mark.parametrize(
    ("weights", "families", "message"),
    [
        ({"gap": 0.5}, FAMILIES, "no family 'gap' to weigh; did you mean 'gaps'"),
        ({"gaps": -1}, FAMILIES, r"scaling\.weights\.gaps is -1; give a number of at least 0"),
        ({"gaps": "much"}, FAMILIES, r"scaling\.weights\.gaps is 'much'; give a number"),
        ([1, 2], FAMILIES, r"scaling\.weights must be numbers by family"),
        ({"gaps": 0.5}, None, r"weights names gaps, and the features are in no families"),
    ],
)
def test_weights_that_cannot_be(weights: object, families: object, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        FamilyScaling(weights=weights).train(CORNERS, families)  # type: ignore[arg-type]


def test_what_is_no_scaling_is_refused() -> None:
    with pytest.raises(UsageError, match=r"scaling\.scaling must be a Scaling or None, got '"):
        FamilyScaling("range").fit(CORNERS)  # type: ignore[arg-type]


def test_spread_of_dense_features_is_one() -> None:
    features = np.random.default_rng(0).normal(3, [1.0, 5.0, 0.0], size=(500, 3))
    fitted = UnitSpread().fit(features)
    assert fitted.spread_ == pytest.approx([np.sqrt(features.var(axis=0).sum())])
    scaled = fitted.transform(features)
    assert scaled.var(axis=0).sum() == pytest.approx(1)
    # The mean squared distance between two samples is twice the sum of the variances.
    squared = ((scaled[:, None] - scaled[None]) ** 2).sum(axis=2)
    assert squared.mean() == pytest.approx(2)


def test_spread_leaves_sparse_features_sparse() -> None:
    generator = np.random.default_rng(1)
    dense = generator.random((40, 9)) * (generator.random((40, 9)) < 0.3)
    found = UnitSpread(QuantileScaling()).fit(sparse.csr_array(dense))  # quantiles are for dense
    scaled = found.transform(sparse.csr_array(dense))
    assert sparse.issparse(scaled)
    assert scaled.toarray() == pytest.approx(dense / np.sqrt(dense.var(axis=0).sum()))


def test_spread_of_as_many_columns_as_a_histogram_of_six_filters_has() -> None:
    held, columns = np.array([1.0, 2.0, 3.0]), np.array([5, 5, 28**6 - 1])
    wide = sparse.csr_array((held, (np.arange(3), columns)), shape=(3, 28**6))
    variance = np.var([1.0, 2.0, 0.0]) + np.var([0.0, 0.0, 3.0])
    assert UnitSpread().fit(wide).spread_ == pytest.approx([np.sqrt(variance)])


def test_spread_after_another_scaling() -> None:
    features = np.random.default_rng(2).normal(size=(30, 4))
    scaled = UnitSpread(StandardScaling()).fit(features).transform(features)
    assert scaled == pytest.approx((features - features.mean(axis=0)) / features.std(axis=0) / 2)


def test_what_does_not_vary_stays() -> None:
    same = np.full((3, 2), 0.1)  # whose mean is not 0.1 to the last bit
    assert UnitSpread().fit(same).transform(same) == pytest.approx(same)
    alike = sparse.csr_array(same)
    assert UnitSpread().fit(alike).transform(alike).toarray() == pytest.approx(same)
    with pytest.raises(
        UsageError, match=r"scaling\.scaling must be a Scaling or None, got 'range'"
    ):
        UnitSpread("range").fit(same)  # type: ignore[arg-type]
