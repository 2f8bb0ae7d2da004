"""Train the classifier of one cue on all samples, or on those of a fold."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from placecue.classifier import Classifier
from placecue.errors import DataError
from placecue.features import FeatureBatch
from placecue.folds import Rows
from placecue.learning.samples import CueSamples, LearnedFrom

C = TypeVar("C", bound=Classifier)


def train(
    classifier: C,
    samples: CueSamples,
    labels: NDArray[np.str_],
    stamps: NDArray[np.int64] | None,
    rows: Rows | None = None,
    learned_from: LearnedFrom | None = None,
) -> C:
    """Fit a classifier on samples and their altered copies.

    Parameters
    ----------
    classifier : Classifier
        Fitted in place, and returned.
    samples : CueSamples
        The features of all n samples.
    labels : ndarray of str, shape (n,)
        Their classes.
    stamps : ndarray of int64, shape (n,), or None
        Their times, ns.
    rows : ndarray of int64, optional
        Which samples to train on; all by default.
    learned_from : callable, optional
        Of a cue that learns: what returns the features of all n samples by a copy of the cue that
        has learned from the given samples only. The classifier's own folds get theirs from it.

    Raises
    ------
    DataError
        If the classifier refuses the samples, or one of its folds has altered copies only.
    """
    batch, of_batch, times = samples.training(labels, stamps, rows)
    if learned_from is None:
        return classifier.fit(batch, of_batch, times)
    views = 1 + len(samples.altered)
    trained_on = np.arange(len(labels)) if rows is None else rows

    def of_fold(training: Rows) -> FeatureBatch:
        # A cue never learns from a sample of which the fold holds a copy out.
        drawn = np.unique(np.arange(len(of_batch))[training]) // views
        whole = np.bincount(drawn, minlength=len(trained_on)) == views
        if not whole.any():
            raise DataError(
                "a fold holds a copy of every sample out, so that a cue has nothing to learn "
                "from: choose folds that keep altered copies with their samples"
            )
        of_all = learned_from(trained_on[whole])
        return of_all.training(labels, stamps, rows)[0]

    return classifier.fit_on_learned(batch, of_batch, times, of_fold)
