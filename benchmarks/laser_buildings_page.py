"""The tables of buildings in docs/laser.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from cues_and_classifiers_plan import BUILDINGS
from cues_and_classifiers_results import Cell, Results, balanced_accuracy, recalls
from tables import put, table

#: Which classes are told apart.
TESTS: Mapping[str, Sequence[str]] = {
    "three": ("room", "hallway", "doorway"),
    "two": ("room", "hallway"),
}


def cell(method: str, test: str) -> Cell:
    """Return where the outcomes of a method are kept, a fold a building."""
    return Cell("buildings", method, test, "360")


def write(page: Path, results: Results, methods: Sequence[str]) -> None:
    """Put the tables into the page."""
    tables = {
        test: table(["method", "all", *BUILDINGS, *classes], _rows(results, methods, test))
        for test, classes in TESTS.items()
    }
    put(page, tables)


def _rows(results: Results, methods: Sequence[str], test: str) -> Iterator[list[str]]:
    """Yield what is finished: percent of all scans, in each building, and of each class."""
    for method in methods:
        folds = results.folds(cell(method, test), len(BUILDINGS))
        if folds is not None:
            each = [f"{balanced_accuracy([fold]):.0f}" for fold in folds]
            of_class = [f"{100 * recalls(folds)[name][0]:.0f}" for name in TESTS[test]]
            yield [method, f"{balanced_accuracy(folds):.1f}", *each, *of_class]
