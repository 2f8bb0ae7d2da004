"""Tests of significance against Demšar's printed example, other libraries, and by hand."""

from itertools import product

import numpy as np
import pytest
from scipy import stats

from placecue.errors import DataError, UsageError
from placecue.evaluation.statistics import critical_difference, friedman, nemenyi, signed_rank

# Demšar 2006, Table 6 (its first two columns are Table 2): AUC of C4.5, C4.5+m, C4.5+cf and
# C4.5+m+cf. On "voting" it prints 0.975 twice, but ranks 2 and 3: they differ in the digits that
# are left out, 0.97501 stands for that.
DEMSAR = np.array(
    [
        [0.763, 0.768, 0.771, 0.798],
        [0.599, 0.591, 0.590, 0.569],
        [0.954, 0.971, 0.968, 0.967],
        [0.628, 0.661, 0.654, 0.657],
        [0.882, 0.888, 0.886, 0.898],
        [0.936, 0.931, 0.916, 0.931],
        [0.661, 0.668, 0.609, 0.685],
        [0.583, 0.583, 0.563, 0.625],
        [0.775, 0.838, 0.866, 0.875],
        [1.000, 1.000, 1.000, 1.000],
        [0.940, 0.962, 0.965, 0.962],
        [0.619, 0.666, 0.614, 0.669],
        [0.972, 0.981, 0.97501, 0.975],
        [0.957, 0.978, 0.946, 0.970],
    ]
)


def test_friedman_is_what_demsar_prints():
    test = friedman(DEMSAR)
    assert test.ranks.round(3).tolist() == [3.143, 2.0, 2.893, 1.964]
    assert (round(test.chi2, 2), round(test.f, 2)) == (9.28, 3.69)
    # "the critical value of F(3, 39) for α = 0.05 is 2.85, so we reject the null hypothesis"
    assert test.p == pytest.approx(stats.f(3, 39).sf(test.f))
    assert test.p < 0.05
    assert stats.friedmanchisquare(*DEMSAR.T).statistic == pytest.approx(10.23, abs=0.01)  # ties


def test_the_critical_difference_is_what_demsar_prints():
    # Section 3.2.2: 1.25 at α = 0.05, 1.12 at 0.10; Table 5a: 2.343 for three, 3.164 for ten
    assert round(friedman(DEMSAR).critical_difference, 2) == 1.25
    assert round(critical_difference(4, 14, 0.10), 2) == 1.12
    assert critical_difference(3, 2) == pytest.approx(2.343, abs=0.001)
    assert critical_difference(10, 18) == pytest.approx(3.164 * (110 / 108) ** 0.5, 1e-3)


def test_nemenyi_agrees_with_the_critical_difference():
    p, test = nemenyi(DEMSAR), friedman(DEMSAR)
    apart = np.abs(test.ranks[:, None] - test.ranks)
    assert ((p < 0.05) == (apart > test.critical_difference)).all()
    # z = 1.1786 / sqrt(4 * 5 / (6 * 14)); the studentised range takes it times sqrt(2)
    expected = stats.studentized_range.sf(1.178571 / (20 / 84) ** 0.5 * 2**0.5, 4, np.inf)
    assert p[0, 3] == pytest.approx(expected, abs=1e-5)
    assert (np.diag(p) == 1).all()
    assert np.array_equal(p, p.T)


def test_the_signed_rank_test_is_what_demsar_prints():
    test = signed_rank(DEMSAR[:, 0], DEMSAR[:, 1])
    assert (test.n, test.equal, test.statistic) == (14, 2, 12.0)
    # z = (12 - 52.5) / sqrt(14 * 15 * 29 / 24), slightly more for ties: about -2.54
    assert test.p == pytest.approx(2 * stats.norm.cdf(-40.5 / (6090 / 24) ** 0.5), abs=1e-3)
    assert test.median == pytest.approx(np.median(DEMSAR[:, 0] - DEMSAR[:, 1]))


def test_few_pairs_are_counted_out():
    first = np.array([0.91, 0.84, 0.77, 0.95, 0.66, 0.83, 0.9])
    gain = np.array([0.01, -0.02, 0.03, 0.04, 0.05, 0.06, 0.07])
    # Of the 128 ways to give signs to ranks 1 to 7, those with a sum as small as ours, 2
    sums = [sum(r for r, sign in zip(range(1, 8), way, strict=True) if sign)
            for way in product((0, 1), repeat=7)]  # fmt: skip
    share = sum(total <= 2 for total in sums) / 128
    assert signed_rank(first + gain, first, "greater").p == pytest.approx(share)
    assert signed_rank(first + gain, first).p == pytest.approx(2 * share)
    assert signed_rank(first + gain, first, "less").p > 0.95
    assert signed_rank(first + gain, first).remark == ""


def test_differences_that_are_equal_on_paper_tie():
    # 0.9 - 0.8, 0.8 - 0.7 and 0.3 - 0.2 are three numbers to a computer
    test = signed_rank([0.9, 0.8, 0.2, 0.5, 0.6, 0.1], [0.8, 0.7, 0.3, 0.1, 0.1, 0.4])
    assert test.statistic == 2 + 4  # ranks 2, 2, 2 of the tenths; 0.3 is the fourth


def test_equal_scores_are_no_difference():
    test = signed_rank([0.5] * 8, [0.5] * 8)
    assert (test.p, test.median, test.statistic, test.equal) == (1.0, 0.0, 18.0, 8)
    assert test.remark == "equal on every pair"
    several = friedman(np.full((8, 4), 0.5))
    assert (several.chi2, several.f, several.p) == (0.0, 0.0, 1.0)
    assert several.ranks.tolist() == [2.5] * 4
    assert (nemenyi(np.full((8, 4), 0.5)) > 0.999).all()


def test_one_order_on_every_pair_is_certain():
    test = friedman(np.arange(3) + np.arange(5)[:, None] / 100)
    assert test.ranks.tolist() == [3, 2, 1]
    assert (test.chi2, test.f, test.p) == (pytest.approx(10), float("inf"), 0.0)  # n (k - 1)


def test_too_few_pairs_say_so():
    test = signed_rank([0.9, 0.8, 0.7], [0.8, 0.6, 0.4])
    assert test.p == pytest.approx(0.25)  # 2 of 8 signs
    assert test.remark == "3 pairs are too few to tell"


@pytest.mark.parametrize(
    ("make", "error", "said"),
    [
        (lambda: signed_rank([], []), DataError, "needs 1 pairs"),
        (lambda: signed_rank([0.5, np.nan], [0.5, 0.5]), DataError, "pair 2 of 2 is undefined"),
        (lambda: signed_rank([1], [0], "bigger"), UsageError, "available: greater, less"),
        (lambda: friedman(DEMSAR[:, :2]), UsageError, "three methods or more, here are 2"),
        (lambda: friedman(DEMSAR[:1]), DataError, "needs 2 pairs"),
        (lambda: nemenyi(np.where(DEMSAR == 1, np.nan, DEMSAR)), DataError, "pair 10 of 14"),
    ],
)
def test_what_cannot_be_tested_is_one_line(make, error, said):
    with pytest.raises(error, match=said) as caught:
        make()
    assert "\n" not in str(caught.value)
