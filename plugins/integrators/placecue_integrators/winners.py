"""How many samples of each class are recognised under many weightings, in compiled loops.

The rules are those of the layouts in :mod:`placecue.scores`, to the last bit and with their ties.
They only ask whether the right class wins, for all weightings of a sample side by side.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from placecue.scores import (
    DecisionList,
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
)

Table = NDArray[np.int64]
Array = NDArray[Any]


class Rule(IntEnum):
    """How a row of outputs names its winner."""

    LARGEST = 0
    NEAREST_TO_ZERO = 1
    FIRST_POSITIVE = 2
    VOTE = 3


def rule_of(layout: Layout) -> tuple[Rule, Table] | None:
    """Return the rule of a layout and what it looks up; None for a layout that is not built in.

    For a decision list that is the column of each class in order of the list, shape (M, 1), for
    one-against-one the classes of each column, shape (V, 2); the others look nothing up.
    """
    kind = type(layout)  # not isinstance: a subclass may decide otherwise
    nothing = np.empty((0, 1), dtype=np.int64)
    if kind in (OneAgainstAll, Probabilities):
        return Rule.LARGEST, nothing
    if kind is ModifiedOneAgainstAll:
        return Rule.NEAREST_TO_ZERO, nothing
    if isinstance(layout, DecisionList) and kind is DecisionList:
        return Rule.FIRST_POSITIVE, layout.places.astype(np.int64).reshape(-1, 1)
    if isinstance(layout, OneAgainstOne) and kind is OneAgainstOne:
        return Rule.VOTE, np.array(layout.pairs, dtype=np.int64)
    return None


@njit(cache=True, nogil=True)
def recognised(
    outputs: Array, weights: Array, codes: Array, classes: int, rule: int, table: Array
) -> Any:
    """Count the samples of each class that each weighting recognises.

    Parameters
    ----------
    outputs : ndarray of float64, shape (n, T, V)
        Of T cues.
    weights : ndarray of float64, shape (T, G)
        G weightings; a few hundred at a time stay in the processor's cache.
    codes : ndarray of int64, shape (n,)
        Class of each sample, 0 to M - 1.
    classes : int
        M.
    rule, table
        See :func:`rule_of`.

    Returns
    -------
    ndarray of int64, shape (M, G)
    """
    n, _, columns = outputs.shape
    number = weights.shape[1]
    counts = np.zeros((classes, number), dtype=np.int64)
    total, wins = np.empty((columns, number)), np.empty(number, dtype=np.bool_)
    votes = np.empty((classes, number), dtype=np.int64)
    for s in range(n):
        for v in range(columns):
            _add_up(total[v], outputs[s, :, v], weights)
        code = codes[s]
        if rule == 0:
            _is_largest(wins, total, code)
        elif rule == 1:
            _is_nearest_to_zero(wins, total, code)
        elif rule == 2:
            _is_first_positive(wins, total, code, table)
        else:
            _has_most_votes(wins, total, code, table, votes)
        count = counts[code]
        for g in range(number):
            count[g] += wins[g]
    return counts


@njit(cache=True, nogil=True)
def _add_up(total: Array, outputs: Array, weights: Array) -> None:
    """Set the sum of a column under each weighting, rounded as by ``weighted_sum``."""
    for t in range(len(outputs)):
        output, row = outputs[t], weights[t]
        if t == 0:
            for g in range(len(total)):
                total[g] = row[g] * output
        else:
            for g in range(len(total)):
                total[g] += row[g] * output


@njit(cache=True, nogil=True)
def _is_largest(wins: Array, total: Array, code: int) -> None:
    """Tell where the class has the largest sum; of equals the first has."""
    wins[:] = True
    own = total[code]
    for j in range(len(total)):
        other = total[j]
        if j < code:
            for g in range(len(wins)):
                wins[g] &= other[g] < own[g]
        elif j > code:
            for g in range(len(wins)):
                wins[g] &= other[g] <= own[g]


@njit(cache=True, nogil=True)
def _is_nearest_to_zero(wins: Array, total: Array, code: int) -> None:
    """Tell where the class has the sum nearest to 0; of equals the first has."""
    wins[:] = True
    own = total[code]
    for j in range(len(total)):
        other = total[j]
        if j < code:
            for g in range(len(wins)):
                wins[g] &= abs(other[g]) > abs(own[g])
        elif j > code:
            for g in range(len(wins)):
                wins[g] &= abs(other[g]) >= abs(own[g])


@njit(cache=True, nogil=True)
def _is_first_positive(wins: Array, total: Array, code: int, places: Array) -> None:
    """Tell where the class is the first of a list above 0, or the last when none is."""
    wins[:] = True
    for k in range(len(places) - 1):
        place = places[k, 0]
        row = total[place]
        if place == code:
            for g in range(len(wins)):
                wins[g] &= row[g] > 0
            return
        for g in range(len(wins)):
            wins[g] &= row[g] <= 0


@njit(cache=True, nogil=True)
def _has_most_votes(wins: Array, total: Array, code: int, pairs: Array, votes: Array) -> None:
    """Tell where the class has the most votes of all pairs; ties go on to :func:`_wins_tie`."""
    votes[:] = 0
    for v in range(len(pairs)):
        row, first, second = total[v], votes[pairs[v, 0]], votes[pairs[v, 1]]
        for g in range(len(wins)):
            first[g] += row[g] > 0
            second[g] += row[g] < 0
    own, most = votes[code], np.zeros(len(wins), dtype=np.int64)
    second, worst = np.empty(len(votes), dtype=np.int64), np.empty(len(votes))
    for j in range(len(votes)):
        if j != code:
            other = votes[j]
            for g in range(len(wins)):
                most[g] = max(most[g], other[g])
    for g in range(len(wins)):
        wins[g] = own[g] > most[g]
        if own[g] == most[g]:
            wins[g] = _wins_tie(total[:, g], code, pairs, votes[:, g], second, worst)


@njit(cache=True, nogil=True)
def _wins_tie(
    total: Array, code: int, pairs: Array, votes: Array, second: Array, worst: Array
) -> bool:
    """Tell whether a class that has most votes wins among those that have as many.

    By a vote among them, then by the least bad lost margin, of equals the last. ``second`` and
    ``worst``, of shape (M,), are room to work in.
    """
    most = votes[code]
    second[:] = 0
    worst[:] = np.inf
    for v in range(len(pairs)):
        i, j = pairs[v, 0], pairs[v, 1]
        if votes[i] == most and votes[j] == most:
            second[i] += total[v] > 0
            second[j] += total[v] < 0
    for v in range(len(pairs)):
        i, j = pairs[v, 0], pairs[v, 1]
        if votes[i] == most and votes[j] == most and second[i] == second[j]:
            worst[i] = min(worst[i], total[v])
            worst[j] = min(worst[j], -total[v])
    for j in range(len(votes)):
        if votes[j] != most or j == code:
            continue
        if second[j] > second[code]:
            return False
        level = second[j] == second[code]
        if level and (worst[j] > worst[code] or (worst[j] == worst[code] and j > code)):
            return False
    return True
