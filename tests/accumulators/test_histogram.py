import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from placecue.scores import OneAgainstAll, OneAgainstOne
from placecue_accumulators.histogram import BinSums, ViewpointHistogram, bin_of

CLASSES = ("corridor", "kitchen", "office", "printer")
SIZES = (0.2, 0.2, 0.1)


def test_bins_are_centred_on_multiples_of_their_size():
    # 0.29 / 0.2 = 1.45, 0.31 / 0.2 = 1.55, -0.29 / 0.2 = -1.45; 6.34 rad is no 0.06 rad.
    assert bin_of((0.29, -0.29, 6.34), SIZES) == (1, -1, 63)
    assert bin_of((0.31, -0.31, 0.06), SIZES) == (2, -2, 1)


def test_time_is_averaged_and_space_is_summed_one_against_all():
    histogram = ViewpointHistogram()
    for _ in range(9):
        histogram.add((0, 0, 0), np.array([1.0, 0.0, -1.0, -1.0]))
    histogram.add((1, 0, 0), np.array([0.0, 1.2, -1.0, -1.0]))
    sums = histogram.sums()
    np.testing.assert_allclose(sums.mean(), [0.5, 0.6, -1.0, -1.0])
    decision = OneAgainstAll(CLASSES).decide(sums.mean()[None])
    assert decision.labels[0] == "kitchen"  # though nine of ten samples said corridor
    assert decision.confidence[0] == pytest.approx(0.1)


def test_the_rule_of_one_against_one_runs_on_the_sums():
    # Columns: co|ki co|of co|pr ki|of ki|pr of|pr. Each bin alone has another winner.
    histogram = ViewpointHistogram()
    histogram.add((0, 0, 0), np.array([0.6, 0.2, 0.4, 0.5, 0.5, 0.5]))  # corridor wins all three
    histogram.add((1, 0, 0), np.array([-0.2, 0.6, 0.8, 0.7, 0.9, 0.5]))  # kitchen wins all three
    histogram.add((1, 0, 0), np.array([-0.2, 0.6, 0.8, 0.7, 0.9, 0.5]))
    mean = histogram.sums().mean()
    np.testing.assert_allclose(mean, [0.2, 0.4, 0.6, 0.6, 0.7, 0.5])
    decision = OneAgainstOne(CLASSES).decide(mean[None])
    assert decision.labels[0] == "corridor"
    assert decision.confidence[0] == pytest.approx(0.2)  # its narrowest margin, over the kitchen


def test_bins_left_more_than_so_many_viewpoints_ago_are_forgotten():
    histogram = ViewpointHistogram(forget_after=2)
    for x in range(4):  # the first was left three viewpoints before the last
        histogram.add((x, 0, 0), np.array([10.0**x]))
    assert histogram.sums().total == pytest.approx([1110.0])
    assert len(histogram) == 3


def test_coming_back_makes_a_bin_young_again():
    histogram = ViewpointHistogram(forget_after=2)
    for x in (0, 1, 0, 2, 3):
        histogram.add((x, 0, 0), np.array([10.0**x]))
    assert histogram.sums().total == pytest.approx([1101.0])  # bin 1 is gone, 0 is not


def test_viewpoints_without_scores_count_too():
    histogram = ViewpointHistogram(forget_after=2)
    histogram.add((0, 0, 0), np.array([1.0]))
    for x in (1, 1, 2):
        histogram.visit((x, 0, 0))
    assert histogram.sums().total == pytest.approx([1.0])
    histogram.visit((3, 0, 0))  # the third viewpoint since the only scores there were
    assert (len(histogram), histogram.sums().bins) == (0, 0)
    histogram.add((3, 0, 0), np.array([5.0]))
    assert histogram.sums().mean() == pytest.approx([5.0])


def test_passing_a_bin_without_scores_makes_it_young_again():
    histogram = ViewpointHistogram(forget_after=2)
    histogram.add((0, 0, 0), np.array([1.0]))
    for x in (1, 0, 2):
        histogram.visit((x, 0, 0))
    histogram.add((3, 0, 0), np.array([1000.0]))
    assert histogram.sums().total == pytest.approx([1001.0])  # bin 0 was left two viewpoints ago


def test_standing_ages_nothing():
    histogram = ViewpointHistogram(forget_after=1)
    for x in (0, 1, 1, 1, 1):
        histogram.add((x, 0, 0), np.array([10.0**x]))
    assert len(histogram) == 2


def test_clearing_forgets_all():
    histogram = ViewpointHistogram()
    histogram.add((0, 0, 0), np.ones(4))
    histogram.clear()
    assert histogram.sums().bins == 0


def test_a_prior_is_scaled_down_and_never_up():
    heavy = BinSums(np.array([80.0, 40.0, 0.0, -40.0]), 40.0).limited(20)
    np.testing.assert_allclose(heavy.total, [40.0, 20.0, 0.0, -20.0])
    assert heavy.bins == 20
    light = BinSums(np.array([3.0, 0.0, 0.0, 0.0]), 3.0)
    assert light.limited(20) is light
    joined = heavy + BinSums(np.array([5.0, 5.0, 5.0, 5.0]), 5.0)
    np.testing.assert_allclose(joined.mean(), [45 / 25, 25 / 25, 5 / 25, -15 / 25])


def test_the_caller_s_arrays_are_left_alone():
    histogram = ViewpointHistogram()
    values = np.ones(4)
    histogram.add((0, 0, 0), values)
    histogram.add((0, 0, 0), 3 * values)
    np.testing.assert_array_equal(values, np.ones(4))


bins = st.lists(st.integers(0, 5), min_size=1, max_size=60)


@given(bins, st.lists(st.integers(1, 7), min_size=60, max_size=60))
def test_how_long_the_robot_stood_does_not_matter(way, stays):
    once, longer = ViewpointHistogram(), ViewpointHistogram()
    scores = np.random.default_rng(0).normal(size=(6, 4))
    for x in way:
        once.add((x, 0, 0), scores[x])
    for x, stay in zip(way, stays, strict=False):
        for _ in range(stay):
            longer.add((x, 0, 0), scores[x])
    np.testing.assert_allclose(once.sums().total, longer.sums().total, atol=1e-12)
    assert once.sums().bins == longer.sums().bins


steps = st.lists(st.tuples(st.integers(0, 5), st.booleans()), min_size=1, max_size=60)


@given(steps, st.integers(0, 4))
def test_sums_equal_those_computed_from_scratch(way, forget_after):
    histogram = ViewpointHistogram(forget_after)
    rng = np.random.default_rng(1)
    known: dict[int, list[np.ndarray]] = {}
    visits: dict[int, int] = {}
    visit, here = 0, None
    for x, scored in way:
        visit += x != here
        here = x
        visits[x] = visit
        histogram.visit((x, 0, 0))
        if scored:
            values = rng.normal(size=4)
            histogram.add((x, 0, 0), values)
            known.setdefault(x, []).append(values)
        for old in [b for b in known if visit - visits[b] > forget_after]:
            del known[old]
        expected = sum(np.mean(values, axis=0) for values in known.values())
        np.testing.assert_allclose(histogram.sums().total, expected, atol=1e-12)
        assert len(histogram) == len(known) <= forget_after + 1
