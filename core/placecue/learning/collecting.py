"""Labelled observations, read once: the features of every cue that learns nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from placecue.cue import Augmentation, Cue
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.extraction import BATCH, Extraction, batched, joined
from placecue.faults import Faults
from placecue.features import FeatureBatch, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.learning.augmentation import augmentations_of, augmented, told_apart
from placecue.learning.grouping import groups_of, say_parted
from placecue.learning.samples import Samples, rows_in
from placecue.observation import Observation, Part
from placecue.progress import track
from placecue.source import guarded


class _Gathered:
    """The features of one cue and of its augmentations, batch after batch."""

    def __init__(self, cue: Cue, extraction: Extraction, skip: bool) -> None:
        self.cue, self.extraction, self.skip = cue, extraction, skip
        self.views: list[Augmentation | None] = [None, *augmentations_of(cue)]
        self.kept: list[list[FeatureBatch]] = [[] for _ in self.views]

    def extract(
        self, observations: Sequence[Observation]
    ) -> tuple[list[tuple[Rows, FeatureBatch | None]], dict[int, UnusableObservation]]:
        """Return (rows, features) of each view, and why observations are unusable, by row."""
        found = []
        failed: dict[int, UnusableObservation] = {}
        if observations and len(self.views) > 2 and not self.kept[0]:
            told_apart(self.cue, observations[0])
        for augment in self.views:
            seen = observations
            if augment is not None:
                seen = [augmented(self.cue, augment, each) for each in observations]
            extracted = self.extraction.extract(self.cue, seen, skip=self.skip)
            found.append((extracted.rows, extracted.features))
            failed |= extracted.failed
        return found, failed

    def keep(self, found: Sequence[tuple[Rows, FeatureBatch | None]], rows: Rows) -> None:
        """Keep the features of the given rows, which every view has."""
        for kept, (there, batch) in zip(self.kept, found, strict=True):
            if batch is not None and rows.size:
                kept.append(batch if len(rows) == len(there) else take(batch, rows_in(there, rows)))

    def joined(self) -> tuple[FeatureBatch, ...]:
        return tuple(joined(self.cue, batches) for batches in self.kept)


def collect(
    observations: Iterable[Observation],
    cues: Mapping[str, Cue],
    extraction: Extraction | None = None,
    folds: FoldScheme | None = None,
    *,
    skip: bool = False,
) -> Samples:
    """Read labelled observations once and extract every cue that learns nothing.

    Unlabelled observations are left out; unusable ones are passed over and reported once. No more
    than a batch of images is kept.

    Parameters
    ----------
    observations : iterable of Observation
        A log. Where a cue learns it must be possible to iterate it again.
    cues : mapping of str to Cue
        The cues to extract.
    extraction : Extraction, optional
        How features come from observations; by default straight from the cues.
    folds : FoldScheme, optional
        How the samples will be cut.
    skip : bool
        Whether an observation at which a cue fails counts as unusable.

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
    gathered = [_Gathered(cue, extraction, skip) for cue in cues.values() if not cue.learns]
    reading, kept, faults = _Labelled(observations), list[tuple[Any, ...]](), Faults()
    for some in batched(reading, BATCH):
        usable = _usable([each for _, each in some], required, bool(learning), faults)
        seen = [some[row] for row in usable]
        rows = _extract(gathered, [each for _, each in seen], faults)
        kept += [
            (o.label, o.stamp, number, o.origin, o.scene)
            for number, o in (seen[row] for row in rows)
        ]
    _check(reading, faults)
    labels, stamps, positions, origins, scenes = map(list, zip(*kept, strict=True))
    names = (n for n, cue in cues.items() if not cue.learns)
    samples = Samples(
        labels=np.asarray(labels, dtype=np.str_),
        stamps=np.asarray(stamps, dtype=np.int64),
        groups=groups_of(origins, scenes),
        extracted={n: each.joined() for n, each in zip(names, gathered, strict=True)},
        observations=observations,
        positions=np.asarray(positions, dtype=np.int64),
        origins=origins,
        extraction=extraction,
        folds=InterleavedChunks() if folds is None else folds,
        skip=skip,
    )
    say_parted(samples.folds, samples.labels, samples.stamps, samples.groups)
    return samples


class _Labelled:
    """The labelled observations of a log with their numbers; counts all."""

    def __init__(self, observations: Iterable[Observation]) -> None:
        self.observations = observations
        self.total = self.labelled = 0

    def __iter__(self) -> Iterator[tuple[int, Observation]]:
        for number, observation in enumerate(track(self.observations, "extracting cues")):
            self.total += 1
            if observation.label is not None:
                self.labelled += 1
                yield number, observation


def _usable(
    observations: Sequence[Observation],
    required: tuple[Part, ...],
    learning: bool,
    faults: Faults,
) -> list[int]:
    """Return the observations that have every part that a cue needs."""
    rows = []
    for row, observation in enumerate(observations):
        try:
            observation.require(required)
            if learning and "image" in required:
                _ = observation.image
            rows.append(row)
        except UnusableObservation as error:
            faults.pass_over(error)
    return rows


def _extract(
    gathered: Sequence[_Gathered], observations: Sequence[Observation], faults: Faults
) -> Rows:
    """Extract every cue from a batch; keep and return the rows that all of them have."""
    found = []
    failed: dict[int, UnusableObservation] = {}
    for of_cue in gathered:
        views, unusable = of_cue.extract(observations)
        found.append(views)
        failed |= {row: error for row, error in unusable.items() if row not in failed}
    rows = np.array([row for row in range(len(observations)) if row not in failed], np.int64)
    for row in sorted(failed):
        faults.pass_over(failed[row])
    for of_cue, views in zip(gathered, found, strict=True):
        of_cue.keep(views, rows)
    return rows


def _check(reading: _Labelled, faults: Faults) -> None:
    if not reading.labelled:
        raise DataError(
            f"none of the {reading.total} observations has a label: training needs a label "
            "channel, an interval CSV (labels=FILE) or a source that labels"
        )
    faults.report_of(reading.labelled)
