"""Weightings of cues: the points of a grid over the simplex."""

from __future__ import annotations

from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError

Counts = NDArray[np.int64]
#: More weightings than this are no longer searched in a minute or so.
MOST = 500_000


def steps_of(step: float) -> int:
    """Return into how many steps a weight of 1 is cut.

    Raises
    ------
    UsageError
        If they are no whole number.
    """
    steps = round(1 / step)
    if abs(steps * step - 1) > 1e-9:
        near = ", ".join(f"{1 / number:g}" for number in (steps + 1, max(steps, 1)))
        raise UsageError(f"step is {step:g}, which does not part 1 evenly; give one such as {near}")
    return steps


def simplex(cues: int, steps: int) -> Counts:
    """Return all ways to share ``steps`` equal parts of weight out among cues.

    Parameters
    ----------
    cues : int
        T, 1 or more.
    steps : int
        1 or more.

    Returns
    -------
    ndarray of int64, shape (G, T)
        Each row sums to ``steps``; the earlier rows have more weight on the earlier cues.

    Raises
    ------
    UsageError
        If there are too many of them to try.
    """
    number = comb(steps + cues - 1, cues - 1)
    if number > MOST:
        raise UsageError(
            f"step={1 / steps:g} gives {number} weightings of {cues} cues, and more than {MOST} "
            "are not tried: give a larger step, weights=equal, or weights of your own"
        )
    # Stars and bars: T - 1 bars among the steps; a weight is the gap between two bars.
    slots = steps + cues - 1
    bars = np.array(list(combinations(range(slots), cues - 1)), dtype=np.int64)
    bars = bars.reshape(number, cues - 1)
    ends = np.full((number, 1), -1), bars, np.full((number, 1), slots)
    return np.asarray((np.diff(np.hstack(ends), axis=1) - 1)[::-1])


def most_even(counts: Counts) -> int:
    """Return the row whose weights are the most even, the first of equals.

    The most even weights have the smallest sum of squares: they are the nearest to equal weights.
    """
    return int(np.argmin((counts**2).sum(axis=1)))
