"""What errors of each class are taken for (the paper's Figure 12)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.figures.confusion import Confusion, confusions
from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.figures.style import (
    SMALL,
    UNDECIDED,
    class_fills,
    finish,
    legend_columns,
    plain,
    text_width,
)
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

KEYS: frozenset[str] = frozenset()
#: Panels that stand in a row.
ACROSS = 3
COLUMNS = ("actual class", "method", "errors (% of class)", "taken for", "% of errors",
           "% of class")  # fmt: skip
NOTE = (
    "Bars: 100 % are all errors of a method on the class; the number behind is which share of "
    "the class they are."
)


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Draw, for each actual class and method, how its errors are spread over the other classes.

    Every bar is all errors of a method on a class; which share of the class they are stands
    behind it. Shares of a class are averaged over pairs.
    """
    classes, found = confusions(results, spec)
    decided = [*classes, UNDECIDED]
    spread = {method: _spread(each) for method, each in found.items()}
    rows: list[list[Cell]] = []
    shown: list[list[Cell]] = []
    for row, truth in enumerate(classes):
        for method in spec.methods:
            of_class, of_errors = found[method].mean[row], spread[method][row]
            wrong = 100 - float(of_class[row])
            others = [at for at in range(len(decided)) if at != row]
            parts = [None if at == row else float(share) for at, share in enumerate(of_errors)]
            shown.append([truth, spec.label(method), wrong, *parts])
            rows += [[truth, method, wrong, decided[at], float(of_errors[at]), float(of_class[at])]
                     for at in others]  # fmt: skip
    return Drawn(
        Table(COLUMNS, rows),
        Table(["actual class", "method", "errors (%)", *decided], shown),
        _figure(spec, classes, found, spread),
        (NOTE,),
    )


def _spread(confusion: Confusion) -> NDArray[np.float64]:
    """Return each class's errors over what they were taken for, %, shape (M, M + 1)."""
    wrong = confusion.mean.copy()
    np.fill_diagonal(wrong, 0)
    total = wrong.sum(axis=1, keepdims=True)
    return np.asarray(100 * wrong / np.where(total > 0, total, np.nan))


def _figure(
    spec: Spec,
    classes: Sequence[str],
    found: Mapping[str, Confusion],
    spread: Mapping[str, NDArray[np.float64]],
) -> Figure:
    from matplotlib.figure import Figure

    labels = [spec.label(method) for method in spec.methods]
    columns = min(ACROSS, len(classes))
    rows = -(-len(classes) // columns)
    width = text_width(labels) + 0.4 + 2.9 * columns
    figure = Figure((width, 1.2 + rows * (0.55 + 0.2 * len(labels))), dpi=110, layout="constrained")
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for row, (axes, truth) in enumerate(zip(grid.flat, classes, strict=False)):
        shares = np.array([spread[method][row] for method in spec.methods])
        wrong = [100 - float(found[method].mean[row, row]) for method in spec.methods]
        _panel(axes, shares, wrong, classes)
        axes.set_title(f"actual class: {truth}", fontsize=9)
        axes.set_yticks(range(len(labels)), labels)
    for axes in list(grid.flat)[len(classes) :]:
        axes.set_axis_off()
    undecided = any((each[:, -1] > 0).any() for each in spread.values())
    _legend(figure, [*classes, *([UNDECIDED] if undecided else [])])
    finish(figure, spec.heading)
    return figure


def _panel(
    axes: Axes, shares: NDArray[np.float64], wrong: Sequence[float], classes: Sequence[str]
) -> None:
    at = np.arange(len(shares))
    begin = np.zeros(len(shares))
    fills = class_fills(classes)
    for column, name in enumerate([*classes, UNDECIDED]):
        part = np.nan_to_num(shares[:, column])
        axes.barh(at, part, 0.78, left=begin, **fills[name]._asdict(), edgecolor="white",
                  linewidth=0.5)  # fmt: skip
        begin += part
    for place, share in enumerate(wrong):
        axes.text(102, place, "–" if np.isnan(share) else f"{share:.1f} %", va="center",
                  fontsize=SMALL - 1)  # fmt: skip
    axes.set_xlim(0, 125)
    axes.set_xticks([0, 25, 50, 75, 100])
    axes.set_ylim(len(shares) - 0.4, -0.6)
    plain(axes, "x")
    axes.tick_params(axis="y", length=0)


def _legend(figure: Figure, names: Sequence[str]) -> None:
    from matplotlib.patches import Patch

    fills = class_fills([name for name in names if name != UNDECIDED])
    handles = [Patch(facecolor=color, hatch=hatch, edgecolor="white", label=name)
               for name, (color, hatch) in ((name, fills[name]) for name in names)]  # fmt: skip
    figure.legend(handles=handles, loc="outside lower center", fontsize=SMALL, frameon=False,
                  title="taken for (% of the errors)", title_fontsize=SMALL,
                  ncols=legend_columns(figure, names))  # fmt: skip
