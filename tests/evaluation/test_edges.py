"""Grids whose end was always the best are told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from placecue.evaluation.protocol.edges import at_edges
from placecue.evaluation.protocol.methods import SingleCue
from placecue.evaluation.results.result import Pair, Result

NONE = np.empty(0)


def result(train: str, settings: dict[str, Any], error: str = "") -> Result:
    pair, empty = Pair("Exp 1", "", (train,), "test"), NONE.astype(np.int16)
    return Result(
        pair, "CRFH", ("hall", "lab"), empty, empty, NONE, NONE, settings=settings, error=error
    )


def told(chosen: list[Any], search: Any) -> list[str]:
    models = {"CRFH": SingleCue("CRFH", "cue=crfh", {}, {"search": search})}
    return at_edges(models, [result(f"log{n}", {"C": each}) for n, each in enumerate(chosen)])


def test_the_largest_value_that_all_trainings_chose_is_told() -> None:
    [line] = told([100, 100, 100], {"C": [1, 10, 100]})
    assert line == (
        "C = 100 of CRFH is the largest of its grid, and was chosen in all 3 trainings; better "
        "ones may lie beyond"
    )
    assert "smallest" in told([1, 1, 1, 1], {"C": [1, 10, 100]})[0]


@pytest.mark.parametrize(
    ("chosen", "search"),
    [
        ([100, 10, 100], {"C": [1, 10, 100]}),
        ([10, 10, 10], {"C": [1, 10, 100]}),
        ([100, 100], {"C": [1, 10, 100]}),
        ([100, 100, 100], {"C": [100]}),
        ([100, 100, 100], None),
        (["oao", "oao", "oao"], {"C": ["oaa", "oao"]}),
    ],
)
def test_what_lies_within_or_was_seldom_trained_is_not(chosen: list[Any], search: Any) -> None:
    assert told(chosen, search) == []


def test_trainings_that_failed_do_not_count() -> None:
    models = {"CRFH": SingleCue("CRFH", "cue=crfh", {}, {"search": {"C": [1, 100]}})}
    results = [result(f"log{n}", {"C": 100}, "broken" if n else "") for n in range(4)]
    assert at_edges(models, results) == []
