"""A classifier that has a kernel, a scaling, folds and a layout of its own inside."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from everykind.layout import Unlikeness
from placecue import (
    Classifier,
    FeatureBatch,
    FoldScheme,
    Kernel,
    Scaling,
    Scores,
    UsageError,
    clone,
)


class Similar(Classifier):
    """The class to whose training samples a sample is likest on average.

    Attributes
    ----------
    accuracy_ : float
        Share of the held-out samples that are recognised; NaN without folds.
    """

    def __init__(
        self,
        kernel: Kernel | None = None,
        scaling: Scaling | None = None,
        folds: FoldScheme | None = None,
        scale: float = 1.0,
    ) -> None:
        self.kernel = kernel
        self.scaling = scaling
        self.folds = folds
        self.scale = scale

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Keep the training samples, and see how well folds of them are told apart."""
        if self.kernel is None:
            raise UsageError("similar needs a kernel, such as kernel={plugin: laplace}")
        samples = np.asarray(self.training_samples(features, labels))
        self.codes_ = self.learn_classes(labels)
        self.scaling_ = None if self.scaling is None else clone(self.scaling).fit(samples)
        self.kernel_ = clone(self.kernel)
        self.features_ = self._scaled(samples)
        self.layout_ = Unlikeness(self.class_names, self.scale)
        self.accuracy_ = self._held_out(stamps)
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return how unlike each class the samples are, shape (n, M)."""
        scaled = self._scaled(np.asarray(self.samples(features)))
        gram = self.kernel_.gram(scaled, self.features_)
        return Scores(self.scale * self._unlike(gram, self.codes_), self.layout_)

    def _scaled(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        return features if self.scaling_ is None else self.scaling_.transform(features)

    def _unlike(self, gram: NDArray[np.float64], codes: NDArray[np.int64]) -> NDArray[np.float64]:
        classes = range(len(self.class_names))
        return np.stack([1 - gram[:, codes == code].mean(axis=1) for code in classes], axis=1)

    def _held_out(self, stamps: ArrayLike | None) -> float:
        if self.folds is None:
            return float("nan")
        gram, right = self.kernel_.gram(self.features_), []
        for training, held_out in self.folds.split(self.codes_, stamps):
            unlike = self._unlike(gram[np.ix_(held_out, training)], self.codes_[training])
            right.append(unlike.argmin(axis=1) == self.codes_[held_out])
        return float(np.concatenate(right).mean())
