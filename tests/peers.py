"""What integrators are compared with: scikit-learn's own on the same scores, side by side."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin


class Columns(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """A classifier of scikit-learn whose outputs are some columns of its input: one cue."""

    def __init__(self, first: int = 0, end: int = 0) -> None:
        self.first, self.end = first, end

    def fit(self, joined: np.ndarray, labels: np.ndarray) -> Columns:
        self.classes_ = np.unique(labels)
        return self

    def predict_proba(self, joined: np.ndarray) -> np.ndarray:
        return joined[:, self.first : self.end]

    def predict(self, joined: np.ndarray) -> np.ndarray:
        return self.classes_[self.predict_proba(joined).argmax(axis=1)]


def side_by_side(values: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the outputs of all cues as one array."""
    return np.hstack(list(values.values()))
