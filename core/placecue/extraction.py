"""How features come from observations: straight from the cues, or from where they were kept."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

from placecue.cue import Cue
from placecue.features import FeatureBatch, Features
from placecue.observation import Observation, Origin
from placecue.source import Source

AnyCue = TypeVar("AnyCue", bound=Cue)


class Extraction:
    """Asks the cues, every time. A feature cache is a subclass that asks them once."""

    def following(self, source: Source) -> Source:
        """Return a log whose observations can be told apart by :attr:`Observation.origin`."""
        return source

    def features(self, cue: Cue, observation: Observation) -> Features:
        """Return the features of one observation; see :meth:`Cue.features`."""
        return cue.features(observation)

    def transform(self, cue: Cue, observations: Iterable[Observation]) -> FeatureBatch:
        """Return the features of several observations; see :meth:`Cue.transform`."""
        return cue.transform(observations)

    def fit(
        self,
        cue: AnyCue,
        observations: Iterable[Observation],
        labels: Any,
        origins: Sequence[Origin | None],
    ) -> AnyCue:
        """Fit a cue that learns, and return it; see :meth:`Cue.fit`.

        Parameters
        ----------
        cue : Cue
            What to fit.
        observations : iterable of n observations
            What to fit it on.
        labels : ndarray of str, shape (n,)
            Their classes.
        origins : sequence of n origins
            Where they come from, known without reading them again.
        """
        return cue.fit(observations, labels)
