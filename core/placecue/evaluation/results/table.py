"""A table as CSV, Markdown and LaTeX."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import StringIO

Cell = str | int | float | None
#: What a reader sees where there is no number.
NOTHING = "–"
_LATEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
    "<": r"$<$", ">": r"$>$", "|": r"\textbar{}", "±": r"$\pm$", "→": r"$\to$",
    "χ": r"$\chi$", "²": r"$^2$", "°": r"$^\circ$", "≥": r"$\geq$", "≤": r"$\leq$", "–": "--",
    "×": r"$\times$",
}  # fmt: skip


@dataclass(frozen=True)
class Table:
    """Rows of text and numbers under names.

    Parameters
    ----------
    columns : sequence of str
        Names of the columns.
    rows : sequence of sequence of str, int, float or None
        A cell for each column; None and NaN are nothing.
    digits : int
        Of floats, after the point, for people; CSV has six significant ones.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    digits: int = 1

    def csv(self) -> str:
        """Return it as CSV; nothing is an empty cell."""
        text = StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([_precise(cell) for cell in row] for row in self.rows)
        return text.getvalue()

    def markdown(self) -> str:
        """Return it as a table of Markdown."""
        rule = ["---:" if right else "---" for right in self._right()]
        body = [[self.shown(cell) for cell in row] for row in self.rows]
        lines = [_escaped(list(self.columns), _markdown), rule]
        lines += [_escaped(row, _markdown) for row in body]
        return "".join(f"| {' | '.join(line)} |\n" for line in lines)

    def latex(self) -> str:
        """Return it as a plain ``tabular`` of LaTeX, without packages."""
        places = "".join("r" if right else "l" for right in self._right())
        lines = [f"\\begin{{tabular}}{{{places}}}", r"\hline"]
        lines += [f"{' & '.join(_escaped(list(self.columns), latex_escaped))} \\\\", r"\hline"]
        for row in self.rows:
            shown = _escaped([self.shown(cell) for cell in row], latex_escaped)
            lines.append(f"{' & '.join(shown)} \\\\")
        return "\n".join([*lines, r"\hline", r"\end{tabular}", ""])

    def shown(self, cell: Cell) -> str:
        """Return a cell as people read it."""
        if cell is None or (isinstance(cell, float) and math.isnan(cell)):
            return NOTHING
        return f"{cell:.{self.digits}f}" if isinstance(cell, float) else str(cell)

    def _right(self) -> list[bool]:
        """Say for each column whether it holds numbers, which stand to the right."""
        columns = zip(*self.rows, strict=True) if self.rows else ((),) * len(self.columns)
        return [any(map(_numeric, column)) for column in columns]


def latex_escaped(text: str) -> str:
    """Return text such that LaTeX prints it as it is, also as the first cell of a row."""
    # After the end of a row LaTeX would read these as an option of it.
    guard = "{}" if text.startswith(("[", "*")) else ""
    return guard + "".join(_LATEX.get(letter, letter) for letter in text)


def _escaped(cells: list[str], escape: Callable[[str], str]) -> list[str]:
    return [escape(cell) for cell in cells]


def _markdown(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _numeric(cell: Cell) -> bool:
    return isinstance(cell, (int, float)) or (isinstance(cell, str) and "±" in cell)


def _precise(cell: Cell) -> str:
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)
