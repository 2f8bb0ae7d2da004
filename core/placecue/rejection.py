"""When to say "unknown": a threshold on confidence, chosen on samples that no model has seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from placecue.errors import DataError, UsageError


@dataclass(frozen=True, slots=True)
class Rejection:
    """A threshold, and what it does to the samples that it was chosen on.

    Parameters
    ----------
    threshold : float
        Decisions of less confidence are "unknown"; in the unit of the scores.
    false_accept_rate : float
        Share of the wrong decisions that pass it; 0 where there are no wrong ones.
    accept_rate : float
        Share of the right decisions that pass it; 0 where there are no right ones.
    """

    threshold: float
    false_accept_rate: float
    accept_rate: float


def choose_threshold(
    confidence: ArrayLike, correct: ArrayLike, false_accept_rate: float = 0.05
) -> Rejection:
    """Choose the smallest threshold that lets no more than the wanted share of errors pass.

    Parameters
    ----------
    confidence : array of float, shape (n,)
        Confidences of decisions on held-out samples.
    correct : array of bool, shape (n,)
        Whether each decision was right. A sample of a place that is none of the classes has no
        right decision.
    false_accept_rate : float
        The wanted share of the wrong decisions that are accepted, 0 to 1.

    Returns
    -------
    Rejection
        Without wrong decisions, the threshold is the smallest confidence of all: less than what
        was seen is unknown.

    Raises
    ------
    UsageError
        If the wanted rate is not in 0 to 1.
    DataError
        If there is no sample, or a confidence is NaN.
    """
    if not 0 <= false_accept_rate <= 1:
        raise UsageError(f"false_accept_rate must be from 0 to 1, got {false_accept_rate}")
    confidence = np.asarray(confidence, dtype=np.float64)
    correct = np.asarray(correct, dtype=bool)
    if len(confidence) == 0 or np.isnan(confidence).any():
        raise DataError(
            f"a threshold for 'unknown' needs the confidence of held-out samples, got "
            f"{len(confidence)} with {int(np.isnan(confidence).sum())} NaN"
        )
    # Counting down from the surest error: so many may pass, and the next must not.
    wrong = np.sort(confidence[~correct])[::-1]
    passing = int(np.floor(false_accept_rate * len(wrong) + 1e-9))
    threshold = float(confidence.min())
    if passing < len(wrong):
        threshold = float(np.nextafter(wrong[passing], np.inf))
    accepted = confidence >= threshold
    return Rejection(threshold, _share(accepted[~correct]), _share(accepted[correct]))


def _share(accepted: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> float:
    return float(accepted.mean()) if len(accepted) else 0.0
