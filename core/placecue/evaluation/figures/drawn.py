"""A figure with its numbers, not yet in files."""

from __future__ import annotations

from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

from placecue.atomic import write_text
from placecue.evaluation.pictures import boxes_for_unknown, save_picture
from placecue.evaluation.results.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: What a figure is written as.
PICTURES = ("png", "pdf")


@dataclass(frozen=True)
class Drawn:
    """A picture and what it shows.

    Parameters
    ----------
    numbers : Table
        Every number that is shown, for machines.
    table : Table
        The same for people.
    figure : matplotlib.figure.Figure, optional
        None where there is only the table.
    notes : tuple of str
        What is to be known of it: a test's result, what was left out.
    """

    numbers: Table
    table: Table
    figure: Figure | None = None
    notes: tuple[str, ...] = ()

    def svg(self, salt: str = "") -> str | None:
        """Return the picture as an ``<svg>`` element to stand in a page, with text as text.

        Parameters
        ----------
        salt : str
            What its ids are made of: the same for the same picture, another for each in a page.
        """
        if self.figure is None:
            return None
        from matplotlib import rc_context

        text = StringIO()
        options = rc_context({"svg.hashsalt": salt, "svg.fonttype": "none"})
        with options, boxes_for_unknown():
            self.figure.savefig(text, format="svg", metadata={"Date": None})
        return text.getvalue()[text.getvalue().index("<svg") :]

    def save(self, folder: Path, stem: str) -> list[Path]:
        """Write PNG, PDF, CSV, LaTeX and Markdown into a folder, and return the files.

        Raises
        ------
        DataError
            If a file cannot be written.
        """
        written: list[Path] = []
        if self.figure is not None:
            written += [save_picture(self.figure, folder / f"{stem}.{end}") for end in PICTURES]
        written.append(write_text(folder / f"{stem}.csv", self.numbers.csv()))
        written.append(write_text(folder / f"{stem}.tex", self.table.latex()))
        written.append(write_text(folder / f"{stem}.md", self.table.markdown()))
        return written
