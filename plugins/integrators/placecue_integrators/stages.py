"""Thresholds of confidence for deciding early: which decisions stand, and what that costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
#: A confidence that no decision reaches, and one that every decision does.
NEVER, ALWAYS = np.inf, -np.inf


@dataclass(frozen=True)
class Stages:
    """What the decisions of n samples would be after each of T cues.

    Parameters
    ----------
    right : ndarray of bool, shape (T, n)
        Whether the decision after each cue is right.
    confidence : ndarray of float64, shape (T, n)
        How sure it is.
    weights : ndarray of float64, shape (n,)
        What each sample counts, such that the sum over right ones is the balanced accuracy.
    costs : sequence of T floats
        What each cue costs.
    """

    right: NDArray[np.bool_]
    confidence: Floats
    weights: Floats
    costs: Sequence[float]

    def rate(self, thresholds: Sequence[float]) -> float:
        """Return the balanced accuracy of deciding as early as the thresholds allow."""
        at = self.decided(thresholds)
        return float(self.weights @ self.right[at, np.arange(len(at))])

    def decided(self, thresholds: Sequence[float]) -> NDArray[np.int64]:
        """Return the number of the cue after which each sample is decided on, shape (n,)."""
        sure = self.confidence[:-1] >= np.asarray(thresholds, dtype=float)[:, None]
        last = np.ones((1, sure.shape[1]), dtype=bool)
        return np.asarray(np.argmax(np.vstack([sure, last]), axis=0), dtype=np.int64)

    def shares(self, thresholds: Sequence[float]) -> Floats:
        """Return for which share of the samples each cue is used, shape (T,)."""
        at = self.decided(thresholds)
        return np.array([np.mean(at >= number) for number in range(len(self.right))])

    def cost(self, thresholds: Sequence[float]) -> float:
        """Return the mean cost of a sample."""
        return float(self.shares(thresholds) @ np.asarray(self.costs, dtype=float))

    def thresholds(self, rate: float | None = None) -> list[float]:
        """Return the smallest thresholds that keep a recognition rate.

        From the last stage but one back to the first: the smallest with which deciding there, and
        otherwise as the later thresholds say, is as good. Where none is, nothing is decided there.

        Parameters
        ----------
        rate : float, optional
            The balanced accuracy to keep, in [0, 1]; by default the highest at each stage.
        """
        later = self.right[-1]
        found: list[float] = []
        for right, confidence in zip(self.right[-2::-1], self.confidence[-2::-1], strict=True):
            threshold = self._smallest(right, later, confidence, rate)
            later = np.where(confidence >= threshold, right, later)
            found.insert(0, threshold)
        return found

    def _smallest(
        self,
        right: NDArray[np.bool_],
        later: NDArray[np.bool_],
        confidence: Floats,
        rate: float | None,
    ) -> float:
        order = np.argsort(-confidence, kind="stable")
        gain = self.weights * (right.astype(float) - later)
        kept = self.weights @ later + np.concatenate([[0.0], np.cumsum(gain[order])])
        surest = confidence[order]
        # Samples of one confidence are decided on together.
        ends = np.append(np.append(True, surest[:-1] > surest[1:]), True)
        wanted = kept[ends].max() if rate is None else rate
        good = np.flatnonzero(ends & (kept >= wanted - 1e-12))
        if not good.size or good[-1] == 0:
            return NEVER
        return ALWAYS if good[-1] == len(surest) else float(surest[good[-1] - 1])


def balanced(labels: NDArray[np.str_]) -> Floats:
    """Return what each sample counts in the mean of the per-class recalls, shape (n,)."""
    _, which, counts = np.unique(labels, return_inverse=True, return_counts=True)
    return np.asarray(1 / (len(counts) * counts[which]))
