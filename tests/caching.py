"""Cues that count what they are asked for, and features through a cache of their own."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
from scipy import sparse

import toys
from placecue import Cue, DescriptorSets, FeatureParts, Observation, UnusableObservation
from placecue.learning.collecting import collect
from placecue.storage.feature_cache import FeatureCache
from toys import Brightness, Walk

REGISTRY = toys.registry()
CALLS: Counter[str] = Counter()
SAMPLES = 4 * 20 * 4


class Counting(Cue):
    """The beams as features of any kind; counts what it is asked for."""

    requires = ("scan",)

    def __init__(self, kind: str = "dense", factor: float = 1.0) -> None:
        self.kind = kind
        self.factor = factor

    def extract(self, observation: Observation) -> object:
        CALLS["extract"] += 1
        assert observation.scan is not None
        beams = self.factor * observation.scan.filled()
        if self.kind == "sparse":
            return sparse.csr_array(np.where(beams > 3, beams, 0)[None])
        if self.kind == "descriptors":
            return beams[: int(beams[0] * 2)].reshape(-1, 1).repeat(3, axis=1).astype(np.float32)
        return beams


class Picky(Counting):
    """Cannot use every third scan."""

    def extract(self, observation: Observation) -> object:
        if observation.stamp // (toys.SECOND // 5) % 3 == 0:
            CALLS["extract"] += 1
            raise UnusableObservation(f"nothing to see at {observation.stamp}")
        return super().extract(observation)


class Learning(Brightness):
    """Counts how often it learns and looks."""

    def fit(self, observations, labels=None):  # type: ignore[no-untyped-def]
        CALLS["fit"] += 1
        return super().fit(observations, labels)

    def extract(self, observation: Observation) -> np.ndarray:
        CALLS["extract"] += 1
        return super().extract(observation)


def extracted(folder: Path | None, cue: Cue, log: Walk | None = None) -> object:
    """The features of a walk, through a cache of its own or without one."""
    log = Walk() if log is None else log
    if folder is None:
        return collect(log, {"cue": cue}).extracted["cue"].features[0]
    with FeatureCache(folder, REGISTRY) as cache:
        return collect(log, {"cue": cue}, cache).extracted["cue"].features[0]


def same(a: object, b: object) -> bool:
    if isinstance(a, FeatureParts):
        assert isinstance(b, FeatureParts)
        return list(a.parts) == list(b.parts) and all(
            same(part, b.parts[name]) for name, part in a.parts.items()
        )
    if isinstance(a, DescriptorSets):
        assert isinstance(b, DescriptorSets)
        return np.array_equal(a.offsets, b.offsets) and same(a.values, b.values)
    if sparse.issparse(a):
        return same(a.toarray(), b.toarray()) and a.nnz == b.nnz
    return a.dtype == b.dtype and np.array_equal(a, b)


def shards(folder: Path) -> list[Path]:
    return sorted(folder.glob("*/*/*.npz"))
