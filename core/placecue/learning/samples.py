"""Labelled training samples: the features of every cue, read from observations in one pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue import contracts
from placecue.cue import Augmentation, Cue
from placecue.errors import ContractError, DataError, UnusableObservation, UsageError
from placecue.estimator import clone
from placecue.extraction import BATCH, Extracted, Extraction, batched, joined
from placecue.faults import Faults
from placecue.features import FeatureBatch, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.guard import call, step
from placecue.observation import Observation, Origin, Part
from placecue.ownership import provenance
from placecue.progress import track
from placecue.source import guarded
from placecue.training_set import TrainingSet


@dataclass(frozen=True)
class Samples:
    """n labelled samples.

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        The class of each sample.
    stamps : ndarray of int64, shape (n,)
        The time of each sample, ns.
    groups : ndarray of int64, shape (n,), or None
        The log of each sample, as a number, where that is known.
    extracted : mapping of str to (recorded, augmented) features
        For each cue that learns nothing.
    observations : iterable of Observation
        Where the samples came from; read again for cues that learn.
    positions : ndarray of int64, shape (n,)
        Which of the observations are the samples.
    origins : sequence of n origins
        Where the samples come from, if that is known.
    extraction : Extraction
        How features come from observations.
    folds : FoldScheme
        How the samples are cut by whoever has no scheme of its own.
    skip : bool
        Whether a sample at which a cue that has learned fails counts as unusable.
    part : bool
        Whether these are some of the samples that the folds were chosen for; see
        :class:`placecue.TrainingSet`.
    """

    labels: NDArray[np.str_]
    stamps: NDArray[np.int64]
    groups: NDArray[np.int64] | None
    extracted: Mapping[str, tuple[FeatureBatch, ...]]
    observations: Iterable[Observation]
    positions: NDArray[np.int64]
    origins: Sequence[Origin | None]
    extraction: Extraction
    folds: FoldScheme = field(default_factory=InterleavedChunks)
    skip: bool = False
    part: bool = False
    _known: dict[str, tuple[Cue, TrainingSet, Rows]] = field(default_factory=dict, repr=False)
    #: The cues of which it is said already that they could not use some samples.
    _said: set[str] = field(default_factory=set, repr=False)

    def __len__(self) -> int:
        return len(self.labels)

    def take(self, rows: Rows) -> Samples:
        """Return some of the samples."""
        return replace(
            self,
            labels=self.labels[rows],
            stamps=self.stamps[rows],
            groups=None if self.groups is None else self.groups[rows],
            extracted={
                name: tuple(take(view, rows) for view in views)
                for name, views in self.extracted.items()
            },
            positions=self.positions[rows],
            origins=[self.origins[row] for row in rows],
            part=self.part or len(rows) < len(self),
            _known={},
        )

    def training_set(self, name: str, cue: Cue) -> TrainingSet:
        """Return what the classifier of a cue is trained on.

        A cue that learns is fitted first, once: later calls with it return the same set. Samples
        of which it then makes nothing are left out, and it is said.
        """
        return self._training(name, cue)[0]

    def trained_on(self, name: str, cue: Cue) -> Rows:
        """Return which of the samples :meth:`training_set` holds."""
        return self._training(name, cue)[1]

    def features(self, name: str, cue: Cue) -> Extracted:
        """Return the features of the samples as recorded, by a cue that has learned elsewhere.

        Those of which it makes nothing are said.

        Raises
        ------
        DataError
            If it makes nothing of any.
        """
        if not cue.learns:
            return Extracted(np.arange(len(self)), self.extracted[name][0])
        found = self.extraction.gather(cue, self.reread(), skip=self.skip)
        self._report(name, found.failed)
        return found

    def reread(self, rows: Rows | None = None) -> Reread:
        """Return the observations of the given samples (all by default), to be read again."""
        return Reread(self.observations, self.positions if rows is None else self.positions[rows])

    def relearned(self, cue: Cue, rows: Rows) -> TrainingSet:
        """Return all samples as a copy of a cue sees them that has learned from some."""
        copy: Cue = clone(cue)
        self._learn(copy, rows)
        views = []
        for found in self._views(copy):
            for error in found.failed.values():
                raise error
            assert found.features is not None  # or all had failed
            views.append(found.features)
        return self._seen(cue, views)

    def _training(self, name: str, cue: Cue) -> tuple[TrainingSet, Rows]:
        known = self._known.get(name)
        if known is None or known[0] is not cue:
            found = self._learned(name, cue) if cue.learns else self._extracted(name)
            known = self._known[name] = cue, *found
        return known[1:]

    def _extracted(self, name: str) -> tuple[TrainingSet, Rows]:
        return self._set(*self.extracted[name]), np.arange(len(self))

    def _learned(self, name: str, cue: Cue) -> tuple[TrainingSet, Rows]:
        """Let a cue learn, and return the samples of which it makes something in every view."""
        self._learn(cue, np.arange(len(self)))
        found = self._views(cue)
        failed = {row: error for each in found for row, error in each.failed.items()}
        self._report(name, failed)
        rows = np.array([row for row in range(len(self)) if row not in failed], dtype=np.int64)
        there = [
            take(each.features, _in(each.rows, rows)) for each in found if each.features is not None
        ]
        return (self.take(rows) if failed else self)._seen(cue, there), rows

    def _report(self, name: str, failed: Mapping[int, UnusableObservation]) -> None:
        """Say of how many samples a cue makes nothing, once a cue."""
        faults = Faults(f"cue {name}")
        for row in sorted(failed):
            faults.pass_over(failed[row])
        if name not in self._said or len(failed) == len(self):
            faults.report_of(len(self))
        if failed:
            self._said.add(name)

    def _learn(self, cue: Cue, rows: Rows) -> None:
        rows = np.unique(rows)  # they are read again in their order, and once
        origins = [self.origins[row] for row in rows]
        self.extraction.fit(cue, self.reread(rows), self.labels[rows], origins)

    def _views(self, cue: Cue) -> list[Extracted]:
        """Return what a cue makes of the samples as recorded, and of their augmented copies."""
        gather, reread = self.extraction.gather, self.reread()
        if len(augmentations_of(cue)) > 1:
            told_apart(cue, next(iter(reread)))
        recorded = gather(cue, reread, skip=self.skip)
        altered = (partial(augmented, cue, augment) for augment in augmentations_of(cue))
        return [recorded, *(gather(cue, map(each, reread), skip=self.skip) for each in altered)]

    def _seen(self, cue: Cue, views: Sequence[FeatureBatch]) -> TrainingSet:
        return replace(self._set(*views), relearn=partial(self.relearned, cue))

    def _set(self, recorded: FeatureBatch, *augmented: FeatureBatch) -> TrainingSet:
        return TrainingSet(
            recorded,
            self.labels,
            self.stamps,
            self.groups,
            augmented,
            folds=self.folds,
            part=self.part,
        )


@dataclass(frozen=True)
class Reread:
    """Some of a log's observations, to be iterated as often as needed."""

    observations: Iterable[Observation]
    positions: NDArray[np.int64]

    def __iter__(self) -> Iterator[Observation]:
        wanted = set(self.positions.tolist())
        return (each for number, each in enumerate(self.observations) if number in wanted)


