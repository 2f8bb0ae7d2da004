"""How maps are coloured: a colour and a shape for each category, pale where it is unsure."""

from __future__ import annotations

from collections.abc import Sequence

from placecue.semantic_map import UNKNOWN

#: Okabe and Ito's palette, told apart by the colour-blind too; black is kept for doors.
PALETTE = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442")
#: Shapes of nodes; the second is taken when the palette has been used up once, and so on.
SHAPES = ("o", "s", "^", "D", "v", "p", "X")
GREY = "#8A8A8A"
#: What lies over the surface of an unknown area.
HATCH = "////"
#: The share of its colour that an area has where it is as probable as not, and where it is sure.
PALEST, STRONGEST = 0.2, 0.75

Style = tuple[str, str]


def category_styles(names: Sequence[str]) -> dict[str, Style]:
    """Return a colour and a shape for each category; ``unknown`` is a grey disc.

    Parameters
    ----------
    names : sequence of str
        The categories; one has the same style in all pictures that list the same.

    Returns
    -------
    dict of str to (str, str)
        Colour (``#RRGGBB``) and matplotlib marker.
    """
    styles = {
        name: (PALETTE[i % len(PALETTE)], SHAPES[i // len(PALETTE) % len(SHAPES)])
        for i, name in enumerate(name for name in names if name != UNKNOWN)
    }
    return {**styles, UNKNOWN: (GREY, "o")}


def shade(colour: str, confidence: float) -> str:
    """Return a colour (``#RRGGBB``) mixed with white, the paler the less confident (0 to 1)."""
    share = PALEST + (STRONGEST - PALEST) * min(max(2 * confidence - 1, 0.0), 1.0)
    parts = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(255 - share * (255 - part)):02X}" for part in parts)
