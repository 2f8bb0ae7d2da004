"""Which moments of a log are most worth labelling: unsure ones, unlike each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from placecue.belief import Belief
from placecue.extraction import BATCH, batched
from placecue.features import FeatureKind, kind_of
from placecue.observation import Observation
from placecue.pipeline import Pipeline
from placecue.scaling import StandardScaling, unit_length

Matrix = NDArray[np.float64]

#: What a moment counts for that the model is sure of, against 1 for the least sure one.
SURE = 0.1


def looked_at(
    pipeline: Pipeline, observations: Iterable[Observation]
) -> Iterator[tuple[Observation, Belief, NDArray[np.float32]]]:
    """Yield each usable observation with its belief and what describes it, shape (d,).

    That is the dense features of the cues that it has, else its scores.
    """
    for pairs in batched(pipeline.follow(observations, BATCH), BATCH):
        told = [(observation, belief) for observation, belief in pairs if belief is not None]
        described = _described(pipeline, [observation for observation, _ in told])
        for (observation, belief), own in zip(told, described, strict=True):
            looks = own or [belief.scores.layout.preference(belief.scores.values)[0]]
            yield observation, belief, np.concatenate(looks).astype(np.float32)


def choose(confidence: Matrix, described: Matrix, count: int) -> list[int]:
    """Return which of n moments to label, the most worthwhile first.

    The first is the least sure one; each next one has the largest product of how unsure the model
    is (by rank: 1 for the least sure, 0.1 for the surest) and how far it lies from those that are
    chosen.

    Parameters
    ----------
    confidence : ndarray, shape (n,)
    described : ndarray, shape (n, d)
        What each looks like; scaled here.
    count : int
        How many; fewer where there are no more that differ.

    References
    ----------
    Coverage as in Sener and Savarese, Active learning for convolutional neural networks: a
    core-set approach, ICLR 2018, weighted by uncertainty.
    """
    n = len(confidence)
    ranks = np.argsort(np.argsort(confidence, kind="stable"), kind="stable")
    unsure = 1 - (1 - SURE) * ranks / max(n - 1, 1)
    looks = unit_length(StandardScaling().fit(described).transform(described))
    chosen = [int(np.argmax(unsure))]
    far = np.linalg.norm(looks - looks[chosen[0]], axis=1)
    while len(chosen) < min(count, n):
        best = int(np.argmax(unsure * far))
        if not far[best] > 0:
            break
        chosen.append(best)
        far = np.minimum(far, np.linalg.norm(looks - looks[best], axis=1))
    return chosen


def _described(pipeline: Pipeline, batch: list[Observation]) -> list[list[Matrix]]:
    """Return the dense features of each observation, a vector a cue; none where one is missing."""
    made: list[list[Matrix]] = [[] for _ in batch]
    for model in pipeline.cues.values():
        found = pipeline.extraction.extract(model.cue, batch, skip=True)
        if found.features is not None and kind_of(found.features) is FeatureKind.DENSE:
            vectors = np.asarray(found.features, dtype=np.float64)
            for row, vector in zip(found.rows, vectors, strict=True):
                made[row].append(vector)
    return made
