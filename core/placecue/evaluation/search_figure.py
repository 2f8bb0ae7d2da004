"""The results of a parameter search: as a table, and as a heat map over C and gamma."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError
from placecue.evaluation.pictures import save_picture
from placecue.ownership import provenance

SCORE = "balanced_accuracy"
FRAME = "#D55E00"
#: With more columns than this they are narrower, and their values slanted.
MANY_COLUMNS = 12
Results = Mapping[str, Sequence[Any]]


def search_rows(results: Results) -> list[list[str]]:
    """Return the points of a search, best first: one text a parameter, and the score in %.

    Parameters
    ----------
    results : mapping of str to sequence
        ``search_`` of a classifier: parameters and ``balanced_accuracy``, one entry a point.
    """
    names = [name for name in results if name != SCORE]
    order = np.argsort(-np.asarray(results[SCORE]), kind="stable")
    return [
        [*(as_text(results[name][row]) for name in names), f"{100 * results[SCORE][row]:.1f}"]
        for row in order
    ]


def search_table(results: Results) -> str:
    """Return the points of a search as a Markdown table, best first."""
    names = [name for name in results if name != SCORE]
    head = [*names, "balanced accuracy (%)"]
    lines = [head, ["---"] * len(head), *search_rows(results)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def draw_search(
    results: Results,
    path: str | Path,
    *,
    across: str = "gamma",
    up: str = "C",
    title: str | None = None,
) -> Path:
    """Draw the balanced accuracy over two parameters; the best over all others.

    The point that the classifier took is framed.

    Parameters
    ----------
    results : mapping of str to sequence
        ``search_`` of a classifier.
    path : str or Path
        Picture file to write; see :func:`placecue.evaluation.pictures.save_picture`.
    across, up : str
        The parameters along the axes. One that was not searched takes a single row or column.
    title : str, optional
        Heading of the picture.

    Raises
    ------
    UsageError
        If neither parameter was searched, or the file is no picture.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

    if across not in results and up not in results:
        searched = ", ".join(name for name in results if name != SCORE)
        raise UsageError(f"neither {across} nor {up} was searched; searched: {searched}")
    columns, rows = _values(results, across), _values(results, up)
    best = _best(results, (rows, up), (columns, across))
    many = len(columns) > MANY_COLUMNS
    width = max(4.5, (0.5 if many else 0.75) * len(columns) + 2)
    figure = Figure((width, max(3.2, 0.5 * len(rows) + 1.6)), dpi=100, layout="constrained")
    axes = figure.add_subplot()
    image = axes.imshow(100 * best, origin="lower", aspect="auto", cmap="viridis")
    # A parameter that was not searched has a single row or column, and no axis.
    shown = [as_text(value) for value in columns if across in results]
    axes.set_xticks(range(len(shown)), shown, rotation=45 if many else 0)
    axes.set_xlabel(across if shown else "")
    shown = [as_text(value) for value in rows if up in results]
    axes.set_yticks(range(len(shown)), shown)
    axes.set_ylabel(up if shown else "")
    middle = 50 * (np.nanmin(best) + np.nanmax(best))
    for (row, column), share in np.ndenumerate(best):
        colour = "white" if 100 * share < middle else "black"
        said = axes.text(column, row, f"{100 * share:.1f}", ha="center", va="center", color=colour)
        said.set_fontsize(8 if many else 9)
    # The same point as the classifier's: the first of equals.
    first = int(np.argmax(results[SCORE]))
    column, row = (
        values.index(results[name][first]) if name in results else 0
        for values, name in ((columns, across), (rows, up))
    )
    axes.add_patch(Rectangle((column - 0.46, row - 0.46), 0.92, 0.92, fill=False, ec=FRAME, lw=2.5))
    figure.colorbar(image, fraction=0.5 / width, pad=0.1 / width)
    others = [name for name in results if name not in (SCORE, across, up)]
    what = "balanced accuracy in cross-validation (%)"
    heading = [f"{title}: {what}" if title else what]
    heading += [f"best over {', '.join(others)}"] if others else []
    axes.set_title("\n".join(heading), fontsize=10)
    return save_picture(figure, path)


def _values(results: Results, name: str) -> list[Any]:
    """Return the values of a parameter that were tried: numbers in order, others as listed."""
    values = list(dict.fromkeys(results.get(name, [None])))
    numbers = all(isinstance(value, (int, float)) for value in values)
    return sorted(values) if numbers else values


def _best(results: Results, *axes: tuple[list[Any], str]) -> NDArray[np.float64]:
    best = np.full(tuple(len(values) for values, _ in axes), np.nan)
    for point, share in enumerate(results[SCORE]):
        at = tuple(
            values.index(results[name][point]) if name in results else 0 for values, name in axes
        )
        best[at] = np.fmax(best[at], share)
    return best


def as_text(value: Any) -> str:
    """Return the value of a parameter as a table shows it; a dash for null."""
    if value is None:
        return "-"
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if hasattr(value, "get_params"):  # a component goes by its name
        return provenance(value).name.strip("'")
    return f"{value:g}" if number else str(value)
