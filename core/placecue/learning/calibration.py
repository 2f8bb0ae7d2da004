"""How much scores say: the temperature at which held-out beliefs are as sure as they are right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from placecue.distribution import log_odds, softmax
from placecue.errors import DataError
from placecue.learning.judging import Judged

Values = NDArray[np.float64]

#: Between these the sharpness is looked for.
LEAST, MOST = 1e-3, 1e4


@dataclass(frozen=True, slots=True)
class Calibration:
    """What turns scores into probabilities, and what they were worth where it was learned.

    Parameters
    ----------
    sharpness : float
        Log odds of a class by the unit of the scores: an inverse temperature.
    log_loss : float
        Mean negative logarithm of the probability of the true class on held-out samples.
    n : int
        How many there were.
    agreement : float or None
        How often two cues alone say the same of a sample; None where there is one cue.
    """

    sharpness: float
    log_loss: float
    n: int
    agreement: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.sharpness < float("inf"):
            raise DataError(f"a sharpness is a positive number, got {self.sharpness}")
        if self.agreement is not None and not 0 <= self.agreement <= 1:
            raise DataError(f"agreement is a share of 0 to 1, got {self.agreement}")


def calibrated(judged: Sequence[Judged]) -> Calibration | None:
    """Find the sharpness that makes held-out samples likeliest.

    The true class of a sample is wanted with (n + 1) / (n + M), as Platt has it, so that the
    sharpness stays finite where no held-out decision is wrong.

    Parameters
    ----------
    judged : sequence of Judged
        Scores of samples held out of everything; those of none of the classes are passed over.

    Returns
    -------
    Calibration or None
        None where there is no sample.

    References
    ----------
    Guo, Pleiss, Sun and Weinberger, On calibration of modern neural networks, ICML 2017; Platt,
    Probabilistic outputs for support vector machines, 1999 (the targets).
    """
    parts = [found for each in judged if (found := _odds(each)) is not None]
    n = sum(len(truth) for _, truth in parts)
    if n == 0:
        return None
    found = minimize_scalar(
        lambda power: sum(_loss(np.exp(power), *part, n) for part in parts),
        bounds=(np.log(LEAST), np.log(MOST)),
        method="bounded",
        options={"xatol": 1e-4},
    )
    sharpness = float(np.exp(found.x))
    plain = sum(_log_loss(sharpness, *part) for part in parts)
    return Calibration(sharpness, plain / n, n, _agreement(judged))


def _agreement(judged: Sequence[Judged]) -> float | None:
    """Return the share of pairs of cues that say the same of a sample."""
    alike = pairs = 0
    for each in judged:
        evidence = each.evidence
        for one, other in combinations(evidence.cues, 2):
            both = np.flatnonzero(evidence.available(one) & evidence.available(other))
            first, second = (evidence.scores(cue)[both].decide().labels for cue in (one, other))
            alike, pairs = alike + int((first == second).sum()), pairs + len(both)
    return alike / pairs if pairs else None


def _odds(judged: Judged) -> tuple[Values, NDArray[np.int64]] | None:
    """Return log odds at a sharpness of 1, and the column of the true class, of what is known."""
    layout = judged.scores.layout
    column = {name: i for i, name in enumerate(layout.classes)}
    truth = np.array([column.get(label, -1) for label in judged.labels.tolist()], dtype=np.int64)
    there = judged.scores.available() & (truth >= 0)
    if not there.any():
        return None
    return log_odds(judged.scores.values[there], layout), truth[there]


def _logarithms(sharpness: float, odds: Values) -> Values:
    return np.log(np.maximum(softmax(sharpness * odds), np.finfo(np.float64).tiny))


def _loss(sharpness: float, odds: Values, truth: NDArray[np.int64], n: int) -> float:
    logs = _logarithms(sharpness, odds)
    m = logs.shape[1]
    right = logs[np.arange(len(truth)), truth]
    return float(-(n * right.sum() + logs.sum()) / (n + m))


def _log_loss(sharpness: float, odds: Values, truth: NDArray[np.int64]) -> float:
    return float(-_logarithms(sharpness, odds)[np.arange(len(truth)), truth].sum())
