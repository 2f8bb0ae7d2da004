"""A bar that tells how long a metre is in a picture."""

from __future__ import annotations

from math import floor, log10
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def round_length(width: float) -> float:
    """Return the longest of 1, 2, 5, 10, ... m, or of fractions alike, in a fifth of a width."""
    whole = 10.0 ** floor(log10(width / 5))
    return float(max(whole * step for step in (1, 2, 5) if whole * step <= width / 5))


def draw_scale_bar(axes: Axes, extent: NDArray[np.float64]) -> None:
    """Draw a scale bar in the lower left corner of what is shown (m, shape (2, 2))."""
    (left, bottom), (right, top) = extent
    length = round_length(float(right - left))
    begin, height = left + 0.02 * (right - left), bottom + 0.025 * (top - bottom)
    axes.plot([begin, begin + length], [height] * 2, "|-", color="black", linewidth=2, zorder=8)
    axes.annotate(
        f"{length:g} m",
        (begin + length, height),
        xytext=(6, 0),
        textcoords="offset points",
        fontsize=11,
        va="center",
        zorder=8,
    )
