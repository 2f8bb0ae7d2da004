"""What a pipeline is worth, judged on samples held out of everything that it learned from."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.evidence import Evidence
from placecue.folds import FoldScheme, InterleavedChunks, cut
from placecue.held_out import HeldOut
from placecue.integration import unfitted
from placecue.integrator import Integrator
from placecue.learning.samples import Samples
from placecue.progress import track
from placecue.schemes import Cues, Schemes
from placecue.scores import Scores

if TYPE_CHECKING:
    from placecue.pipeline import Pipeline

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Judged:
    """Scores of some labelled samples by one copy that has not seen them in any way.

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        Their classes; of none of the pipeline's where they are of other places.
    scores : Scores
        Integrated, in the layout of the copy.
    evidence : Evidence
        Those of every cue.
    """

    labels: NDArray[np.str_]
    scores: Scores
    evidence: Evidence

    def decisions(self) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return the confidence of each decision and whether it is right, shapes (n,)."""
        there = self.scores.available()
        decision = self.scores[there].decide()
        return decision.confidence, decision.labels == self.labels[there]


def judged_by_copies(pipeline: Pipeline, samples: Samples) -> list[Judged]:
    """Cross-validate a pipeline as a whole: cues, parameter searches, integrator.

    In each fold a copy is trained from the beginning on the other samples alone. Scores that are
    held out of the single-cue models, but not of the search and the integrator, flatter: random
    labels over four classes came out at 36 %.

    Parameters
    ----------
    pipeline : Pipeline
        Its parameters count, not what it has learned.
    samples : Samples
        The training samples.

    Returns
    -------
    list of Judged
        One a fold.
    """
    judged = []
    splits = _splits(pipeline.folds, samples.labels, samples.stamps, samples.groups)
    for rows, held_out in track(splits, "held-out decisions"):
        training, unseen = samples.take(rows), samples.take(held_out)
        copy = pipeline.unfitted()
        copy.fit_cues(training)
        if copy.integrates:
            copy.fit_integrator(copy.held_out(training))
        held = HeldOut(copy.evidence_of(unseen), unseen.labels)
        judged.append(judged_by(copy.schemes, held, skip=pipeline.skips))
    return judged


def judged_by_integrators(
    integrator: Integrator,
    held_out: HeldOut,
    sets: Sequence[Cues] | None = None,
    *,
    skip: bool = False,
) -> list[Judged]:
    """Judge on another sequence, which the single-cue models have not seen in any way.

    Copies of the integrator are fitted, with their own searches, in folds of it; for which sets
    of cues says ``sets``, see :meth:`placecue.Schemes.fit`.
    """
    judged = []
    splits = _splits(held_out.folds, held_out.labels, held_out.stamps, held_out.groups)
    for rows, unseen in track(splits, "held-out decisions"):
        copies = Schemes.fit(unfitted(integrator), held_out.take(rows), sets)
        judged.append(judged_by(copies, held_out.take(unseen), skip=skip))
    return judged


def judged_by(schemes: Schemes, held_out: HeldOut, *, skip: bool = False) -> Judged:
    """Return what a fitted integrator says of samples that neither it nor the cues have seen.

    Samples at which it fails are missing where ``skip`` says so.
    """
    scores, _ = schemes.integrate(held_out.evidence, skip=skip)
    return Judged(held_out.labels, scores, held_out.evidence)


def _splits(
    folds: FoldScheme, *samples: NDArray[np.str_] | NDArray[np.int64] | None
) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    try:
        return cut(folds, *samples)  # type: ignore[arg-type]
    except DataError as error:
        # A scheme may need what is not here: by_log needs two logs, and held out was one.
        log.warning(f"held-out decisions are cut into interleaved chunks instead: {error}")
        return cut(InterleavedChunks(folds.n_folds), *samples)  # type: ignore[arg-type]
