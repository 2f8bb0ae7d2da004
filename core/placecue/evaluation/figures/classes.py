"""Recognition of each class (the paper's Table 1 and Figure 18)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from placecue.evaluation.figures.confusion import confusions
from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.grouped import Bars, draw_grouped
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.figures.style import finish, legend_below, legend_rows, method_fills
from placecue.evaluation.results.about import About
from placecue.evaluation.results.average import Number
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table
from placecue.evaluation.results.tables import with_deviation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: What it takes: where the axis begins, %.
KEYS = frozenset({"bottom"})


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Draw which share of each class each method recognises, averaged over pairs that have it."""
    classes, found = confusions(results, spec)
    numbers = {
        method: [Number(float(each.mean[i, i]), float(each.deviation[i, i]), int(each.pairs[i, i]))
                 for i in range(len(classes))]
        for method, each in found.items()
    }  # fmt: skip
    rows: list[list[Cell]] = [
        [method, name, *number]
        for method, of in numbers.items()
        for name, number in zip(classes, of, strict=True)
    ]
    table: list[list[Cell]] = [
        [spec.label(method), *map(with_deviation, of), float(np.nanmean([n.mean for n in of]))]
        for method, of in numbers.items()
    ]
    columns = ["method", "class", "recall (%)", "std over pairs (%)", "pairs"]
    fills = method_fills(list(about.methods))
    bars = Bars(
        classes,
        [spec.label(method) for method in numbers],
        np.array([[n.mean for n in of] for of in numbers.values()]).T,
        np.array([[n.deviation for n in of] for of in numbers.values()]).T,
        [fills[method] for method in numbers],
    )
    return Drawn(
        Table(columns, rows), Table(["method", *classes, "mean"], table), _figure(spec, bars)
    )


def _figure(spec: Spec, bars: Bars) -> Figure:
    from matplotlib.figure import Figure

    height = 3.5 + 0.19 * legend_rows(bars.width, bars.bars)
    figure = Figure((bars.width, height), dpi=110, layout="constrained")
    axes = figure.subplots()
    bottom = spec.options.get("bottom")
    draw_grouped(axes, bars, bottom=None if bottom is None else float(bottom))
    axes.set_ylabel("recognised (% of the class)", fontsize=9)
    legend_below(figure, [axes])
    finish(figure, spec.heading)
    return figure
