"""Scores of labelled samples that the models which gave them have not seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, UsageError
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
    costs : mapping of str to float, optional
        What each cue takes, ms a sample, where an integrator wants to be told.
    whole : bool
        Whether all that is integrated afterwards is known to have every cue, so that nothing need
        be learned for where some are missing.
    """

    evidence: Evidence
    labels: NDArray[Any]
    stamps: NDArray[np.int64] | None = None
    groups: NDArray[np.int64] | None = None
    folds: FoldScheme = field(default_factory=InterleavedChunks)
    part: bool = False
    costs: Mapping[str, float] | None = None
    whole: bool = False

    def __post_init__(self) -> None:
        n = len(self.evidence)
        for name in ("labels", "stamps", "groups"):
            values = getattr(self, name)
            if values is not None and len(values) != n:
                raise DataError(
                    f"{len(values)} {name} for the evidence of {n} samples: give one a sample"
                )

    def __len__(self) -> int:
        return len(self.labels)

    def take(self, rows: Rows | NDArray[np.bool_]) -> HeldOut:
        """Return some of the samples."""
        labels = self.labels[rows]
        return replace(
            self,
            evidence=self.evidence.take(rows),
            labels=labels,
            stamps=None if self.stamps is None else self.stamps[rows],
            groups=None if self.groups is None else self.groups[rows],
            part=self.part or len(labels) < len(self),
        )

    def having(self, cues: Sequence[str]) -> HeldOut:
        """Return the samples that have every one of the given cues, with the scores of these."""
        some = self.only(cues)
        return some.take(np.flatnonzero(some.evidence.known().all(axis=1)))

    def only(self, cues: Sequence[str]) -> HeldOut:
        """Return all samples with the scores of the given cues, in their order."""
        return replace(self, evidence=self.evidence.only(cues))

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


def check_unseen(held_out: HeldOut) -> None:
    """Raise UsageError if the models that gave the scores were trained on some of the samples."""
    n = int(held_out.evidence.trained_on().sum())
    if n:
        raise UsageError(
            f"the single-cue models were trained on {n} of the {len(held_out)} samples that the "
            "integrator is to be fitted on, and are too sure of them: give another log "
            "(integration_log=FILE), none at all, or force_training_scores=true"
        )
