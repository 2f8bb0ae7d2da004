"""Grouped bars: of every group the same bars, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.figures.style import PAPER, SMALL, Fill, plain, text_width

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Share of the room between two groups that bars take.
FILLED = 0.84
#: And one bar at most.
WIDEST = 0.35


class Bars(NamedTuple):
    """What is drawn; arrays have shape (groups, bars), NaN where there is none.

    Parameters
    ----------
    groups, bars : sequence of str
        Names of the groups, and of the bars of each.
    heights, deviations : ndarray of float64
        And of the whiskers.
    fills : sequence of Fill
        The look of each bar.
    marks : ndarray of float64, optional
        What another source says, drawn as a diamond.
    """

    groups: Sequence[str]
    bars: Sequence[str]
    heights: NDArray[np.float64]
    deviations: NDArray[np.float64]
    fills: Sequence[Fill]
    marks: NDArray[np.float64] | None = None

    @property
    def width(self) -> float:
        """How wide a panel of it is to be, inches."""
        bar = min(0.26, max(0.11, 10 / max(self.heights.size, 1)))
        group = max(len(self.bars) * bar / FILLED, min(text_width(self.groups), 1.1))
        return min(14.0, max(5.0, 0.9 + len(self.groups) * group))

    @property
    def bottom(self) -> float:
        """Where its axis begins: at a full ten, ten below everything or more, never under 0."""
        low = [self.heights - np.nan_to_num(self.deviations), self.heights]
        low += [] if self.marks is None else [self.marks]
        found = np.concatenate([each[np.isfinite(each)] for each in low])
        return max(0.0, 10 * np.floor((found.min() - 5) / 10)) if len(found) else 0.0


def draw_grouped(
    axes: Axes, what: Bars, *, top: float = 101.5, bottom: float | None = None
) -> None:
    """Draw bars with whiskers into axes that go from ``bottom`` to 100 %."""
    from matplotlib.ticker import MultipleLocator

    at, width = np.arange(len(what.groups)), min(FILLED / max(len(what.bars), 1), WIDEST)
    bottom = what.bottom if bottom is None else bottom
    for number, (name, fill) in enumerate(zip(what.bars, what.fills, strict=True)):
        x = at + (number - (len(what.bars) - 1) / 2) * width
        height = what.heights[:, number]
        axes.bar(x, height, width, label=name, **fill._asdict(), edgecolor="white", linewidth=0.5)
        # Nothing is above 100 %.
        whisker = what.deviations[:, number], np.minimum(what.deviations[:, number], 100 - height)
        axes.errorbar(x, height, whisker, fmt="none", ecolor="#222222",
                      elinewidth=0.8, capsize=min(2.5, 25 * width))  # fmt: skip
        if what.marks is not None and np.isfinite(what.marks[:, number]).any():
            axes.plot(x, what.marks[:, number], "D", color="white", markeredgecolor="black",
                      markersize=4.5, zorder=5, label="_")  # fmt: skip
    if what.marks is not None and np.isfinite(what.marks).any():
        axes.plot([], [], "D", color="white", markeredgecolor="black", label=PAPER)
    axes.set_ylim(bottom, 101.5)  # a whisker that ends at 100 is seen
    axes.set_xlim(-0.5, max(len(what.groups), 1) - 0.5)
    axes.set_xticks(at, what.groups)
    axes.yaxis.set_major_locator(MultipleLocator(5 if bottom >= 50 else 10))
    plain(axes)
    axes.tick_params(axis="x", length=0)
    _turn(axes, what)


def _turn(axes: Axes, what: Bars) -> None:
    """Turn the names of groups where they would run into one another."""
    room = (what.width - 0.9) / max(len(what.groups), 1)
    if text_width(what.groups, SMALL) > room:
        for label in axes.get_xticklabels():
            label.set(rotation=25, ha="right", rotation_mode="anchor")
