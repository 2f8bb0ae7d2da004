"""Tables and lists of files, as commands print them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table


def console() -> Console:
    """Return the console that results go to."""
    plain = Console()
    return plain if plain.is_terminal else Console(width=140)


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], title: str = "") -> None:
    """Print a table; all columns but the first are aligned right."""
    shown = Table(title=title or None, title_justify="left", box=None, pad_edge=False)
    for number, heading in enumerate(headings):
        shown.add_column(heading, justify="left" if number == 0 else "right", no_wrap=number == 0)
    for row in rows:
        shown.add_row(*row)
    console().print(shown)


def written(paths: Iterable[tuple[str, Path]]) -> None:
    """Print what was written where."""
    rows = list(paths)
    width = max(len(what) for what, _ in rows)
    for what, path in rows:
        print(f"{what:<{width}}  {path}")
