"""Scores as grouped bars (the paper's Figures 7 to 10, 13 and 14)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.grouped import Bars, draw_grouped
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.figures.style import Fill, finish, legend_below, legend_rows, method_fills
from placecue.evaluation.results.about import About
from placecue.evaluation.results.average import Number, average_score
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table
from placecue.evaluation.results.tables import with_deviation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: By group and bar: the method and experiment that are shown.
Places = Mapping[tuple[str, str], tuple[str, str]]
#: What it takes: sets of bars by method, and where the axis begins, %.
KEYS = frozenset({"groups", "bottom"})
_COLUMNS = ("panel", "group", "bar", "method", "experiment", "mean (%)", "std over pairs (%)",
            "pairs", "paper (%)")  # fmt: skip


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Draw the mean over pairs of each method's score, with the standard deviation over pairs.

    Groups are experiments and bars methods; with ``groups`` (name of a group → name of a bar →
    method) there is a panel for each experiment. The paper's numbers are marked.
    """
    panels = _panels(spec)
    found = {place: average_score(results.of(*place))
             for panel in panels.values() for place in panel.values()}  # fmt: skip
    paper = {(m, e): float(share) for m, of in about.paper.items() for e, share in of.items()}
    fills = _fills(spec, about)
    rows: list[list[Cell]] = []
    for name, panel in panels.items():
        for (group, bar), place in panel.items():
            rows.append([name, group, bar, *place, *found[place], paper.get(place)])
    drawn = [_bars(panel, found, paper, fills) for panel in panels.values()]
    notes = _notes(spec, found)
    if any(each.marks is not None for each in drawn):
        notes += ("White diamonds: what the paper reports.",)
    return Drawn(Table(_COLUMNS, rows), _table(panels, found), _figure(spec, panels, drawn), notes)


def _panels(spec: Spec) -> dict[str, Places]:
    groups = spec.options.get("groups")
    if not groups:
        return {"": {(e, spec.label(m)): (m, e) for e in spec.experiments for m in spec.methods}}
    return {
        experiment: {
            (group, bar): (method, experiment)
            for group, bars in groups.items()
            for bar, method in bars.items()
            if method in spec.methods
        }
        for experiment in spec.experiments
    }


def _fills(spec: Spec, about: About) -> dict[str, Fill]:
    """Return the look of bars: a method's own, or where a bar stands for several, its place's."""
    groups = spec.options.get("groups")
    if groups:
        return method_fills(list(dict.fromkeys(bar for bars in groups.values() for bar in bars)))
    of_method = method_fills(list(about.methods))
    return {spec.label(method): of_method[method] for method in spec.methods}


def _bars(
    panel: Places,
    found: Mapping[tuple[str, str], Number],
    paper: Mapping[tuple[str, str], float],
    fills: Mapping[str, Fill],
) -> Bars:
    groups = list(dict.fromkeys(group for group, _ in panel))
    bars = [bar for bar in fills if any(bar == there for _, there in panel)]
    values = np.full((3, len(groups), len(bars)), np.nan)
    for (group, bar), place in panel.items():
        number = found[place]
        at = groups.index(group), bars.index(bar)
        values[:, *at] = number.mean, number.deviation, paper.get(place, np.nan)
    marks = values[2] if np.isfinite(values[2]).any() else None
    return Bars(groups, bars, values[0], values[1], [fills[bar] for bar in bars], marks)


def _figure(spec: Spec, panels: Mapping[str, Places], drawn: Sequence[Bars]) -> Figure:
    from matplotlib.figure import Figure

    bottom = spec.options.get("bottom")
    bottom = min(each.bottom for each in drawn) if bottom is None else float(bottom)
    width = drawn[0].width
    columns = max(1, min(len(drawn), int(14 / width)))
    rows = -(-len(drawn) // columns)
    labels = list(dict.fromkeys(bar for each in drawn for bar in each.bars))
    height = 0.9 + 2.7 * rows + 0.19 * legend_rows(width * columns, labels)
    figure = Figure((width * columns, height), dpi=110, layout="constrained")
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for axes, name, each in zip(grid.flat, panels, drawn, strict=False):
        draw_grouped(axes, each, bottom=bottom)
        axes.set_title(name, fontsize=9)
    for axes in grid[:, 0]:
        axes.set_ylabel("balanced accuracy (%)", fontsize=9)
    for axes in list(grid.flat)[len(drawn) :]:
        axes.set_axis_off()
    legend_below(figure, grid.flat)
    finish(figure, spec.heading)
    return figure


def _table(panels: Mapping[str, Places], found: Mapping[tuple[str, str], Number]) -> Table:
    """Return a row a bar of each panel, and a column a group."""
    groups = list(dict.fromkeys(group for panel in panels.values() for group, _ in panel))
    rows: list[list[Cell]] = []
    for name, panel in panels.items():
        for bar in dict.fromkeys(bar for _, bar in panel):
            places = [panel.get((group, bar)) for group in groups]
            shown = [None if place is None else with_deviation(found[place]) for place in places]
            rows.append([*([name] if name else []), bar, *shown])
    return Table([*(["experiment"] if "" not in panels else []), "method", *groups], rows)


def _notes(spec: Spec, found: Mapping[tuple[str, str], Number]) -> tuple[str, ...]:
    """Say where methods are compared over different pairs."""
    notes = []
    for experiment in spec.experiments:
        pairs = {m: number.pairs for (m, e), number in found.items() if e == experiment}
        most = max(pairs.values(), default=0)
        for method, there in pairs.items():
            if there < most:
                notes.append(f"{experiment}: '{method}' has {there} of {most} pairs.")
    return tuple(notes)
