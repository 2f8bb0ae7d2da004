"""The tables of docs/laser.md, written between their markers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import mean, stdev

from cues_and_classifiers_results import Cell, Results
from laser_worlds_data import RECORDINGS, Recording

EXPERIMENTS = (1, 2, 3, 4)


def cell(world: int, method: str, train: Recording) -> Cell:
    """Return where the outcome of training on a recording is kept."""
    return Cell(f"world{world}", method, "idol2", train.name)


def write(page: Path, results: Results, worlds: Sequence[int], methods: Sequence[str]) -> None:
    """Put the tables into the page, each between ``<!-- table NAME -->`` and ``<!-- end -->``."""
    found = {
        method: {world: scores for world in worlds if (scores := in_world(results, world, method))}
        for method in methods
    }
    tables = {"experiments": _means(found), "worlds": _each(found, worlds)}
    text = page.read_text(encoding="utf-8")
    for name, table in tables.items():
        before, mark, rest = text.partition(f"<!-- table {name} -->\n")
        _, end, after = rest.partition("<!-- end -->")
        text = before + mark + table + end + after
    page.write_text(text, encoding="utf-8")


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


def _means(found: dict[str, dict[int, list[float]]]) -> str:
    """Return the table of means, with the spread of the worlds."""
    lines = _head(["method", "worlds", *(f"Exp {number}" for number in EXPERIMENTS)])
    for method, of_world in found.items():
        if of_world:
            columns = zip(*of_world.values(), strict=True)
            lines.append(_row([method, str(len(of_world)), *map(_spread, columns)]))
    return "\n".join(lines) + "\n"


def _each(found: dict[str, dict[int, list[float]]], worlds: Sequence[int]) -> str:
    """Return the table of every world: Experiments 1 / 2 / 3 / 4."""
    lines = _head(["method", *(f"world {world}" for world in worlds)])
    for method, of_world in found.items():
        cells = [" / ".join(f"{each:.0f}" for each in of_world.get(world, [])) for world in worlds]
        lines.append(_row([method, *cells]))
    return "\n".join(lines) + "\n"


def _head(names: Sequence[str]) -> list[str]:
    return [_row(names), "|---" * len(names) + "|"]


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _spread(values: Sequence[float]) -> str:
    spread = f" ± {stdev(values):.1f}" if len(values) > 1 else ""
    return f"{mean(values):.1f}{spread}"
