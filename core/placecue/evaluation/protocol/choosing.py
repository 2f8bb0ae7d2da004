"""Parameters of a classifier, chosen on another recording than the one it is trained on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.cue_model import CueModel
from placecue.errors import DataError
from placecue.features import FeatureBatch
from placecue.training_set import TrainingSet


def chosen(
    model: CueModel, training: TrainingSet, features: FeatureBatch, labels: NDArray[np.str_]
) -> tuple[CueModel, dict[str, Any]]:
    """Return a model trained with the parameters that do best on other samples, and these.

    Parameters
    ----------
    model : CueModel
        Its classifier says what to try; without a search it is trained as it is.
    training : TrainingSet
        What every candidate is trained on.
    features : batch of m samples
        Of the other recording.
    labels : ndarray of str, shape (m,)
        Their classes; those that the model has no sample of are left out.

    Returns
    -------
    CueModel
        The first of those with the highest balanced accuracy, trained.
    dict
        Its searched parameters.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010: the group's training script picked parameters so.
    """
    known = np.isin(labels, np.unique(np.asarray(training.labels)))
    if not known.any():
        raise DataError(
            "the recording that parameters are chosen on has no class of the training recording"
        )
    best, found, kept = -1.0, model, {}
    for setting, classifier in model.classifier.candidates():
        candidate = CueModel(model.cue, classifier).fit(training)
        decided = candidate.scores(features).decide().labels
        score = _balanced(labels[known], decided[known])
        if score > best:
            best, found, kept = score, candidate, dict(setting)
    return found, kept


def _balanced(truth: NDArray[np.str_], decided: NDArray[np.str_]) -> float:
    return float(np.mean([np.mean(decided[truth == name] == name) for name in np.unique(truth)]))