def augmentations_of(cue: Cue) -> Sequence[Augmentation]:
    """Return the augmentations of a cue, checked."""
    made: Sequence[Augmentation] = call(cue, "augmentations", check=contracts.augmentations)
    return made


def augmented(cue: Cue, augment: Augmentation, observation: Observation) -> Observation:
    """Return what an augmentation of a cue makes of an observation, checked."""

    def check(made: Any) -> str | None:
        return contracts.observation(made) or _said_altered(made, observation)

    made: Observation = step(cue, "augmentation", augment, observation, check=check, at=observation)
    return made


def _said_altered(made: Observation, recorded: Observation) -> str | None:
    """Check that what is unlike the recorded observation says so: kept features go by that."""
    same = made.scan is recorded.scan and made.image_source is recorded.image_source
    if same or made.origin is None or made.origin != recorded.origin:
        return None
    return "returned other parts as if they were recorded: make copies with altered(how, ...)"


def told_apart(cue: Cue, observation: Observation) -> None:
    """Raise ContractError if two augmentations of a cue give their copies one name."""
    made = [augmented(cue, augment, observation) for augment in cue.augmentations()]
    names = [each.origin.altered for each in made if each.origin is not None]
    for name in filter(None, names):
        if names.count(name) > 1:
            raise ContractError(
                f"{provenance(cue)}: {names.count(name)} augmentations call their copies "
                f"'{name}': give each a name of its own in altered(how, ...)"
            )


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
                kept.append(batch if len(rows) == len(there) else take(batch, _in(there, rows)))

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
        kept += [(o.label, o.stamp, number, o.origin) for number, o in (seen[row] for row in rows)]
    _check(reading, faults)
    labels, stamps, positions, origins = map(list, zip(*kept, strict=True))
    names = (n for n, cue in cues.items() if not cue.learns)
    return Samples(
        labels=np.asarray(labels, dtype=np.str_),
        stamps=np.asarray(stamps, dtype=np.int64),
        groups=_groups(origins),
        extracted={n: each.joined() for n, each in zip(names, gathered, strict=True)},
        observations=observations,
        positions=np.asarray(positions, dtype=np.int64),
        origins=origins,
        extraction=extraction,
        folds=InterleavedChunks() if folds is None else folds,
        skip=skip,
    )


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


def _in(there: Rows, rows: Rows) -> Rows:
    """Return where the given rows stand among those that are there."""
    return np.searchsorted(there, rows).astype(np.int64)


def _groups(origins: Sequence[Origin | None]) -> NDArray[np.int64] | None:
    """Return the log of each sample as a number; None where that is not known of all."""
    logs = [origin.log for origin in origins if origin is not None]
    if len(logs) < len(origins):
        return None
    return np.unique(logs, return_inverse=True)[1].astype(np.int64)


def _check(reading: _Labelled, faults: Faults) -> None:
    if not reading.labelled:
        raise DataError(
            f"none of the {reading.total} observations has a label: training needs a label "
            "channel, an interval CSV (labels=FILE) or a source that labels"
        )
    faults.report_of(reading.labelled)
