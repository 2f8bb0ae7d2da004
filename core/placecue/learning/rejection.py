"""When to say "unknown": a threshold on confidence, chosen on samples that no model has seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError, UsageError
from placecue.scores import Decision
from placecue.semantic_map import UNKNOWN

#: Confidences nearer to one another than this share of the largest are ties: batches of another
#: size, or another BLAS, move a score by its last digits.
TIE = 1e-9


@dataclass(frozen=True, slots=True)
class Unknown:
    """Wants decisions that are not sure enough to be called "unknown".

    Parameters
    ----------
    false_accept_rate : float
        The wanted share of the wrong decisions that are accepted all the same, 0 to 1.
    """

    false_accept_rate: float = 0.05

    def __post_init__(self) -> None:
        _check_rate(self.false_accept_rate)


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
    n_wrong, n_right : int
        How many decisions of each kind there were.
    """

    threshold: float
    false_accept_rate: float
    accept_rate: float
    n_wrong: int
    n_right: int

    def labels(self, decision: Decision) -> NDArray[np.str_]:
        """Return the labels of n decisions, "unknown" for those below the threshold, shape (n,)."""
        return np.where(decision.confidence < self.threshold, UNKNOWN, decision.labels)


def choose_threshold(
    confidence: ArrayLike, correct: ArrayLike, false_accept_rate: float = 0.05
) -> Rejection:
    """Choose the threshold that accepts most and lets no more than the wanted share of errors pass.

    It lies in the middle of the gap between the surest error that must not pass and the next
    larger confidence, right or wrong, so that no sample lies on it. Confidences that differ by
    less than rounding (``TIE``) are equal, and fall on the same side.

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
        Where every decision may pass, as without wrong ones, the threshold lies just below the
        smallest confidence: less than what was seen is unknown. Where no confidence is larger than
        that of an error that must not pass, it lies just above: nothing that was seen passes.

    Raises
    ------
    UsageError
        If the wanted rate is not in 0 to 1.
    DataError
        If there is no sample, or a confidence is not finite.
    """
    _check_rate(false_accept_rate)
    confidence = np.asarray(confidence, dtype=np.float64)
    correct = np.asarray(correct, dtype=bool)
    endless = int((~np.isfinite(confidence)).sum())
    if len(confidence) == 0 or endless:
        raise DataError(
            f"a threshold for 'unknown' needs the finite confidence of held-out samples, got "
            f"{len(confidence)} samples, {endless} of them NaN or infinite"
        )
    threshold = _threshold(np.sort(confidence), np.sort(confidence[~correct]), false_accept_rate)
    accepted = confidence >= threshold
    return Rejection(
        threshold,
        false_accept_rate=_share(accepted[~correct]),
        accept_rate=_share(accepted[correct]),
        n_wrong=int((~correct).sum()),
        n_right=int(correct.sum()),
    )


def _threshold(confidence: NDArray[np.float64], wrong: NDArray[np.float64], rate: float) -> float:
    """Return the middle of the first gap above the errors that must not pass; both are sorted."""
    tie = TIE * float(np.abs(confidence).max() or 1.0)
    # Counting down from the surest error: so many may pass, and the next must not.
    kept_out = len(wrong) - int(np.floor(rate * len(wrong) + 1e-9))
    if kept_out == 0:
        return float(confidence[0] - tie)
    above = confidence[np.searchsorted(confidence, wrong[kept_out - 1]) :]
    gaps = np.flatnonzero(np.diff(above) > tie)
    if len(gaps) == 0:
        return float(above[-1] + tie)
    return float(above[gaps[0]] / 2 + above[gaps[0] + 1] / 2)


def _share(accepted: NDArray[np.bool_]) -> float:
    return float(accepted.mean()) if len(accepted) else 0.0


def _check_rate(rate: float) -> None:
    if not 0 <= rate <= 1:
        raise UsageError(f"false_accept_rate must be from 0 to 1, got {rate}")
