"""Samples that are added to a model, without those that it was trained on."""

from __future__ import annotations

import logging
from collections import Counter
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.cue_model import CueModel
from placecue.errors import DataError, UsageError
from placecue.features import FeatureBatch
from placecue.guard import call
from placecue.learning.samples import Samples
from placecue.pipeline import Pipeline

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Taught:
    """What a model has been taught.

    Parameters
    ----------
    counts : mapping of str to int
        Samples by class.
    new : tuple of str
        The classes that it did not know before.
    wrong_before, wrong_after : int
        How many of these very samples it decides wrongly, before it was taught and since.
    """

    counts: Counter[str]
    new: tuple[str, ...]
    wrong_before: int = 0
    wrong_after: int = 0


def check_teachable(pipeline: Pipeline) -> None:
    """Check that a model can go on learning.

    Raises
    ------
    UsageError
        If it integrates cues, or its classifier cannot learn further samples by themselves.
    """
    if pipeline.integrates:
        raise UsageError(
            f"this model integrates {', '.join(pipeline.cues)}, and an integrator is fitted on "
            "samples held out of all training: train it again with the new log as well, or teach "
            "a model of one cue"
        )
    for name, model in pipeline.cues.items():
        if not callable(getattr(model.classifier, "partial_fit", None)):
            raise UsageError(
                f"the classifier of cue {name} ({type(model.classifier).__name__}) cannot learn "
                "further samples by themselves: train again with the new log as well, or train "
                f"with classifier@cues.{name}.classifier=nearest_mean, which can"
            )


def teach(pipeline: Pipeline, samples: Samples) -> Taught:
    """Add labelled samples to a model of one cue.

    Parameters
    ----------
    pipeline : Pipeline
        Fitted; see :func:`check_teachable`.
    samples : Samples
        What its ``collect`` made of a log.

    Raises
    ------
    UsageError
        If it cannot be taught.
    DataError
        If no sample has the cue.
    """
    check_teachable(pipeline)
    known = pipeline.classes
    [(name, model)] = pipeline.cues.items()
    found = samples.features(name, model.cue)
    if found.features is None:
        raise DataError(f"no labelled sample has the cue {name}: there is nothing to learn")
    labels = samples.labels[found.rows]
    classifier: Any = model.classifier
    before = _wrong(model, found.features, labels)
    call(classifier, "partial_fit", found.features, labels)
    counts = Counter(labels.tolist())
    new = tuple(sorted(set(counts) - set(known)))
    for each in new:
        near = get_close_matches(each, known, n=1, cutoff=0.8)
        if near:
            log.warning(
                f"'{each}' is a new class beside '{near[0]}': "
                f"label_map={{{each}: {near[0]}}} makes them one"
            )
    if pipeline.rejection_ is not None:
        log.warning('the threshold for "unknown" is that of the samples trained on before')
    return Taught(counts, new, before, _wrong(model, found.features, labels))


def _wrong(model: CueModel, features: FeatureBatch, labels: NDArray[np.str_]) -> int:
    return int(np.count_nonzero(model.scores(features).decide().labels != labels))
