"""One call of an integrator over a batch, observation by observation where it fails."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from placecue import contracts
from placecue.attempts import attempt
from placecue.errors import UnusableObservation, described
from placecue.evidence import Evidence
from placecue.folds import Rows
from placecue.guard import call
from placecue.integrator import Integrator
from placecue.observation import Observation
from placecue.scores import Scores


def integrated(
    integrator: Integrator,
    evidence: Evidence,
    observations: Sequence[Observation] | None = None,
    *,
    skip: bool = False,
) -> tuple[Scores, dict[int, UnusableObservation]]:
    """Return the integrated scores of n observations, and where the integrator failed.

    Parameters
    ----------
    integrator : Integrator
        Fitted.
    evidence : Evidence
        Of n observations.
    observations : sequence of n Observations, optional
        Which they are, for messages.
    skip : bool
        Whether an observation at which the integrator fails is passed over.

    Returns
    -------
    Scores
        Shape (n, V), NaN where nothing can be told.
    dict of int to UnusableObservation
        Why the integrator failed, by row.
    """

    def integrate(rows: Rows) -> Scores:
        some = evidence if len(rows) == len(evidence) else evidence.take(rows)
        check = partial(contracts.scores, n=len(rows), classes=_classes(evidence), gaps=True)
        at = observations[rows[0]] if observations is not None and len(rows) == 1 else None
        scores: Scores = call(integrator, "integrate", some, check=check, at=at)
        return scores

    attempts = attempt(integrate, len(evidence), skip=skip)
    if len(attempts.answers) == 1 and len(attempts.rows) == len(evidence):
        return attempts.answers[0][1], attempts.failed
    # Where it failed at every one, any layout says as much.
    layout = next((s.layout for _, s in attempts.answers), evidence.layout(evidence.cues[0]))
    values = np.full((len(evidence), len(layout.columns)), np.nan)
    for rows, scores in attempts.answers:
        values[rows] = scores.values
    return Scores(values, layout), attempts.failed


def unfitted(integrator: Integrator) -> Integrator:
    """Return a copy of an integrator that has learned nothing, checked."""

    def wrong(made: object) -> str | None:
        right = isinstance(made, Integrator) and made is not integrator
        return None if right else f"returned {described(made)}, not a copy of the integrator"

    copy: Integrator = call(integrator, "unfitted", check=wrong)
    return copy


def _classes(evidence: Evidence) -> tuple[str, ...]:
    return evidence.layout(evidence.cues[0]).classes
