"""Colours and axes that all figures share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from placecue.evaluation.map_styles import GREY, PALETTE
from placecue.evaluation.pictures import boxes_for_unknown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Tol's "muted" colours with two more, told apart by the colour-blind too; those of places are
#: others. Eleven is prime: of methods in blocks (three extensions of each cue, say) those that
#: are compared, every third, do not come out alike.
METHODS = ("#332288", "#DDCC77", "#44AA99", "#CC6677", "#88CCEE", "#882255", "#117733",
           "#EE7733", "#999933", "#AA4499", "#AAAAAA")  # fmt: skip
#: What is drawn over a colour when all have been used up once, twice, ...
HATCHES = ("", "///", "--", "xx", "||")
UNDECIDED = "undecided"
PAPER = "the paper"
SMALL = 8


class Fill(NamedTuple):
    """The look of a bar."""

    color: str
    hatch: str


def method_fills(methods: Sequence[str]) -> dict[str, Fill]:
    """Return the look of each method: by its place among all of the experiment."""
    return _fills(methods, METHODS)


def class_fills(classes: Sequence[str]) -> dict[str, Fill]:
    """Return the look of each class, in the colours of maps; undecided is grey."""
    return {**_fills(classes, PALETTE), UNDECIDED: Fill(GREY, "")}


def text_width(texts: Sequence[str], size: float = SMALL) -> float:
    """Return about how wide the longest of some texts is, inches."""
    return max((len(each) for each in texts), default=0) * size * 0.0085


def plain(axes: Axes, grid: str = "y") -> None:
    """Take off what says nothing, and draw a light grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis=grid, color="#dddddd", lw=0.6)  # type: ignore[arg-type]
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=SMALL)


def legend_below(figure: Figure, panels: Iterable[Axes]) -> None:
    """Explain what is drawn under all panels, in as many columns as there is room for."""
    found: dict[str, Any] = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        found = dict(zip(labels, handles, strict=True)) | found
    # What is another source's comes last.
    labels = sorted(found, key=lambda label: label == PAPER)
    figure.legend([found[label] for label in labels], labels, loc="outside lower center",
                  fontsize=SMALL, frameon=False, ncols=legend_columns(figure, labels))  # fmt: skip


def legend_rows(width: float, labels: Sequence[str]) -> int:
    """Return how many rows names take under a figure so wide, inches."""
    return -(-len(labels) // max(1, int((width - 0.3) / (text_width(labels) + 0.55))))


def legend_columns(figure: Figure, labels: Sequence[str]) -> int:
    """Return into how many columns names go, of about the same length."""
    return max(1, -(-len(labels) // max(legend_rows(figure.get_figwidth(), labels), 1)))


def finish(figure: Figure, heading: str) -> None:
    """Write the heading, in lines that fit the width, and lay everything out, once.

    Laid out anew for each format, a figure would look a little different each time.
    """
    from textwrap import fill

    figure.suptitle(fill(heading, int(figure.get_figwidth() / 0.093)), fontsize=10)
    with boxes_for_unknown():
        figure.draw_without_rendering()
    figure.set_layout_engine("none")


def _fills(names: Sequence[str], palette: Sequence[str]) -> dict[str, Fill]:
    rounds = len(HATCHES)
    return {
        name: Fill(palette[i % len(palette)], HATCHES[i // len(palette) % rounds])
        for i, name in enumerate(names)
    }
