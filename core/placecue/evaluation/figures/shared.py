"""Scores of methods over the pairs that all of them have a score of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.results.result import Pair
from placecue.evaluation.results.results import Results

#: By method: the score of each pair, as far as it is defined.
Scores = Mapping[str, Mapping[Pair, float]]


def scores_of(results: Results, spec: Spec) -> Scores:
    """Return the scores of a figure's methods in its experiments, 0 to 1."""
    return {
        method: {
            pair: score
            for pair, score in results.scores(method).items()
            if pair.experiment in spec.experiments and np.isfinite(score)
        }
        for method in spec.methods
    }


def shared(scores: Scores, methods: Sequence[str]) -> NDArray[np.float64]:
    """Return the scores over the n pairs that all of some methods have, shape (n, methods)."""
    of_method = [scores[method] for method in methods]
    pairs = [pair for pair in of_method[0] if all(pair in each for each in of_method)]
    table = [[each[pair] for each in of_method] for pair in pairs]
    return np.array(table, dtype=np.float64).reshape(len(pairs), len(methods))
