"""Labelled training samples: the features of every cue, read from observations in one pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from placecue.cue import Cue
from placecue.errors import DataError, UnusableObservation
from placecue.estimator import clone
from placecue.extraction import Extracted, Extraction
from placecue.faults import Faults
from placecue.features import FeatureBatch, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.learning.augmentation import augmentations_of, augmented, told_apart
from placecue.learning.families import families_of
from placecue.observation import Observation, Origin
from placecue.training_set import TrainingSet


class Views(NamedTuple):
    """What one cue makes of some of n samples.

    Parameters
    ----------
    rows : ndarray of int64, shape (k,)
        Which of the samples have the cue; of one that learns, those that have its parts.
    features : tuple of batches of k samples
        As recorded, then those of each augmentation; nothing of a cue that learns.
    """

    rows: Rows
    features: tuple[FeatureBatch, ...] = ()

    def take(self, rows: Rows, n: int) -> Views:
        """Return the same of the given ones of the n samples."""
        at = np.full(n, -1)
        at[self.rows] = np.arange(len(self.rows))
        picked = at[rows]
        there = picked >= 0
        kept = tuple(take(each, picked[there]) for each in self.features)
        return Views(np.flatnonzero(there).astype(np.int64), kept)


@dataclass(frozen=True)
class Samples:
    """n labelled samples, each with one cue or more.

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        The class of each sample.
    stamps : ndarray of int64, shape (n,)
        The time of each sample, ns.
    groups : ndarray of int64, shape (n,), or None
        The log of each sample, as a number, where that is known.
    extracted : mapping of str to Views
        For each cue the samples that have it, with their features if it learns nothing.
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
    extracted: Mapping[str, Views]
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
            extracted={n: views.take(rows, len(self)) for n, views in self.extracted.items()},
            positions=self.positions[rows],
            origins=[self.origins[row] for row in rows],
            part=self.part or len(rows) < len(self),
            _known={},
        )

    def training_set(self, name: str, cue: Cue) -> TrainingSet:
        """Return what the classifier of a cue is trained on.

        That is every sample that has the cue. A cue that learns is fitted first, once: later calls
        with it return the same set. Samples of which it then makes nothing are left out, and it
        is said.

        Raises
        ------
        DataError
            If no sample has the cue, or none of some class.
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
        rows, features = self.extracted[name]
        if not cue.learns:
            return Extracted(rows, features[0] if len(rows) else None)
        found = self.extraction.gather(cue, self.reread(rows), skip=self.skip)
        self._report(name, found.failed, len(rows))
        return Extracted(rows[found.rows], found.features)

    def which(self) -> Which:
        """Return which samples these are, without their features."""
        return Which(self.observations, self.positions, self.origins)

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
            self._check_there(name, self.extracted[name].rows)
            found = self._learned(name, cue) if cue.learns else self._extracted(name)
            self._check_there(name, found[1])
            training = replace(found[0], families=families_of(cue, found[0].features))
            known = self._known[name] = cue, training, found[1]
        return known[1:]

    def _extracted(self, name: str) -> tuple[TrainingSet, Rows]:
        rows, features = self.extracted[name]
        return self._of(rows)._set(*features), rows

    def _learned(self, name: str, cue: Cue) -> tuple[TrainingSet, Rows]:
        """Let a cue learn, and return the samples of which it makes something in every view."""
        rows = self.extracted[name].rows
        having = self._of(rows)
        having._learn(cue, np.arange(len(having)))
        found = having._views(cue)
        failed = {row: error for each in found for row, error in each.failed.items()}
        self._report(name, failed, len(having))
        kept = np.array([row for row in range(len(having)) if row not in failed], dtype=np.int64)
        there = [
            take(each.features, rows_in(each.rows, kept))
            for each in found
            if each.features is not None
        ]
        return having._of(kept)._seen(cue, there), rows[kept]

    def _of(self, rows: Rows) -> Samples:
        """Return the given samples; all of them are no part of themselves."""
        return self if len(rows) == len(self) else self.take(rows)

    def _check_there(self, name: str, rows: Rows) -> None:
        """Raise DataError where a cue would not learn of some class."""
        labels = self.labels[rows]
        lacking = sorted(set(self.labels.tolist()) - set(labels.tolist()))
        if lacking:
            raise DataError(
                f"cue {name}: none of the {len(rows)} samples that have it is of "
                f"{' or '.join(map(repr, lacking))}, so it would never say so: give a log in which "
                "it is there, leave out the cue, or drop the class (label_map)"
            )

    def _report(self, name: str, failed: Mapping[int, UnusableObservation], n: int) -> None:
        """Say of how many samples a cue makes nothing, once a cue."""
        faults = Faults(f"cue {name}")
        for row in sorted(failed):
            faults.pass_over(failed[row])
        if name not in self._said or len(failed) == n:
            faults.report_of(n)
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


class Which(NamedTuple):
    """Which observations some samples are."""

    observations: Iterable[Observation]
    positions: NDArray[np.int64]
    origins: Sequence[Origin | None]

    def among(self, others: Which) -> NDArray[np.bool_]:
        """Return which of these n samples are among others, as far as is known, shape (n,)."""
        if self.observations is others.observations:
            return np.isin(self.positions, others.positions)
        known = {origin for origin in others.origins if origin is not None}
        return np.array([origin in known for origin in self.origins], dtype=bool)


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
