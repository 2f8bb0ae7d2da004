"""How far a balanced accuracy can be trusted where frames come in scenes.

Frames of a scene are near-copies, so that not frames but scenes are drawn anew: of each class as
many as it has, with replacement. All methods are judged on the same draws, so that the interval of
a difference of two is narrower than those of both.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


class SceneBootstrap:
    """Draws of the scenes of n samples.

    Parameters
    ----------
    truth : array of str, shape (n,)
        Their classes.
    scenes : array, shape (n,)
        Their scenes; one that has several classes is drawn for each by itself.
    draws : int
        How often scenes are drawn.
    seed : int
        Of the random numbers.
    """

    def __init__(
        self, truth: ArrayLike, scenes: ArrayLike, draws: int = 10_000, seed: int = 0
    ) -> None:
        self.truth, self.scenes = np.asarray(truth), np.asarray(scenes)
        generator = np.random.default_rng(seed)
        #: For each class its rows, the scene of each, and how often a draw holds each scene.
        self.classes: list[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]] = []
        for name in np.unique(self.truth):
            rows = np.flatnonzero(self.truth == name)
            names, scene = np.unique(self.scenes[rows], return_inverse=True)
            even = np.full(len(names), 1 / len(names))
            times = generator.multinomial(len(names), even, size=draws)
            self.classes.append((rows, scene, times))

    def accuracies(self, predicted: ArrayLike) -> NDArray[np.float64]:
        """Return the balanced accuracy in each draw, shape (draws,), percent."""
        right = np.asarray(predicted) == self.truth
        recalls = [
            (times @ np.bincount(scene, right[rows])) / (times @ np.bincount(scene))
            for rows, scene, times in self.classes
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
