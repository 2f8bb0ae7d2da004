"""Tests of significance over pairs of recordings, as Demšar prescribes them.

References
----------
Demšar, Statistical comparisons of classifiers over multiple data sets, JMLR 7, 2006.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError, UsageError, choices

#: The paper's level of significance.
ALPHA = 0.05
Alternative = Literal["two-sided", "greater", "less"]
ALTERNATIVES: tuple[Alternative, ...] = ("two-sided", "greater", "less")
#: Scores are compared to so many digits: what is equal on paper is a tie.
DIGITS = 10
#: With this many pairs or more a two-sided signed-rank test can fall under 0.05.
ENOUGH = 6
#: Up to this many pairs without ties the distribution of the rank sums is counted out.
EXACT = 50


@dataclass(frozen=True)
class SignedRank:
    """What Wilcoxon's signed-rank test says of two methods.

    Parameters
    ----------
    n : int
        Pairs of recordings.
    equal : int
        Those on which both score the same; their ranks are split evenly.
    median : float
        Of the differences, first minus second.
    statistic : float
        Demšar's T: the smaller of the sums of ranks.
    p : float
        Under ``alternative``; 1 where all scores are equal.
    alternative : str
        ``two-sided``, ``greater`` (the first scores higher) or ``less``.
    """

    n: int
    equal: int
    median: float
    statistic: float
    p: float
    alternative: Alternative

    @property
    def remark(self) -> str:
        """What is to be known of the p-value, if anything."""
        if self.equal == self.n:
            return "equal on every pair"
        return f"{self.n} pairs are too few to tell" if self.n < ENOUGH else ""


def signed_rank(
    first: ArrayLike, second: ArrayLike, alternative: Alternative = "two-sided"
) -> SignedRank:
    """Test whether two methods differ over the same pairs.

    The p-value is exact for up to 50 pairs without ties, else by the normal approximation.

    Parameters
    ----------
    first, second : array_like of float, shape (n,)
        Scores of both on each pair.
    alternative : str
        See :class:`SignedRank`.

    Raises
    ------
    DataError
        If there is no pair, or a score is undefined.
    UsageError
        If there is no such alternative.
    """
    from scipy.stats import wilcoxon

    if alternative not in ALTERNATIVES:
        raise UsageError(f"no alternative '{alternative}'; {choices(alternative, ALTERNATIVES)}")
    scores = _checked(np.stack([first, second], axis=1), "signed-rank test", pairs=1)
    # Rounded once more, so that 0.9 - 0.8 and 0.8 - 0.7 share a rank.
    differences = np.round(scores[:, 0] - scores[:, 1], DIGITS)
    n, equal = len(differences), int((differences == 0).sum())
    if equal == n:
        return SignedRank(n, equal, 0.0, n * (n + 1) / 4, 1.0, alternative)
    tied = equal > 0 or len(np.unique(np.abs(differences))) < n
    method = "asymptotic" if tied or n > EXACT else "exact"
    p = wilcoxon(differences, zero_method="zsplit", alternative=alternative, method=method).pvalue
    return SignedRank(
        n, equal, float(np.median(differences)), _smaller_sum(differences), float(p), alternative
    )


@dataclass(frozen=True)
class Friedman:
    """What Friedman's test says of k methods over n pairs, without correction for ties.

    Parameters
    ----------
    n : int
        Pairs of recordings.
    ranks : ndarray of float64, shape (k,)
        Mean ranks; 1 is the best.
    chi2, p_chi2 : float
        Friedman's statistic, as Demšar prints it, and its p-value.
    f, p : float
        The less conservative statistic of Iman and Davenport, and its p-value; infinite and 0
        where all pairs agree on one order.
    critical_difference : float
        Of mean ranks, by Nemenyi's test at ``alpha``.
    alpha : float
        The level of significance.
    """

    n: int
    ranks: NDArray[np.float64]
    chi2: float
    p_chi2: float
    f: float
    p: float
    critical_difference: float
    alpha: float


def friedman(scores: ArrayLike, alpha: float = ALPHA) -> Friedman:
    """Test whether several methods differ over the same pairs.

    Unlike ``scipy.stats.friedmanchisquare`` it does not correct for ties: neither does Demšar.

    Parameters
    ----------
    scores : array_like of float, shape (n, k)
        Scores of k methods on n pairs; more is better.
    alpha : float
        The level of significance.

    Raises
    ------
    DataError
        If there are fewer than two pairs, or a score is undefined.
    UsageError
        If there are fewer than three methods.
    """
    from scipy.stats import chi2, f

    ranks = _ranks(scores, "Friedman's test")
    (n, k), means = ranks.shape, ranks.mean(axis=0)
    statistic = 12 * n / (k * (k + 1)) * max(float(((means - (k + 1) / 2) ** 2).sum()), 0.0)
    left = n * (k - 1) - statistic
    corrected = (n - 1) * statistic / left if left > 1e-9 else float("inf")
    return Friedman(
        n,
        means,
        statistic,
        float(chi2.sf(statistic, k - 1)),
        corrected,
        float(f.sf(corrected, k - 1, (k - 1) * (n - 1))),
        critical_difference(k, n, alpha),
        alpha,
    )


def nemenyi(scores: ArrayLike) -> NDArray[np.float64]:
    """Return the p-values of Nemenyi's post-hoc test for every two of k methods.

    Parameters
    ----------
    scores : array_like of float, shape (n, k)
        As for :func:`friedman`.

    Returns
    -------
    ndarray of float64, shape (k, k)
        Symmetric, 1 on the diagonal.

    Raises
    ------
    DataError, UsageError
        As :func:`friedman` does.
    """
    ranks = _ranks(scores, "Nemenyi's test")
    # Late: it brings pandas, statsmodels and seaborn, seconds of importing.
    from scikit_posthocs import posthoc_nemenyi_friedman

    return np.asarray(posthoc_nemenyi_friedman(ranks), dtype=np.float64)


def critical_difference(k: int, n: int, alpha: float = ALPHA) -> float:
    """Return how far mean ranks of k methods over n pairs must be apart to differ (Nemenyi)."""
    from scipy.stats import studentized_range

    quantile = float(studentized_range.ppf(1 - alpha, k, np.inf)) / 2**0.5
    return float(quantile * np.sqrt(k * (k + 1) / (6 * n)))


def _ranks(scores: ArrayLike, test: str) -> NDArray[np.float64]:
    """Return the rank of each method on each pair, the best first, ties shared."""
    from scipy.stats import rankdata

    table = np.asarray(scores, dtype=np.float64)
    if table.ndim != 2 or table.shape[1] < 3:
        methods = table.shape[1] if table.ndim == 2 else 1
        raise UsageError(
            f"{test} compares three methods or more, here are {methods}: "
            "name more, or compare two by the signed-rank test"
        )
    return np.asarray(rankdata(-_checked(table, test, pairs=2), axis=1), dtype=np.float64)


def _checked(table: NDArray[np.float64], test: str, pairs: int) -> NDArray[np.float64]:
    """Return scores (n pairs in rows) rounded to what is told apart; refuse what cannot be."""
    if len(table) < pairs:
        raise DataError(
            f"{test} needs {pairs} pairs that all methods have results of, here are {len(table)}"
        )
    undefined = ~np.isfinite(table).all(axis=1)
    if undefined.any():
        raise DataError(
            f"{test}: the score of pair {int(undefined.argmax()) + 1} of {len(table)} is "
            "undefined: leave that pair out"
        )
    return np.round(table, DIGITS)


def _smaller_sum(differences: NDArray[np.float64]) -> float:
    from scipy.stats import rankdata

    ranks, halves = rankdata(np.abs(differences)), np.sign(differences) / 2 + 0.5
    return float(min((ranks * halves).sum(), (ranks * (1 - halves)).sum()))
