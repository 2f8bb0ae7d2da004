"""The legend of a map picture: of what is there only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from placecue.evaluation.map_layers import WALL, unknown_colour
from placecue.evaluation.map_styles import GREY, HATCH, Style, shade
from placecue.semantic_map import UNKNOWN

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Shown:
    """What a picture shows beside categories.

    Parameters
    ----------
    doors, walls, beliefs, truth : bool
        Whether there is one.
    """

    doors: bool
    walls: bool
    beliefs: bool
    truth: bool


def draw_legend(figure: Figure, styles: Mapping[str, Style], shown: Shown) -> None:
    """Draw the legend below the picture."""
    from matplotlib.legend_handler import HandlerTuple

    entries = [_category(name, style) for name, style in styles.items()] + _others(shown)
    if not entries:
        return
    handles, texts = zip(*entries, strict=True)
    # A letter is about 0.1 inches wide at this size, mark and space about 0.6.
    widest = 0.1 * max(len(text) for text in texts) + 0.6
    columns = min(len(texts), max(1, int(figure.get_figwidth() / widest)))
    figure.legend(
        handles,
        texts,
        handler_map={tuple: HandlerTuple(ndivide=1)},
        loc="outside lower center",
        ncols=columns,
        fontsize=12,
        frameon=False,
    )


def _category(name: str, style: Style) -> tuple[tuple[Artist, ...], str]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colour, shape = style
    if name == UNKNOWN:
        patch = Patch(facecolor=unknown_colour(), edgecolor="#B5B5B5", hatch=HATCH)
    else:
        patch = Patch(facecolor=shade(colour, 1.0), edgecolor=colour)
    marks: dict[str, Any] = {"markeredgecolor": "black", "markeredgewidth": 0.5, "markersize": 6}
    return (patch, Line2D([], [], color=colour, marker=shape, linestyle="none", **marks)), name


def _others(shown: Shown) -> list[tuple[tuple[Artist, ...], str]]:
    from matplotlib.lines import Line2D

    def mark(shape: str, size: float, colour: str = GREY) -> tuple[Artist, ...]:
        kind: dict[str, Any] = {"markeredgewidth": 0, "linestyle": "none"}
        return (Line2D([], [], color=colour, marker=shape, markersize=size, **kind),)

    return [
        *[((Line2D([], [], color="black", linewidth=3.5),), "door passed")] * shown.doors,
        *[(mark("s", 6, WALL), "seen by the laser")] * shown.walls,
        *[(mark("o", 3), "single belief")] * shown.beliefs,
        *[(mark("o", 6), "true class (ring)" if shown.beliefs else "true class")] * shown.truth,
    ]
