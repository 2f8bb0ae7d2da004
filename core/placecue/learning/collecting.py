"""Labelled observations, read once: the features of every cue that learns nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from placecue.cue import Augmentation, Cue
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.extraction import BATCH, Extraction, batched, joined, ready
from placecue.faults import Faults, MissingCues
from placecue.features import FeatureBatch, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.learning.augmentation import augmentations_of, augmented, told_apart
from placecue.learning.grouping import groups_of, say_parted
from placecue.learning.samples import Samples, Views, rows_in
from placecue.observation import Observation
from placecue.progress import track
from placecue.source import guarded


class _Extracted(NamedTuple):
    """What a cue makes of a batch.

    Which observations have the cue; the rows and features of each view; why others have not.
    """

    rows: Rows
    views: list[tuple[Rows, FeatureBatch | None]]
    failed: dict[int, UnusableObservation]


class _Gathered:
    """The features of one cue and of its augmentations, batch after batch.

    Of a cue that learns, which samples have what it needs.
    """

    def __init__(
        self, name: str, cue: Cue, extraction: Extraction, missing: MissingCues, *, skip: bool
    ) -> None:
        self.name, self.cue, self.extraction, self.skip = name, cue, extraction, skip
        self.views: list[Augmentation | None] = [] if cue.learns else [None, *augmentations_of(cue)]
        self.kept: list[list[FeatureBatch]] = [[] for _ in self.views]
        self.rows: list[Rows] = []
        self.missing = missing

    def extract(self, observations: Sequence[Observation]) -> _Extracted:
        """Return what the cue makes of a batch."""
        # Features that are kept need no image: only copies of it do, or a cue that learns later.
        failed = {} if len(self.views) == 1 else ready(self.cue, observations)[1]
        views = []
        if self.views[1:] and not self.kept[0] and len(failed) < len(observations):
            told_apart(self.cue, observations[_others(len(observations), failed)[0]])
        for augment in self.views:
            there = _others(len(observations), failed)
            seen = [observations[row] for row in there]
            if augment is not None:
                seen = [augmented(self.cue, augment, each) for each in seen]
            extracted = self.extraction.extract(self.cue, seen, skip=self.skip)
            views.append((there[extracted.rows], extracted.features))
            failed |= {int(there[row]): error for row, error in extracted.failed.items()}
        return _Extracted(_others(len(observations), failed), views, failed)

    def keep(self, made: _Extracted, usable: Rows, first: int) -> None:
        """Keep what was made of the usable ones of a batch, which are samples from a number on."""
        rows = np.intersect1d(made.rows, usable)
        self.rows.append(first + rows_in(usable, rows))
        for kept, (there, features) in zip(self.kept, made.views, strict=True):
            if features is not None and rows.size:
                all_there = len(rows) == len(there)
                kept.append(features if all_there else take(features, rows_in(there, rows)))
        for row in np.setdiff1d(usable, rows):
            self.missing.add(self.name, made.failed[int(row)])

    def joined(self) -> Views:
        """Return all that was kept.

        Raises
        ------
        DataError
            If no sample has the cue.
        """
        rows = np.concatenate(self.rows)
        if not rows.size:
            why = self.missing.first[self.name]
            raise DataError(
                f"no sample has cue {self.name} (the first: {why}): give a log that has what it "
                "needs, or leave out the cue"
            ) from why
        return Views(rows, tuple(joined(self.cue, batches) for batches in self.kept))


def collect(
    observations: Iterable[Observation],
    cues: Mapping[str, Cue],
    extraction: Extraction | None = None,
    folds: FoldScheme | None = None,
    *,
    skip: bool = False,
    min_cues: int = 1,
) -> Samples:
    """Read labelled observations once and extract every cue that learns nothing.

    Unlabelled observations are left out. A sample has one cue or more; what has none is passed
    over, and which cues are missing how often is reported once. No more than a batch of images is
    kept.

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
        Whether a cue is missing, too, where it fails.
    min_cues : int
        A sample that has fewer cues is passed over.

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
    missing = MissingCues()
    gathered = [_Gathered(*each, extraction, missing, skip=skip) for each in cues.items()]
    reading, kept, faults = _Labelled(observations), list[tuple[Any, ...]](), Faults()
    for some in batched(reading, BATCH):
        rows = _extract(gathered, [each for _, each in some], len(kept), faults, min_cues)
        kept += [
            (o.label, o.stamp, number, o.origin, o.scene)
            for number, o in (some[row] for row in rows)
        ]
    _check(reading, faults)
    extracted = {each.name: each.joined() for each in gathered}
    missing.report(len(kept))
    labels, stamps, positions, origins, scenes = map(list, zip(*kept, strict=True))
    samples = Samples(
        labels=np.asarray(labels, dtype=np.str_),
        stamps=np.asarray(stamps, dtype=np.int64),
        groups=groups_of(origins, scenes),
        extracted=extracted,
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


def _extract(
    gathered: Sequence[_Gathered],
    observations: Sequence[Observation],
    first: int,
    faults: Faults,
    min_cues: int,
) -> Rows:
    """Extract every cue from a batch; keep and return what becomes samples, numbered from first."""
    made = [of_cue.extract(observations) for of_cue in gathered]
    count = sum(np.isin(np.arange(len(observations)), each.rows).astype(int) for each in made)
    usable = np.flatnonzero(count >= min_cues).astype(np.int64)
    for row in np.flatnonzero(count < min_cues):
        faults.pass_over(next(each.failed[int(row)] for each in made if row in each.failed))
    for of_cue, each in zip(gathered, made, strict=True):
        of_cue.keep(each, usable, first)
    return usable


def _others(n: int, failed: Mapping[int, UnusableObservation]) -> Rows:
    """Return the rows of n that have not failed."""
    return np.array([row for row in range(n) if row not in failed], dtype=np.int64)


def _check(reading: _Labelled, faults: Faults) -> None:
    if not reading.labelled:
        raise DataError(
            f"none of the {reading.total} observations has a label: training needs a label "
            "channel, an interval CSV (labels=FILE) or a source that labels"
        )
    faults.report_of(reading.labelled)
