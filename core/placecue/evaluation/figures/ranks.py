"""Mean ranks with what cannot be told apart joined by a bar (the paper's Figures 11 and 15).

References
----------
Demšar, Statistical comparisons of classifiers over multiple data sets, JMLR 7, 2006, Figure 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.shared import scores_of, shared
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.figures.style import SMALL, finish, method_fills, text_width
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table
from placecue.evaluation.statistics import ALPHA, Friedman, friedman, nemenyi

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: What it takes: the level of significance.
KEYS = frozenset({"alpha"})
#: Inches: between two names, between two bars, of the axis itself, above it, and round all.
ROW, BAR, AXIS, ABOVE, MARGIN = 0.2, 0.1, 5.0, 0.5, 0.15
LEFT_OUT = "{} more pairs are left out: not all methods have a score of them."
#: What the test does not know.
DEPENDENT = "Pairs that share a recording are not independent, as the test takes them to be."
#: Inches that the heading takes.
HEADING = 0.45


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Draw a critical-difference diagram over all pairs that all methods have results of.

    Raises
    ------
    DataError, UsageError
        As :func:`placecue.evaluation.statistics.friedman` does.
    """
    of_method = scores_of(results, spec)
    scores = shared(of_method, spec.methods)
    left = len({pair for of in of_method.values() for pair in of}) - len(scores)
    test = friedman(scores, float(spec.options.get("alpha", ALPHA)))
    order = np.argsort(test.ranks, kind="stable")
    p = nemenyi(scores)[np.ix_(order, order)]
    labels = [spec.label(spec.methods[at]) for at in order]
    colours = [method_fills(list(about.methods))[spec.methods[at]].color for at in order]
    table: list[list[Cell]] = [
        [label, float(test.ranks[at]), float(100 * scores[:, at].mean())]
        for label, at in zip(labels, order, strict=True)
    ]
    numbers = [[*row, *map(float, each)] for row, each in zip(table, p, strict=True)]
    columns = ["method", "mean rank", "mean (%)"]
    return Drawn(
        Table([*columns, *(f"Nemenyi p against {label}" for label in labels)], numbers),
        Table(columns, table, digits=2),
        _figure(spec, test, labels, colours),
        (said(test), DEPENDENT, *([LEFT_OUT.format(left)] if left else [])),
    )


def said(test: Friedman) -> str:
    """Return what Friedman's test says, in a line."""
    f = "∞" if np.isinf(test.f) else f"{test.f:.2f}"
    verdict = "methods differ" if test.p < test.alpha else "no difference is shown"
    return (
        f"Friedman over {test.n} pairs, without correction for ties: χ² = {test.chi2:.2f}, "
        f"Iman–Davenport F = {f}, {p_value(test.p)}: {verdict} at α = {test.alpha:g}; "
        f"critical difference (Nemenyi) {test.critical_difference:.2f}."
    )


def p_value(p: float) -> str:
    """Return a p-value as people read it."""
    return f"p = {p:.3f}" if p >= 0.001 else "p < 0.001"


def alike(ranks: NDArray[np.float64], difference: float) -> list[tuple[int, int]]:
    """Return first and last of each largest run of sorted ranks that are no more than so far apart.

    Runs of one are left out, and those within another.
    """
    last = [int(np.flatnonzero(ranks - rank <= difference)[-1]) for rank in ranks]
    return [
        (first, end)
        for first, end in enumerate(last)
        if end > first and (first == 0 or end > last[first - 1])
    ]


def _figure(spec: Spec, test: Friedman, labels: Sequence[str], colours: Sequence[str]) -> Figure:
    """Lay the diagram out in inches: names left and right, the axis with its bars between."""
    from matplotlib.figure import Figure

    ranks, k = np.sort(test.ranks), len(labels)
    runs = alike(ranks, test.critical_difference)
    side = text_width(labels) + 0.65
    half = -(-k // 2)
    first_row = 0.25 + BAR * len(runs)
    width = 2 * side + AXIS
    height = ABOVE + first_row + ROW * half + MARGIN + HEADING
    figure = Figure((width, height), dpi=110)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, width)
    axes.set_ylim(height, 0)
    axes.set_axis_off()
    finish(figure, spec.heading)
    x, y = side + (ranks - 1) / (k - 1) * AXIS, HEADING + ABOVE
    _axis(axes, side, y, k, test.critical_difference)
    for number, (first, last) in enumerate(runs):
        axes.plot([x[first] - 0.04, x[last] + 0.04], [y + 0.14 + BAR * number] * 2, color="#222222",
                  lw=3, solid_capstyle="butt")  # fmt: skip
    for at in range(k):
        left = at < half
        row = at if left else k - 1 - at
        _name(axes, (float(x[at]), y, y + first_row + ROW * row), side if left else width - side,
              f"{labels[at]}", float(ranks[at]), colours[at], left)  # fmt: skip
    return figure


def _axis(axes: Axes, side: float, y: float, k: int, difference: float) -> None:
    scale = AXIS / (k - 1)
    axes.plot([side, side + AXIS], [y, y], color="black", lw=1)
    step = -(-k // 20)
    for rank in range(1, k + 1):
        axes.plot([side + (rank - 1) * scale] * 2, [y - 0.06, y], color="black", lw=0.8)
        if rank == k or ((rank - 1) % step == 0 and rank + step <= k):
            axes.text(side + (rank - 1) * scale, y - 0.09, str(rank), ha="center", fontsize=SMALL)
    top, end = y - 0.36, side + min(difference, k - 1) * scale
    bracket = [top - 0.04, top + 0.04, top, top, top - 0.04, top + 0.04]
    axes.plot([side, side, side, end, end, end], bracket, color="black", lw=1)
    axes.text(end + 0.06, top, f"critical difference {difference:.2f}", va="center", fontsize=SMALL)


def _name(
    axes: Axes,
    down: tuple[float, float, float],
    end: float,
    label: str,
    rank: float,
    colour: str,
    left: bool,
) -> None:
    """Draw the line from a rank (x, y of the axis, y of the name) to a name, and write it."""
    x, y, row = down
    axes.plot([x, x, end], [y, row, row], color=colour, lw=1.1)
    place, away = ("right", -0.06) if left else ("left", 0.06)
    text = f"{label}  {rank:.2f}" if left else f"{rank:.2f}  {label}"
    axes.text(end + away, row, text, ha=place, va="center", fontsize=SMALL)
