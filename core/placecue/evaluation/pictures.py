"""Writing a figure into a picture file."""

from __future__ import annotations

import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from placecue.atomic import replacing
from placecue.errors import UsageError, choices

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
log = logging.getLogger(__name__)
#: How matplotlib says that a font lacks a character, which it draws as a box.
MISSING = re.compile(r"Glyph (\d+) .*missing from (?:current )?font")


@contextmanager
def boxes_for_unknown() -> Iterator[None]:
    """Say in one line, once, which characters a figure that is drawn meanwhile cannot show."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    lacking = [(each, MISSING.match(str(each.message))) for each in caught]
    _say_lacking("".join(sorted({chr(int(found[1])) for _, found in lacking if found})))
    for each, found in lacking:
        if found is None:
            warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)


@cache
def _say_lacking(characters: str) -> None:
    if characters:
        log.warning(f"the font of figures lacks {characters}: PNG and PDF show boxes for them")


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
    with replacing(path) as temporary, boxes_for_unknown():
        figure.savefig(temporary, format=kind)
    return path
