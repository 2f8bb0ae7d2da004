"""The tables of worlds in docs/laser.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import mean, stdev

from cues_and_classifiers_results import Cell, Results
from laser_worlds_data import RECORDINGS, Recording
from tables import put, table

EXPERIMENTS = (1, 2, 3, 4)


def cell(world: int, method: str, train: Recording) -> Cell:
    """Return where the outcome of training on a recording is kept."""
    return Cell(f"world{world}", method, "idol2", train.name)


def write(page: Path, results: Results, worlds: Sequence[int], methods: Sequence[str]) -> None:
    """Put the tables into the page."""
    found = {
        method: {world: scores for world in worlds if (scores := in_world(results, world, method))}
        for method in methods
    }
    put(page, {"experiments": _means(found), "worlds": _each(found, worlds)})


def in_world(results: Results, world: int, method: str) -> list[float]:
    """Return the balanced accuracy of a method in Experiments 1 to 4, the mean over their pairs.

    Percent; empty as long as a recording is missing.
    """
    told = [results.folds(cell(world, method, each), 1) for each in RECORDINGS]
    if None in told:
        return []
    tests = [test for folds in told for test in (folds or [])[0]["tests"]]
    return [
        100 * mean(mean(t["recalls"].values()) for t in tests if t["experiment"] == experiment)
        for experiment in EXPERIMENTS
    ]


def _means(found: Mapping[str, Mapping[int, Sequence[float]]]) -> str:
    """Return the table of means, with the spread of the worlds."""
    heads = ["method", "worlds", *(f"Exp {number}" for number in EXPERIMENTS)]
    rows = [
        [method, str(len(of_world)), *map(_spread, zip(*of_world.values(), strict=True))]
        for method, of_world in found.items()
        if of_world
    ]
    return table(heads, rows)


def _each(found: Mapping[str, Mapping[int, Sequence[float]]], worlds: Sequence[int]) -> str:
    """Return the table of every world: Experiments 1 / 2 / 3 / 4."""
    rows = [
        [method, *(" / ".join(f"{each:.0f}" for each in of_world.get(w, [])) for w in worlds)]
        for method, of_world in found.items()
        if of_world
    ]
    return table(["method", *(f"world {world}" for world in worlds)], rows)


def _spread(values: Sequence[float]) -> str:
    spread = f" ± {stdev(values):.1f}" if len(values) > 1 else ""
    return f"{mean(values):.1f}{spread}"
