"""Families of features: values with their names, units and meaning side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .beams import Beams
from .summaries import Matrix


@dataclass(frozen=True, slots=True)
class Family:
    """Features that are computed together.

    Parameters
    ----------
    name : str
        What they say something of; those of one name share a weight.
    names : tuple of str
        One name a feature.
    unit : str
        Their common unit; ``1`` for pure numbers.
    meaning : str
        What they are, for the documentation.
    values : callable
        From :class:`Beams` of n scans to an array of shape (n, len(names)).
    """

    name: str
    names: tuple[str, ...]
    unit: str
    meaning: str
    values: Callable[[Beams], Matrix]


def evaluate(families: Sequence[Family], beams: Beams) -> Matrix:
    """Return every feature of every scan, shape (n, d)."""
    return np.hstack([family.values(beams) for family in families])


def numbered(name: str, values: Sequence[float], form: str = "g") -> tuple[str, ...]:
    """Return names such as ``gaps(0.5)``."""
    return tuple(f"{name}({value:{form}})" for value in values)
