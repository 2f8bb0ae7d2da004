"""For which share of the samples each cue was used (the paper's Table 2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from placecue.errors import DataError
from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.grouped import Bars, draw_grouped
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.figures.style import finish, legend_below, method_fills
from placecue.evaluation.results.about import About
from placecue.evaluation.results.average import Number, averaged
from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table
from placecue.evaluation.results.tables import with_deviation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KEYS: frozenset[str] = frozenset()
#: By method and cue: a number an experiment.
Shares = Mapping[tuple[str, str], Sequence[Number]]


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Draw for which share of samples each cue was asked, and the score that came of it.

    Without ``methods`` it shows those that did not ask every cue every time.

    Raises
    ------
    DataError
        If no method tells of cues that it left out.
    """
    told = told_methods(results, spec)
    methods = [method for method in spec.methods if method in told]
    if not methods:
        raise DataError("every method used all its cues for every sample: nothing to show")
    found = {
        (method, cue): [used_share(results.of(method, e), cue) for e in spec.experiments]
        for method in methods
        for cue in _cues(results.of(method))
    }
    rows: list[list[Cell]] = [
        [method, cue, experiment, *number]
        for (method, cue), of in found.items()
        for experiment, number in zip(spec.experiments, of, strict=True)
    ]
    table: list[list[Cell]] = [
        [spec.label(method), cue, *map(with_deviation, of)] for (method, cue), of in found.items()
    ]
    columns = ["method", "cue", "experiment", "used (% of samples)", "std over pairs (%)", "pairs"]
    return Drawn(
        Table(columns, rows),
        Table(["method", "cue", *spec.experiments], table),
        _figure(spec, methods, found),
    )


def told_methods(results: Results, spec: Spec) -> set[str]:
    """Return the methods that a figure of this kind shows: where a cue was left out."""
    return {
        each.method
        for each in results
        if each.pair.experiment in spec.experiments and any((~u).any() for u in each.used.values())
    }


def used_share(results: Sequence[Result], cue: str) -> Number:
    """Return for which share of the samples a cue was asked, %, averaged over pairs."""
    told = [each for each in results if cue in each.used and len(each)]
    if not told:
        return Number(float("nan"), float("nan"), 0)
    found = averaged([each.pair for each in told], [100 * each.used[cue].mean() for each in told])
    return Number(float(found.mean), float(found.deviation), int(found.pairs))


def _cues(results: Sequence[Result]) -> list[str]:
    return list(dict.fromkeys(cue for each in results for cue in each.used))


def _figure(spec: Spec, methods: Sequence[str], found: Shares) -> Figure:
    from matplotlib.figure import Figure

    fills = method_fills(list(dict.fromkeys(cue for _, cue in found)))
    panels = [_bars(spec, method, found, fills) for method in methods]
    columns = max(1, min(len(panels), int(14 / panels[0].width)))
    rows = -(-len(panels) // columns)
    figure = Figure((panels[0].width * columns, 1.1 + 2.2 * rows), dpi=110, layout="constrained")
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for axes, method, bars in zip(grid.flat, methods, panels, strict=False):
        draw_grouped(axes, bars, bottom=0)
        axes.set_title(spec.label(method), fontsize=9)
    for axes in grid[:, 0]:
        axes.set_ylabel("used (% of samples)", fontsize=9)
    for axes in list(grid.flat)[len(panels) :]:
        axes.set_axis_off()
    legend_below(figure, grid.flat)
    finish(figure, spec.heading)
    return figure


def _bars(spec: Spec, method: str, found: Shares, fills: Mapping[str, object]) -> Bars:
    of = {cue: numbers for (there, cue), numbers in found.items() if there == method}
    return Bars(
        spec.experiments,
        list(of),
        np.array([[n.mean for n in numbers] for numbers in of.values()]).T,
        np.array([[n.deviation for n in numbers] for numbers in of.values()]).T,
        [fills[cue] for cue in of],  # type: ignore[misc]
    )
