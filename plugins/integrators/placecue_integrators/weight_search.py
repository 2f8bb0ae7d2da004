"""The search for the weights of cues: balanced accuracy over a grid of weightings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.progress import track
from placecue.scores import Layout, Scores

from .simplex import most_even, simplex
from .winners import recognised, rule_of

Matrix = NDArray[np.float64]
Codes = NDArray[np.int64]
#: Balanced accuracies as near as this are equal: fractions that are, as sums of floats, may differ.
EQUAL = 1e-9
#: So many weightings are tried in one call: they stay in the cache, and Ctrl-C is heard between.
_AT_A_TIME = 256


def best_weights(outputs: Matrix, layout: Layout, codes: Codes, steps: int) -> tuple[Matrix, float]:
    """Return the weights with the best balanced accuracy, of equals the most even.

    Where these are equals too, those with more weight on the earlier cues.

    Parameters
    ----------
    outputs : ndarray of float64, shape (T, n, V)
        What each cue says of n held-out samples, n at least 1.
    layout : Layout
        What the V columns of each, and of their weighted sum, are.
    codes : ndarray of int64, shape (n,)
        Class of each sample.
    steps : int
        How many steps there are from 0 to 1.

    Returns
    -------
    ndarray of float64, shape (T,)
        The weights; they sum to 1.
    float
        Their balanced accuracy.
    """
    counts = simplex(len(outputs), steps)
    accuracies = balanced_accuracies(outputs, counts / steps, layout, codes)
    top = np.flatnonzero(accuracies >= accuracies.max() - EQUAL)
    best = top[most_even(counts[top])]
    return counts[best] / steps, float(accuracies[best])


def balanced_accuracies(outputs: Matrix, weights: Matrix, layout: Layout, codes: Codes) -> Matrix:
    """Return the mean recall of the classes that occur, under G weightings, shape (G,)."""
    present, sizes = np.unique(codes, return_counts=True)
    found = rule_of(layout)
    if found is None:
        right = _by_layout(outputs, weights, layout, codes)
    else:
        rule, table = found
        by_sample = np.ascontiguousarray(outputs.transpose(1, 0, 2))
        fixed = codes, len(layout.classes), int(rule), table
        parts = [weights[a : a + _AT_A_TIME] for a in range(0, len(weights), _AT_A_TIME)]
        counts = [
            recognised(by_sample, np.ascontiguousarray(part.T), *fixed)
            for part in track(parts, "searching weights")
        ]
        right = np.hstack(counts).T
    return np.asarray((right[:, present] / sizes).mean(axis=1))


def _by_layout(outputs: Matrix, weights: Matrix, layout: Layout, codes: Codes) -> Codes:
    """Return what :func:`recognised` does, asking a layout that is not built in."""
    counts = np.zeros((len(weights), len(layout.classes)), dtype=np.int64)
    for g, weighting in enumerate(track(weights, "searching weights")):
        winners = Scores(weighted_sum(weighting, outputs), layout).decide().ranking[:, 0]
        np.add.at(counts[g], codes[winners == codes], 1)
    return counts


def weighted_sum(weights: Matrix, outputs: Matrix | Sequence[Matrix]) -> Matrix:
    """Return sum_t weights[t] outputs[t], shape (n, V), added up in the order of the cues."""
    total = weights[0] * outputs[0]
    for weight, output in zip(weights[1:], outputs[1:], strict=True):
        total += weight * output
    return np.asarray(total)
