"""Parts of words and numbers: tables, facts and notes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

Cell: TypeAlias = str | int | float | None

DASH = "–"
#: How other tables tell that there is nothing.
_NOTHING = ("", "-", DASH)
#: Also a difference, ``+3.8``, and what is too small to be told, ``< 0.001``.
_NUMBER = re.compile(r"(?:< )?([+-]?\d+(?:\.\d+)?)(?: ± .*| \(.*)?$")


@dataclass(frozen=True)
class Table:
    """A table that its reader can sort by any column.

    Parameters
    ----------
    columns : sequence of str
        Their headings.
    rows : sequence of sequence of (str, int, float or None)
        A cell a column; None is a dash. The first column names the row.
    title : str
        What it shows, above it.
    note : str
        What must be known to read it, below it.
    digits : int
        After the point of floats.
    foot : sequence of (str, int, float or None)
        A last row that is not sorted with the others, such as a mean.
    folded : bool
        Whether it is shown only to who asks for it; it needs a title.
    """

    template: ClassVar[str] = "table.html.j2"

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    title: str = ""
    note: str = ""
    digits: int = 1
    foot: Sequence[Cell] = ()
    folded: bool = False

    def text(self, cell: Cell) -> str:
        """Return what a cell shows."""
        if cell is None or cell != cell:
            return DASH
        return f"{cell:.{self.digits}f}" if isinstance(cell, float) else str(cell)

    def key(self, cell: Cell) -> str | None:
        """Return the number that a cell is sorted by, where that is not what it shows."""
        if isinstance(cell, str):
            found = _NUMBER.match(cell)
            return found[1] if found and found[1] != cell else None
        return f"{cell:.9g}" if isinstance(cell, float) and cell == cell else None

    def is_number(self, cell: Cell) -> bool:
        """Tell whether a cell is aligned and sorted as numbers are: ``95.1 ± 2.3`` is too."""
        if isinstance(cell, str):
            return cell in _NOTHING or _NUMBER.match(cell) is not None
        return True


@dataclass(frozen=True)
class Facts:
    """Names with what they are.

    Parameters
    ----------
    rows : sequence of (str, str)
        Those without a value are left out.
    """

    template: ClassVar[str] = "facts.html.j2"

    rows: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Notes:
    """A list of sentences.

    Parameters
    ----------
    lines : sequence of str
        One an item.
    """

    template: ClassVar[str] = "notes.html.j2"

    lines: Sequence[str]
