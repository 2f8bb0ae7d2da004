"""A fitted classifier whose answers are told in the places of a building."""

from __future__ import annotations

from typing import Never

import numpy as np
from numpy.typing import ArrayLike

from placecue.classifier import Classifier
from placecue.errors import UsageError
from placecue.features import FeatureBatch
from placecue.scores import Probabilities, Scores
from placecue.starter.places import Places


class InPlaces(Classifier):
    """Probabilities of some classes as probabilities of places.

    What a building does not have is left out, and the rest sums to one; where nothing is left,
    every place is as likely.

    Parameters
    ----------
    classifier : Classifier
        Fitted; gives probabilities.
    places : Places
        The places.
    """

    def __init__(self, classifier: Classifier, places: Places) -> None:
        self.classifier = classifier
        self.places = places
        self.layout_ = Probabilities(places.classes)

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Never:
        """Refuse: it has learned already."""
        raise UsageError("the starter has learned already: train a model (placecue train)")

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the probabilities of n samples, shape (n, places)."""
        told = self.classifier.scores(features)
        values = told.values @ self.places.shares(told.layout.classes)
        total = values.sum(axis=1, keepdims=True)
        equal = np.full(values.shape, 1 / values.shape[1])
        return Scores(np.divide(values, total, out=equal, where=total > 0), self.layout_)
