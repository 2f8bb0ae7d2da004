"""Scores of methods over the pairs that all of them have results of."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.results.results import Results


def shared_scores(
    results: Results, spec: Spec, methods: Sequence[str]
) -> tuple[NDArray[np.float64], int]:
    """Return scores over the pairs of a figure's experiments that all methods have a score of.

    Returns
    -------
    ndarray of float64, shape (pairs, methods)
        Balanced accuracy, 0 to 1.
    int
        How many more pairs some of the methods have.
    """
    pairs, scores = results.paired(methods)
    asked = np.array([pair.experiment in spec.experiments for pair in pairs], dtype=bool)
    scores = scores[asked & np.isfinite(scores).all(axis=1)]
    met = {each.pair for m in methods for e in spec.experiments for each in results.of(m, e)}
    return scores, len(met) - len(scores)
