"""What a classifier is trained on: the features of labelled samples, and how to cut them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError
from placecue.features import Families, FeatureBatch, join, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows, cut


@dataclass(frozen=True)
class TrainingSet:
    """The features of n labelled samples by one cue.

    Parameters
    ----------
    features : batch of n samples
        Of the observations as recorded. Where the cue learns, it has learned from all of them.
    labels : array of str or int, shape (n,)
        Their classes.
    stamps : array of int, shape (n,), optional
        Their times, ns.
    groups : array of int, shape (n,) or (n, 2), optional
        What belongs together, for folds to keep together: the log of each sample, and its scene
        where a source knows scenes.
    augmented : tuple of batches of n samples
        Of copies that are trained on and never scored, a batch an augmentation.
    folds : FoldScheme
        How the samples are cut by a classifier that has no scheme of its own.
    relearn : callable, optional
        Of a cue that learns: given the rows of some samples, returns the set of all n samples by a
        copy of the cue that has learned from those alone.
    part : bool
        Whether these are some of the samples that the folds were chosen for, such as the rest of
        a fold; they are cut into interleaved chunks where they cannot be cut as all would be.
    families : tuple of str, or mapping of str to such, optional
        The family of each of d features, for scalings that weigh families, or by part; see
        :attr:`placecue.Cue.families`.
    """

    features: FeatureBatch
    labels: Any
    stamps: Any = None
    groups: Any = None
    augmented: tuple[FeatureBatch, ...] = ()
    folds: FoldScheme = field(default_factory=InterleavedChunks)
    relearn: Callable[[Rows], TrainingSet] | None = None
    part: bool = False
    families: Families | None = None

    def __len__(self) -> int:
        return len(self.labels)

    # ------------------------------------------------------------------ folds

    def split(self, folds: FoldScheme | None = None) -> list[tuple[Rows, Rows]]:
        """Return (training rows, held-out rows) for each fold.

        Parameters
        ----------
        folds : FoldScheme, optional
            A scheme of one's own in place of :attr:`folds`.

        Raises
        ------
        DataError
            If the samples cannot be cut.
        """
        scheme = self.folds if folds is None else folds
        samples = np.asarray(self.labels), self.stamps, self.groups
        return cut(scheme, *samples, part=self.part)

    def take(self, rows: Rows) -> TrainingSet:
        """Return the set of the given samples; their cue has learned from what it had."""
        rows = np.arange(len(self))[rows]
        relearn = None
        if self.relearn is not None:

            def relearn(some: Rows) -> TrainingSet:
                return self.relearned(rows[some]).take(rows)

        return replace(
            self,
            features=take(self.features, rows),
            labels=np.asarray(self.labels)[rows],
            stamps=_of(self.stamps, rows),
            groups=_of(self.groups, rows),
            augmented=tuple(take(each, rows) for each in self.augmented),
            relearn=relearn,
            part=self.part or len(rows) < len(self),
        )

    def relearned(self, rows: Rows) -> TrainingSet:
        """Return all n samples by a copy of the cue that has learned from the given rows only.

        What is held out of a fold must be held out of the cue too: a codebook that was learned
        from a sample tells something of it. Of a cue that learns nothing it is this set.
        """
        if self.relearn is None:
            return self
        return replace(self.relearn(np.arange(len(self))[rows]), families=self.families)

    # ------------------------------------------------------------------ copies

    @property
    def views(self) -> int:
        """How often each sample stands in :meth:`batch`: once, and once for each augmentation."""
        return 1 + len(self.augmented)

    def batch(self) -> FeatureBatch:
        """Return all that is trained on: each sample, followed by its augmented copies.

        Returns
        -------
        batch of n * views samples
            Without augmentations ``features`` itself.
        """
        if not self.augmented:
            return self.features
        order = np.arange(len(self) * self.views).reshape(self.views, -1).T.ravel()
        return take(join([self.features, *self.augmented]), order)

    def repeated(self, values: ArrayLike) -> NDArray[Any]:
        """Return one value a sample as one value for each row of :meth:`batch`."""
        return np.repeat(np.asarray(values), self.views)

    def copies(self, rows: Rows) -> Rows:
        """Return the rows of :meth:`batch` that the given samples and their copies are."""
        first = np.asarray(rows, dtype=np.int64)[:, None] * self.views
        return np.asarray((first + np.arange(self.views)).ravel())

    def recorded(self, rows: Rows) -> Rows:
        """Return the rows of :meth:`batch` that the given samples as recorded are."""
        return np.asarray(rows, dtype=np.int64) * self.views


def check_lengths(labels: ArrayLike, **others: ArrayLike | None) -> None:
    """Raise DataError unless there is one of everything for each label."""
    n = len(np.asarray(labels))
    for name, values in others.items():
        if values is not None and len(np.asarray(values)) != n:
            raise DataError(f"{n} labels and {len(np.asarray(values))} {name}: give one a sample")


def _of(values: Any, rows: Rows) -> Any:
    return None if values is None else np.asarray(values)[rows]
