"""Whether probabilities mean what they say: how often decisions made with 80 % are right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError, UsageError
from placecue.evaluation.pictures import save_picture
from placecue.scores import Probabilities, Scores


@dataclass(frozen=True)
class Reliability:
    """Decisions in bins of the probability that they were made with.

    Parameters
    ----------
    edges : ndarray of float64, shape (k + 1,)
        Edges of the bins, 0 to 1.
    counts : ndarray of int64, shape (k,)
        Decisions in each bin.
    probability : ndarray of float64, shape (k,)
        Their mean probability; NaN in an empty bin.
    accuracy : ndarray of float64, shape (k,)
        The share of them that was right; NaN in an empty bin.
    """

    edges: NDArray[np.float64]
    counts: NDArray[np.int64]
    probability: NDArray[np.float64]
    accuracy: NDArray[np.float64]

    @property
    def error(self) -> float:
        """The expected calibration error: mean |probability - accuracy| over all decisions."""
        filled = self.counts > 0
        gaps = np.abs(self.probability[filled] - self.accuracy[filled])
        return float(np.average(gaps, weights=self.counts[filled]))


def reliability(scores: Scores, labels: ArrayLike, bins: int = 10) -> Reliability:
    """Compare the probability of each decision with how often such decisions are right.

    Parameters
    ----------
    scores : Scores
        Probabilities of n held-out samples.
    labels : array of str, shape (n,)
        Their true classes.
    bins : int
        Number of bins of equal width.

    Raises
    ------
    UsageError
        If the scores are no probabilities.
    DataError
        If there is no sample.

    References
    ----------
    Guo, Pleiss, Sun and Weinberger, On calibration of modern neural networks, ICML 2017 (the
    expected calibration error).
    """
    if not isinstance(scores.layout, Probabilities):
        raise UsageError(
            f"a reliability diagram needs probabilities, got {scores.layout.name}: set "
            "classifier.probability=sigmoid"
        )
    if len(scores) == 0:
        raise DataError("a reliability diagram needs samples, got none")
    given = scores.values.max(axis=1)
    right = (scores.decide().labels == np.asarray(labels)).astype(np.float64)
    edges = np.linspace(0, 1, bins + 1)
    number = np.clip(np.digitize(given, edges) - 1, 0, bins - 1)
    counts = np.bincount(number, minlength=bins)
    sums = [np.bincount(number, weights=each, minlength=bins) for each in (given, right)]
    empty = np.full((2, bins), np.nan)
    means = np.divide(sums, counts, out=empty, where=counts > 0)
    return Reliability(edges, counts, means[0], means[1])


def draw_reliability(
    measured: Mapping[str, Reliability], path: str | Path, *, title: str | None = None
) -> Path:
    """Draw reliability diagrams over histograms of the probabilities.

    A point is the larger the more decisions it stands for.

    Parameters
    ----------
    measured : mapping of str to Reliability
        By the name of the cue or method.
    path : str or Path
        Picture file to write; see :func:`placecue.evaluation.pictures.save_picture`.
    title : str, optional
        Heading of the picture.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 8), dpi=100, layout="constrained")
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    axes.plot([0, 1], [0, 1], "--", color="#8A8A8A", label="perfectly calibrated")
    for name, each in measured.items():
        filled = each.counts > 0
        label = f"{name} (calibration error {100 * each.error:.1f} %)"
        share = each.counts / each.counts.sum()
        line, *_ = axes.plot(each.probability[filled], each.accuracy[filled], label=label)
        # Small where there are few decisions, whose share of right ones says little.
        size = 10 + 250 * share[filled]
        axes.scatter(each.probability[filled], each.accuracy[filled], size, color=line.get_color())
        below.stairs(share, each.edges, linewidth=1.5)
    axes.set_ylabel("share that is right")
    axes.set_ylim(-0.03, 1.03)
    axes.grid(alpha=0.3)
    axes.legend(loc="best")
    below.set_xlabel("probability of the decision")
    below.set_ylabel("share of decisions")
    below.set_xlim(0, 1)
    if title:
        axes.set_title(title)
    return save_picture(figure, path)
