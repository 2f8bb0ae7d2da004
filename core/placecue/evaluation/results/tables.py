"""Tables of all results, and of methods by experiments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from placecue.atomic import write_text
from placecue.evaluation.results.average import Number, average_score
from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import NOTHING, Cell, Table

FILE = "results.csv"


def results_table(results: Results) -> Table:
    """Return a row a result: scores and recalls are 0 to 1, failures have their reason."""
    classes = sorted({name for each in results for name in each.classes})
    columns = ["experiment", "world", "train", "test", "method", "samples", "score"]
    columns += [f"recall:{name}" for name in classes]
    return Table([*columns, "error"], [_row(each, classes) for each in results])


def write_results(results: Results, folder: Path) -> Path:
    """Write :func:`results_table` into ``results.csv`` of a folder."""
    return write_text(folder / FILE, results_table(results).csv())


def summary_numbers(results: Results, methods: Sequence[str], experiments: Sequence[str]) -> Table:
    """Return a row a method and experiment: mean, standard deviation (%), and pairs."""
    rows: list[list[Cell]] = []
    for method in methods:
        for experiment in experiments:
            number = average_score(results.of(method, experiment))
            rows.append([method, experiment, *number])
    return Table(["method", "experiment", "mean (%)", "std over pairs (%)", "pairs"], rows)


def summary_table(results: Results, methods: Sequence[str], experiments: Sequence[str]) -> Table:
    """Return a row a method and a column an experiment: mean ± standard deviation (%).

    The number of pairs stands behind where it is not that of the experiment's other methods.
    """
    found = {
        (method, experiment): average_score(results.of(method, experiment))
        for method in methods
        for experiment in experiments
    }
    most = {e: max((found[m, e].pairs for m in methods), default=0) for e in experiments}
    columns = ["method", *(f"{e} ({counted(most[e])})" for e in experiments)]
    return Table(
        columns,
        [[m, *(with_deviation(found[m, e], most[e]) for e in experiments)] for m in methods],
    )


def with_deviation(number: Number, pairs: int | None = None) -> str:
    """Return ``95.1 ± 2.3``, and of how many pairs where it is not of ``pairs``."""
    if not number.pairs:
        return NOTHING
    spread = "" if number.deviation != number.deviation else f" ± {number.deviation:.1f}"
    count = "" if pairs in (None, number.pairs) else f" ({counted(number.pairs)})"
    return f"{number.mean:.1f}{spread}{count}"


def counted(pairs: int) -> str:
    """Return ``1 pair`` or ``12 pairs``."""
    return f"{pairs} pair{'' if pairs == 1 else 's'}"


def _row(result: Result, classes: Sequence[str]) -> list[Cell]:
    pair, recalls = result.pair, result.recalls
    where: list[Cell] = [pair.experiment, pair.world, " + ".join(pair.train), pair.test]
    shares = [recalls.get(name) for name in classes]
    return [*where, result.method, len(result), result.score, *shares, result.error]
