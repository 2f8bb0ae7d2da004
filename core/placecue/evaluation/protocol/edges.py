"""Grids that end where the best values lie: there may be better ones beyond."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np

from placecue.evaluation.protocol.methods import SingleCue
from placecue.evaluation.results.result import Result

#: Of fewer trainings nothing is said.
FEWEST = 3


def at_edges(models: Mapping[str, SingleCue], results: Sequence[Result]) -> list[str]:
    """Return a line for each parameter whose chosen value is an end of its grid in every training.

    Parameters
    ----------
    models : mapping of str to SingleCue
        The single-cue models of an experiment.
    results : sequence of Result
        Its results.
    """
    lines = []
    for name, model in models.items():
        chosen = {
            (each.pair.world, each.pair.train): each.settings
            for each in results
            if each.method == name and not each.error
        }
        if len(chosen) < FEWEST:
            continue
        for parameter, values in (model.classifier.get("search") or {}).items():
            taken = {settings.get(parameter) for settings in chosen.values()}
            end = end_of(values, taken)
            if end:
                lines.append(
                    f"{parameter} = {taken.pop():g} of {name} is the {end} of its grid, and was "
                    f"chosen in all {len(chosen)} trainings; better ones may lie beyond"
                )
    return lines


def end_of(values: Any, taken: Set[Any]) -> str | None:
    """Return which end of a grid the only value that was taken is: ``smallest`` or ``largest``.

    None where several were taken, it lies within, or a value is no number.
    """
    if not isinstance(values, Sequence) or len(taken) != 1:
        return None
    [value] = taken
    if not all(map(_is_number, (*values, value))) or len(set(values)) < 2:
        return None
    return {min(values): "smallest", max(values): "largest"}.get(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
