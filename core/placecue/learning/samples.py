"""Labelled training samples: the features of every cue, read from observations in one pass."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from placecue.cue import Alteration, Cue
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.extraction import Extraction
from placecue.features import FeatureBatch, Features, join, stack, take
from placecue.folds import Rows
from placecue.observation import Observation, Origin, Part
from placecue.progress import track
from placecue.skipped import Skipped
from placecue.source import guarded


@dataclass(frozen=True)
class CueSamples:
    """The features of n samples by one cue.

    Parameters
    ----------
    features : batch of n samples
        Of the observations as recorded.
    altered : tuple of batches of n samples
        Of their copies for training, a batch an alteration.
    """

    features: FeatureBatch
    altered: tuple[FeatureBatch, ...] = ()

    def training(
        self, labels: NDArray[np.str_], stamps: NDArray[np.int64] | None, rows: Rows | None = None
    ) -> tuple[FeatureBatch, NDArray[np.str_], NDArray[np.int64] | None]:
        """Return features, labels and stamps to train on.

        Parameters
        ----------
        labels : ndarray of str, shape (n,)
        stamps : ndarray of int64, shape (n,), or None
        rows : ndarray of int64, optional
            Which samples to train on; all by default. Each is followed by its altered copies, so
            that folds do not part them.
        """
        rows = np.arange(len(labels)) if rows is None else rows
        views = (self.features, *self.altered)
        if len(views) == 1:
            batch = take(self.features, rows)
        else:
            order = np.arange(len(rows) * len(views)).reshape(len(views), -1).T.ravel()
            batch = take(join([take(view, rows) for view in views]), order)
            rows = np.repeat(rows, len(views))
        return batch, labels[rows], None if stamps is None else stamps[rows]


#: Features of all samples by a copy of a cue that has learned from the given ones only.
LearnedFrom: TypeAlias = Callable[[Rows], CueSamples]


@dataclass(frozen=True)
class Samples:
    """n labelled samples.

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        The class of each sample.
    stamps : ndarray of int64, shape (n,)
        The time of each sample, ns.
    extracted : mapping of str to CueSamples
        For each cue that learns nothing, its features.
    observations : iterable of Observation
        Where the samples came from; read again for cues that learn.
    positions : ndarray of int64, shape (n,)
        Which of the observations are the samples.
    origins : sequence of n origins
        Where the samples come from, if that is known.
    extraction : Extraction
        How features come from observations.
    """

    labels: NDArray[np.str_]
    stamps: NDArray[np.int64]
    extracted: Mapping[str, CueSamples]
    observations: Iterable[Observation]
    positions: NDArray[np.int64]
    origins: list[Origin | None]
    extraction: Extraction

    def __len__(self) -> int:
        return len(self.labels)

    def reread(self, rows: Rows | None = None) -> Reread:
        """Return the observations of the given samples (all by default), to be read again."""
        return Reread(self.observations, self.positions if rows is None else self.positions[rows])

    def fit(self, cue: Cue, rows: Rows | None = None) -> None:
        """Fit a cue that learns on the given samples, all by default."""
        # They are read again in their order, and once.
        rows = np.arange(len(self)) if rows is None else np.unique(rows)
        origins = [self.origins[row] for row in rows]
        self.extraction.fit(cue, self.reread(rows), self.labels[rows], origins)

    def of_cue(self, name: str, cue: Cue) -> CueSamples:
        """Return all samples' features by a fitted cue."""
        if name in self.extracted:
            return self.extracted[name]
        transform, reread = self.extraction.transform, self.reread()
        return CueSamples(
            transform(cue, reread),
            tuple(transform(cue, map(alter, reread)) for alter in cue.alterations()),
        )

    def learned_from(self, name: str, cue: Cue, rows: Rows) -> CueSamples:
        """Return all samples' features by a copy of a cue that has learned from some of them."""
        copy: Cue = clone(cue)
        self.fit(copy, rows)
        return self.of_cue(name, copy)


@dataclass(frozen=True)
class Reread:
    """Some of a log's observations, to be iterated as often as needed."""

    observations: Iterable[Observation]
    positions: NDArray[np.int64]

    def __iter__(self) -> Iterator[Observation]:
        wanted = set(self.positions.tolist())
        return (each for number, each in enumerate(self.observations) if number in wanted)


class _Extracted:
    """Gathers the features of one cue."""

    def __init__(self, cue: Cue, extraction: Extraction) -> None:
        self.cue, self.extraction = cue, extraction
        self.views: list[Alteration | None] = [None, *cue.alterations()]
        self.kept: list[list[Features]] = [[] for _ in self.views]

    def features(self, observation: Observation) -> list[Features]:
        """Return the features of an observation and of its altered copies."""
        seen = (observation if alter is None else alter(observation) for alter in self.views)
        return [self.extraction.features(self.cue, each) for each in seen]

    def keep(self, features: list[Features]) -> None:
        for kept, each in zip(self.kept, features, strict=True):
            kept.append(each)

    def samples(self) -> CueSamples:
        recorded, *altered = map(stack, self.kept)
        return CueSamples(recorded, tuple(altered))


def collect(
    observations: Iterable[Observation],
    cues: Mapping[str, Cue],
    extraction: Extraction | None = None,
) -> Samples:
    """Read labelled observations once and extract every cue that learns nothing.

    Unlabelled observations are left out; unusable ones are passed over and reported once. No
    image is kept.

    Parameters
    ----------
    observations : iterable of Observation
        A log. Where a cue learns it must be possible to iterate it again.
    cues : mapping of str to Cue
        The cues to extract.
    extraction : Extraction, optional
        How features come from observations; by default straight from the cues.

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
    observations = guarded(observations)
    learning = [name for name, cue in cues.items() if cue.learns]
    if learning and iter(observations) is observations:
        raise UsageError(
            f"cue {', '.join(learning)} learns and reads the observations more than once: "
            "give a log or a list, not a generator"
        )
    extraction = Extraction() if extraction is None else extraction
    required: tuple[Part, ...] = tuple({part for cue in cues.values() for part in cue.requires})
    gathered = {n: _Extracted(cue, extraction) for n, cue in cues.items() if not cue.learns}
    kept: list[tuple[str, int, int, Origin | None]] = []
    skipped, labelled, total = Skipped(), 0, 0
    for number, observation in enumerate(track(observations, "extracting cues")):
        total += 1
        if observation.label is None:
            continue
        labelled += 1
        try:
            observation.require(required)
            features = {name: each.features(observation) for name, each in gathered.items()}
            if learning and "image" in required:
                _ = observation.image
        except UnusableObservation as error:
            skipped.add(error)
            continue
        for name, of_cue in features.items():
            gathered[name].keep(of_cue)
        kept.append((observation.label, observation.stamp, number, observation.origin))
    _check(labelled, total, skipped)
    labels, stamps, positions, origins = map(list, zip(*kept, strict=True))
    return Samples(
        labels=np.asarray(labels, dtype=np.str_),
        stamps=np.asarray(stamps, dtype=np.int64),
        extracted={name: each.samples() for name, each in gathered.items()},
        observations=observations,
        positions=np.asarray(positions, dtype=np.int64),
        origins=origins,
        extraction=extraction,
    )


def _check(labelled: int, total: int, skipped: Skipped) -> None:
    if not labelled:
        raise DataError(
            f"none of the {total} observations has a label: training needs a label channel, an "
            "interval CSV (labels=FILE) or a source that labels"
        )
    skipped.report(labelled)
