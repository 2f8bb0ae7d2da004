"""Labelled training samples: the features of every cue, read from observations in one pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from placecue.cue import Cue
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.features import FeatureBatch, Features, stack
from placecue.folds import Rows
from placecue.observation import Observation, Part
from placecue.progress import track
from placecue.skipped import Skipped


@dataclass(frozen=True)
class Samples:
    """n labelled samples.

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        The class of each sample.
    stamps : ndarray of int64, shape (n,)
        The time of each sample, ns.
    features : mapping of str to batch of n samples
        For each cue that learns nothing, its features.
    observations : iterable of Observation
        Where the samples came from; read again for cues that learn.
    positions : ndarray of int64, shape (n,)
        Which of the observations are the samples.
    """

    labels: NDArray[np.str_]
    stamps: NDArray[np.int64]
    features: Mapping[str, FeatureBatch]
    observations: Iterable[Observation]
    positions: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.labels)

    def reread(self, rows: Rows | None = None) -> Reread:
        """Return the observations of the given samples (all by default), to be read again."""
        return Reread(self.observations, self.positions if rows is None else self.positions[rows])

    def features_of(self, name: str, cue: Cue) -> FeatureBatch:
        """Return all samples' features by a fitted cue."""
        return self.features[name] if name in self.features else cue.transform(self.reread())

    def features_learned_from(self, name: str, cue: Cue, rows: Rows) -> FeatureBatch:
        """Return all samples' features by a copy of a cue that has learned from some of them."""
        if not cue.learns:
            return self.features[name]
        learned: Cue = clone(cue).fit(self.reread(rows), self.labels[rows])
        return learned.transform(self.reread())


@dataclass(frozen=True)
class Reread:
    """Some of a log's observations, to be iterated as often as needed."""

    observations: Iterable[Observation]
    positions: NDArray[np.int64]

    def __iter__(self) -> Iterator[Observation]:
        wanted = set(self.positions.tolist())
        return (each for number, each in enumerate(self.observations) if number in wanted)


def collect(observations: Iterable[Observation], cues: Mapping[str, Cue]) -> Samples:
    """Read labelled observations once and extract every cue that learns nothing.

    Unlabelled observations are left out; unusable ones are passed over and reported once. No
    image is kept.

    Parameters
    ----------
    observations : iterable of Observation
        A log. Where a cue learns it must be possible to iterate it again.
    cues : mapping of str to Cue
        The cues to extract.

    Returns
    -------
    Samples

    Raises
    ------
    DataError
        If no observation has a label or none is usable.
    UsageError
        If a cue learns and ``observations`` can be iterated only once.
    """
    learning = [name for name, cue in cues.items() if cue.learns]
    if learning and iter(observations) is observations:
        raise UsageError(
            f"cue {', '.join(learning)} learns and reads the observations more than once: "
            "give a log or a list, not a generator"
        )
    required: tuple[Part, ...] = tuple({part for cue in cues.values() for part in cue.requires})
    extracted: dict[str, list[Features]] = {n: [] for n, cue in cues.items() if not cue.learns}
    labels, stamps, positions = [], [], []
    skipped, labelled, total = Skipped(), 0, 0
    for number, observation in enumerate(track(observations, "extracting cues")):
        total += 1
        if observation.label is None:
            continue
        labelled += 1
        try:
            observation.require(required)
            features = {name: cues[name].features(observation) for name in extracted}
            if learning and "image" in required:
                _ = observation.image
        except UnusableObservation as error:
            skipped.add(error)
            continue
        for name, of_cue in features.items():
            extracted[name].append(of_cue)
        labels.append(observation.label)
        stamps.append(observation.stamp)
        positions.append(number)
    if not labelled:
        raise DataError(
            f"none of the {total} observations has a label: training needs a label channel, an "
            "interval CSV (labels=FILE) or a source that labels"
        )
    skipped.report(labelled)
    return Samples(
        labels=np.asarray(labels, dtype=np.str_),
        stamps=np.asarray(stamps, dtype=np.int64),
        features={name: stack(of_cue) for name, of_cue in extracted.items()},
        observations=observations,
        positions=np.asarray(positions, dtype=np.int64),
    )
