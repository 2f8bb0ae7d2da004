"""What cues must agree on before their decisions or probabilities can be joined class by class."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue import DataError, Evidence, Layout, UsageError, choices


def common_classes(evidence: Evidence, cues: Sequence[str]) -> tuple[str, ...]:
    """Return the classes that each of the cues tells apart.

    Raises
    ------
    DataError
        If a cue does not know a class that another one tells apart.
    """
    first = cues[0]
    classes = evidence.layout(first).classes
    for cue in cues[1:]:
        others = evidence.layout(cue).classes
        if others == classes:
            continue
        name = min(set(classes) ^ set(others), default=classes[0])
        knows, lacks = (first, cue) if name in classes else (cue, first)
        raise DataError(
            f"cue '{lacks}' was trained without '{name}', which cue '{knows}' tells apart: train "
            "all cues on samples of the same classes"
        )
    return classes


def check_layouts(evidence: Evidence, cues: Sequence[str], layouts: Sequence[Layout]) -> None:
    """Raise UsageError unless cues have scores of the layouts that were fitted on."""
    for cue, layout in zip(cues, layouts, strict=True):
        other = evidence.layout(cue) if cue in evidence.cues else layout
        if other is not layout and other != layout:
            raise UsageError(
                f"the scores of cue '{cue}' are {other}, and the integrator was fitted on "
                f"{layout}: give it scores of the models that it was fitted with"
            )


def class_codes(labels: Any, evidence: Evidence, classes: Sequence[str]) -> NDArray[np.int64]:
    """Return the classes of n held-out samples as numbers, shape (n,).

    Raises
    ------
    DataError
        If there is not one label for each sample, or a label is none of the classes.
    """
    labels = np.asarray(labels).astype(str)
    if len(labels) != len(evidence):
        raise DataError(
            f"{len(labels)} labels for the evidence of {len(evidence)} samples: give one a sample"
        )
    foreign = sorted(set(labels.tolist()) - set(classes))
    if foreign:
        raise DataError(
            f"there are held-out samples of '{foreign[0]}', which no cue tells apart; "
            f"{choices(foreign[0], classes)}"
        )
    return np.asarray(np.searchsorted(classes, labels), dtype=np.int64)
