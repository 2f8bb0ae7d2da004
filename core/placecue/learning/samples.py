"""Labelled training samples: the features of every cue, read from observations in one pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from placecue.cue import Cue
from placecue.errors import UnusableObservation
from placecue.estimator import clone
from placecue.extraction import Extracted, Extraction
from placecue.faults import Faults
from placecue.features import FeatureBatch, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.learning.augmentation import augmentations_of, augmented, told_apart
from placecue.observation import Observation, Origin
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
    groups : ndarray of int64, shape (n,) or (n, 2), or None
        The log of each sample, as a number, and its scene; where that is known.
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
            take(each.features, rows_in(each.rows, rows))
            for each in found
            if each.features is not None
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


def rows_in(there: Rows, rows: Rows) -> Rows:
    """Return where the given rows stand among those that are there."""
    return np.searchsorted(there, rows).astype(np.int64)
