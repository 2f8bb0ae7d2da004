"""How far a balanced accuracy can be trusted where samples come in groups.

Frames of a scene are near-copies, so that not frames but scenes are drawn anew: of each class as
many as it has, with replacement (a cluster bootstrap). All methods are judged on the same draws,
so that the interval of a difference of two is narrower than those of both.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


class GroupBootstrap:
    """Draws of the groups of n samples.

    Parameters
    ----------
    truth : array of str, shape (n,)
        Their classes.
    groups : array, shape (n,)
        Their scenes, or recordings; one that has several classes is drawn for each by itself.
    draws : int
        How often groups are drawn.
    seed : int
        Of the random numbers.
    """

    def __init__(
        self, truth: ArrayLike, groups: ArrayLike, draws: int = 10_000, seed: int = 0
    ) -> None:
        self.truth, self.groups = np.asarray(truth), np.asarray(groups)
        generator = np.random.default_rng(seed)
        #: For each class its rows, the group of each, and how often a draw holds each group.
        self.classes: list[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]] = []
        for name in np.unique(self.truth):
            rows = np.flatnonzero(self.truth == name)
            names, group = np.unique(self.groups[rows], return_inverse=True)
            even = np.full(len(names), 1 / len(names))
            times = generator.multinomial(len(names), even, size=draws)
            self.classes.append((rows, group, times))

    @property
    def smallest(self) -> int:
        """How many groups the class has that has fewest; 0 of no sample."""
        return min((times.shape[1] for *_, times in self.classes), default=0)

    def accuracies(self, predicted: ArrayLike) -> NDArray[np.float64]:
        """Return the balanced accuracy in each draw, shape (draws,), percent."""
        right = np.asarray(predicted) == self.truth
        recalls = [
            (times @ np.bincount(group, right[rows])) / (times @ np.bincount(group))
            for rows, group, times in self.classes
        ]
        return np.asarray(100 * np.mean(recalls, axis=0))

    def interval(self, predicted: ArrayLike, level: float = 95.0) -> tuple[float, float]:
        """Return the interval that holds ``level`` percent of the draws' balanced accuracies."""
        return _interval(self.accuracies(predicted), level)

    def difference(
        self, predicted: ArrayLike, other: ArrayLike, level: float = 95.0
    ) -> tuple[float, float]:
        """Return that of the balanced accuracy of one method less that of another."""
        return _interval(self.accuracies(predicted) - self.accuracies(other), level)

    def error(self, predicted: ArrayLike) -> float:
        """Return the standard error of a balanced accuracy, percent points."""
        return float(self.accuracies(predicted).std())


def _interval(values: NDArray[np.float64], level: float) -> tuple[float, float]:
    tail = (100 - level) / 2
    low, high = np.percentile(values, [tail, 100 - tail])
    return float(low), float(high)
