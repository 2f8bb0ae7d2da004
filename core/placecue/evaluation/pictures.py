"""Writing a figure into a picture file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from placecue.atomic import replacing
from placecue.errors import UsageError, choices

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")


def save_picture(figure: Figure, path: str | Path) -> Path:
    """Write a figure into a file, which appears whole or not at all.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Made without pyplot, so that no window system or global state comes into it.
    path : str or Path
        File to write, ``.png``, ``.svg`` or ``.pdf``.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    UsageError
        If the suffix is not that of a picture.
    DataError
        If the file cannot be written.
    """
    path = Path(path)
    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise UsageError(f"{path} is no picture file: {choices(kind, FORMATS)}")
    with replacing(path) as temporary:
        figure.savefig(temporary, format=kind)
    return path
