"""A small picture of a robot's way out of characters, for the terminal."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from rich.text import Text

#: Dots of a Braille character are two wide and four high; the bit of each, row by row.
BRAILLE = 0x2800
BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
Cell = tuple[int, int]


def thumbnail(
    trail: Sequence[tuple[float, float, str]],
    colours: Mapping[str, str],
    columns: int = 60,
    rows: int = 20,
    plain: bool = False,
) -> Text:
    """Draw positions with Braille dots, x to the right and y upwards, in one scale.

    Parameters
    ----------
    trail : sequence of (x, y, label)
        Positions, m.
    colours : mapping of str to str
        Colour of each label, as ``#rrggbb``; a character takes that of the label most of its
        dots have.
    columns, rows : int
        Characters that the picture may take up.
    plain : bool
        Whether to make do with the characters of ASCII.

    Returns
    -------
    Text
        Lines without blanks at their ends; empty where there is nothing to draw.
    """
    whole = [(x, y, label) for x, y, label in trail if np.isfinite([x, y]).all()]
    if not whole:
        return Text()
    points = np.array([(x, y) for x, y, _ in whole])
    low, span = points.min(axis=0), np.ptp(points, axis=0)
    scale = max(span[0] / (2 * columns - 1), span[1] / (4 * rows - 1), 1e-9)
    height = int(span[1] / scale) // 4 + 1
    cells: defaultdict[Cell, _Cell] = defaultdict(_Cell)
    for (right, up), (_, _, label) in zip(((points - low) / scale).astype(int), whole, strict=True):
        down = 4 * height - 1 - up
        cell = cells[down // 4, right // 2]
        cell.bits |= BITS[down % 4][right % 2]
        cell.labels[label] += 1
    return Text("\n").join(_line(cells, line, colours, plain) for line in range(height))


class _Cell:
    """One character: its dots, and how often each label lies in it."""

    def __init__(self) -> None:
        self.bits = 0
        self.labels: Counter[str] = Counter()


def _line(cells: Mapping[Cell, _Cell], line: int, colours: Mapping[str, str], plain: bool) -> Text:
    text = Text()
    for column in range(max((c for row, c in cells if row == line), default=-1) + 1):
        cell = cells.get((line, column))
        if cell is None:
            text.append(" ")
        else:
            sign = "*" if plain else chr(BRAILLE + cell.bits)
            text.append(sign, colours.get(cell.labels.most_common(1)[0][0]))
    return text
