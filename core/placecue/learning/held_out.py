"""Scores of labelled samples that the models which gave them have not seen."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.evidence import Evidence, StoredEvidence
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.integrator import Integrator
from placecue.learning.rejection import Rejection, choose_threshold
from placecue.progress import track
from placecue.scores import Scores

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class HeldOut:
    """The evidence of n labelled samples that the single-cue models have not seen.

    Parameters
    ----------
    evidence : Evidence
        Their scores by every cue.
    labels : ndarray of str, shape (n,)
        Their classes.
    stamps : ndarray of int64, shape (n,)
        Their times, ns.
    """

    evidence: Evidence
    labels: NDArray[np.str_]
    stamps: NDArray[np.int64]

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
        parts = (np.flatnonzero(each) for each in (known, ~known))
        of_known, others = (HeldOut(self._of(r), self.labels[r], self.stamps[r]) for r in parts)
        return of_known, others

    def integrated(self, integrator: Integrator, folds: FoldScheme) -> list[tuple[Rows, Scores]]:
        """Return integrated scores of samples that the integrator has not seen either.

        Parameters
        ----------
        integrator : Integrator
            A fitted integrator; copies with its chosen parameters are fitted in each fold.
        folds : FoldScheme
            How the n samples are cut.

        Returns
        -------
        list of (rows, Scores)
            For each fold the held-out rows and their scores, in the layout of the fold's copy.
        """
        scored = []
        for training, held_out in track(self._splits(folds), "held-out decisions"):
            copy = integrator.chosen().fit(
                self._of(training), self.labels[training], self.stamps[training]
            )
            scored.append((held_out, copy.integrate(self._of(held_out))))
        return scored

    def rejection(
        self,
        integrator: Integrator,
        folds: FoldScheme,
        false_accept_rate: float,
        foreign: HeldOut | None = None,
    ) -> Rejection:
        """Choose the threshold for "unknown" on the decisions of :meth:`integrated`.

        Samples of other places, on which the integrator was not fitted, are decided by it as it
        is, and never rightly; see :func:`placecue.learning.rejection.choose_threshold`.
        """
        confidence, correct = [], []
        if foreign is not None:
            decided = integrator.integrate(foreign.evidence).decide()
            confidence.append(decided.confidence)
            correct.append(np.zeros(len(foreign.labels), dtype=bool))
        for rows, scores in self.integrated(integrator, folds):
            decision = scores.decide()
            confidence.append(decision.confidence)
            correct.append(decision.labels == self.labels[rows])
        return choose_threshold(
            np.concatenate(confidence), np.concatenate(correct), false_accept_rate
        )

    def _of(self, rows: Rows) -> Evidence:
        cues = self.evidence.cues
        return StoredEvidence({cue: self.evidence.scores(cue, rows) for cue in cues})

    def _splits(self, folds: FoldScheme) -> list[tuple[Rows, Rows]]:
        try:
            return list(folds.split(self.labels, self.stamps))
        except DataError as error:
            # A scheme may need what is not here: by_log needs two logs, and held out was one.
            log.warning(f"held-out decisions are cut into interleaved chunks instead: {error}")
            return list(InterleavedChunks(folds.n_folds).split(self.labels, self.stamps))
