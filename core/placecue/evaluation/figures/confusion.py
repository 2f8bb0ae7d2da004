"""Which class is taken for which: a table, and heat maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from placecue.errors import UsageError
from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.figures.style import SMALL, UNDECIDED, finish, text_width
from placecue.evaluation.results.about import About
from placecue.evaluation.results.average import Average, average_confusion
from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

KEYS: frozenset[str] = frozenset()
#: Methods that a figure shows at most.
MOST = 12
#: Shares under this are not written, %.
SHOWN = 0.5
Confusion = Average


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Draw the confusion matrix of each method: which share of each class is taken for which.

    Raises
    ------
    UsageError
        If there are more than twelve methods.
    """
    if len(spec.methods) > MOST:
        raise UsageError(
            f"'{spec.name}': {len(spec.methods)} confusion matrices are too many for a figure; "
            f"name up to {MOST} methods"
        )
    classes, found = confusions(results, spec)
    decided = [*classes, UNDECIDED]
    shares: list[list[Cell]] = []
    rows: list[list[Cell]] = []
    for method, each in found.items():
        for row, truth in enumerate(classes):
            shares.append([spec.label(method), truth, *map(float, each.mean[row])])
            numbers = zip(decided, each.mean[row], each.deviation[row], strict=True)
            numbers = zip(decided, each.mean[row], each.deviation[row], strict=True)
            rows += [[method, truth, name, float(mean), float(std)] for name, mean, std in numbers]
    columns = ["method", "actual class", "taken for", "share (%)", "std over pairs (%)"]
    return Drawn(
        Table(columns, rows),
        Table(["method", "actual class", *decided], shares),
        _figure(spec, classes, list(found.values())),
    )


def confusions(results: Results, spec: Spec) -> tuple[list[str], dict[str, Confusion]]:
    """Return all classes, and the average confusion matrix of each method over them, %."""
    of_method = {method: chosen(results, spec, method) for method in spec.methods}
    every = [each for of in of_method.values() for each in of]
    classes = average_confusion(every)[0]
    return classes, {m: average_confusion(of, classes)[1] for m, of in of_method.items()}


def chosen(results: Results, spec: Spec, method: str) -> list[Result]:
    """Return the results of a method in the experiments of a figure."""
    return [each for e in spec.experiments for each in results.of(method, e)]


def _figure(spec: Spec, classes: Sequence[str], found: Sequence[Confusion]) -> Figure:
    from matplotlib.figure import Figure

    columns = min(len(found), 4 if len(classes) <= 6 else 2)
    rows = -(-len(found) // columns)
    side = max(1.9, 0.36 * (len(classes) + 1))
    names = text_width(classes)
    figure = Figure((columns * (side + 0.25) + names + 0.4, 0.95 + rows * (side + 0.45) + names),
                    dpi=110, layout="constrained")  # fmt: skip
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    undecided = any((each.mean[:, -1] >= SHOWN).any() for each in found)
    for axes, method, each in zip(grid.flat, spec.methods, found, strict=False):
        _panel(axes, each, classes, undecided)
        axes.set_title(_wrapped(spec.label(method), side), fontsize=SMALL)
    for axes in list(grid.flat)[len(found) :]:
        axes.set_axis_off()
    figure.supylabel("actual class", fontsize=9)
    figure.supxlabel("taken for (%)", fontsize=9)
    finish(figure, spec.heading)
    return figure


def _wrapped(text: str, inches: float) -> str:
    from textwrap import fill

    return fill(text, max(10, int(inches / 0.068)))


def _panel(axes: Axes, each: Confusion, classes: Sequence[str], undecided: bool) -> None:
    names = [*classes, *([UNDECIDED] if undecided else [])]
    shares = each.mean[:, : len(names)]
    axes.imshow(shares, cmap="Blues", vmin=0, vmax=100)
    axes.set_xticks(range(len(names)), names, rotation=90)
    axes.set_yticks(range(len(classes)), classes)
    axes.tick_params(labelsize=SMALL, length=0)
    for (row, column), share in np.ndenumerate(shares):
        if np.isfinite(share) and share >= SHOWN:
            axes.text(column, row, f"{share:.0f}", ha="center", va="center", fontsize=SMALL - 1,
                      color="white" if share > 55 else "black")  # fmt: skip
