"""How large a text is in a figure, in the unit of its axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Around a text, pixels: it has a white edge.
EDGE = 3
#: Of a line of text, in its size.
LINE = 1.25
#: The size that is measured, points.
MEASURED = 12.0


class TextSizes:
    """Measures texts.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        One with a canvas of Agg.
    unit : float
        How many pixels one is that sizes are told in.
    """

    def __init__(self, figure: Figure, unit: float) -> None:
        canvas: Any = figure.canvas
        self.renderer = canvas.get_renderer()
        self.unit = unit
        self.dpi = figure.dpi
        self._widths: dict[str, float] = {}

    def __call__(self, text: str, size: float) -> tuple[float, float]:
        """Return width and height of a text of letters of a size in points."""
        lines = text.split("\n")
        width = max(map(self._width, lines)) * size
        height = len(lines) * LINE * size * self.dpi / 72
        return (width + 2 * EDGE) / self.unit, (height + 2 * EDGE) / self.unit

    def _width(self, line: str) -> float:
        """Return how wide a line is for each point of its size, pixels; measuring takes long."""
        from matplotlib.font_manager import FontProperties

        if line not in self._widths:
            font = FontProperties(size=MEASURED)
            width = self.renderer.get_text_width_height_descent(line, font, False)[0]
            self._widths[line] = width / MEASURED
        return self._widths[line]
