"""Scores of labelled samples that the models which gave them have not seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.evidence import Evidence
from placecue.folds import FoldScheme, InterleavedChunks, Rows, cut


@dataclass(frozen=True)
class HeldOut:
    """The evidence of n labelled samples that the single-cue models have not seen.

    What an integrator is fitted on.

    Parameters
    ----------
    evidence : Evidence
        Their scores by every cue.
    labels : ndarray of str, shape (n,)
        Their classes.
    stamps : ndarray of int64, shape (n,), optional
        Their times, ns.
    groups : ndarray of int64, shape (n,) or (n, 2), optional
        What belongs together: the log of each sample, and its scene where a source knows scenes.
    folds : FoldScheme
        How an integrator that holds samples out cuts them, unless it has a scheme of its own.
    part : bool
        Whether these are some of the samples that the folds were chosen for; see
        :class:`placecue.TrainingSet`.
    """

    evidence: Evidence
    labels: NDArray[Any]
    stamps: NDArray[np.int64] | None = None
    groups: NDArray[np.int64] | None = None
    folds: FoldScheme = field(default_factory=InterleavedChunks)
    part: bool = False

    def __len__(self) -> int:
        return len(self.labels)

    def take(self, rows: Rows | NDArray[np.bool_]) -> HeldOut:
        """Return some of the samples."""
        stamps = None if self.stamps is None else self.stamps[rows]
        groups = None if self.groups is None else self.groups[rows]
        labels = self.labels[rows]
        part = self.part or len(labels) < len(self)
        return HeldOut(self.evidence.take(rows), labels, stamps, groups, self.folds, part)

    def parted(self, classes: Sequence[str]) -> tuple[HeldOut, HeldOut | None]:
        """Return the samples of the given classes, and those of others, None where there are none.

        Raises
        ------
        DataError
            If there is no sample of the given classes.
        """
        known = np.isin(self.labels, classes)
        if not known.any():
            raise DataError("the integration log has no sample of a class of the training log")
        if known.all():
            return self, None
        return self.take(np.flatnonzero(known)), self.take(np.flatnonzero(~known))

    def split(self) -> list[tuple[Rows, Rows]]:
        """Return (fitting rows, held-out rows) for each fold."""
        samples = self.labels, self.stamps, self.groups
        return cut(self.folds, *samples, part=self.part)
