"""From what an experiment's config asks for to files.

A config lists figures and tables as mappings::

    figures:
      - {name: Figure 7, kind: bars, title: Single cues, methods: [crfh oaa, laser oaa]}
      - {name: Figure 11, kind: ranks, experiments: [Exp 1, Exp 2]}

Every kind takes ``name``, ``kind``, ``title``, ``methods`` and ``experiments`` (all by default) and
``names`` (what methods are called in the figure); what it takes besides is told where it is drawn.
Figures and tables differ only in that tables have no picture.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from placecue.errors import DataError, PlacecueError, UsageError, choices
from placecue.evaluation.figures import (
    bars,
    classes,
    confusion,
    errors,
    intervals,
    ranks,
    significance,
    summary,
    used,
)
from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.spec import COMMON, Spec, checked, read
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results


class Kind(NamedTuple):
    """A kind of figure or table: what makes it, and what it takes besides the common keys."""

    draw: Callable[[Results, Spec, About], Drawn]
    keys: frozenset[str]


KINDS: dict[str, Kind] = {
    "bars": Kind(bars.draw, bars.KEYS),
    "ranks": Kind(ranks.draw, ranks.KEYS),
    "errors": Kind(errors.draw, errors.KEYS),
    "classes": Kind(classes.draw, classes.KEYS),
    "confusion": Kind(confusion.draw, confusion.KEYS),
    "used": Kind(used.draw, used.KEYS),
    "summary": Kind(summary.draw, summary.KEYS),
    "significance": Kind(significance.draw, significance.KEYS),
    "intervals": Kind(intervals.draw, intervals.KEYS),
}


@dataclass(frozen=True)
class Made:
    """A figure or table, and where it stands.

    Parameters
    ----------
    spec : Spec
        What was drawn.
    drawn : Drawn
        The picture and its numbers.
    files : sequence of Path
        PNG, PDF, CSV, LaTeX, Markdown, as far as there are.
    """

    spec: Spec
    drawn: Drawn
    files: Sequence[Path]

    @property
    def svg(self) -> str | None:
        """The picture as an ``<svg>`` element for a page, None of a table."""
        return self.drawn.svg(stem(self.spec.name))


def check(specs: Sequence[Mapping[str, Any]], about: About) -> None:
    """Refuse what cannot be drawn, before anything is computed.

    Raises
    ------
    UsageError
        If a name is missing or met twice, or a kind, key, method or experiment is unknown.
    """
    names: set[str] = set()
    for number, told in enumerate(specs, start=1):
        if not isinstance(told, Mapping) or not isinstance(told.get("name"), str):
            raise UsageError(f"figure {number} has no name: give each of figures and tables one")
        if stem(told["name"]) in names:
            raise UsageError(f"two figures or tables are called '{told['name']}': rename one")
        names.add(stem(told["name"]))
        kind = str(told.get("kind"))
        if kind not in KINDS:
            raise UsageError(f"'{told['name']}' is of no kind '{kind}'; {choices(kind, KINDS)}")
        checked(told, COMMON | KINDS[kind].keys, about)


def drawn(told: Mapping[str, Any], results: Results, about: About) -> tuple[Spec, Drawn]:
    """Return what is asked for, not in files.

    Raises
    ------
    UsageError
        As :func:`check` does.
    DataError
        If there is no result to draw.
    """
    check([told], about)
    spec = read(told, results, about)
    if not spec.methods or not spec.experiments:
        raise DataError("there is no result of what it shows")
    from matplotlib import rc_context

    with rc_context({"text.parse_math": False}):  # names are no formulas
        return spec, KINDS[spec.kind].draw(results, spec, about)


def make(told: Mapping[str, Any], results: Results, about: About, folder: Path) -> Made:
    """Draw what is asked for into a folder.

    Raises
    ------
    UsageError, DataError
        As :func:`drawn` does, or if a file cannot be written.
    """
    spec, picture = drawn(told, results, about)
    return Made(spec, picture, picture.save(folder, stem(spec.name)))


def make_all(
    specs: Sequence[Mapping[str, Any]], results: Results, about: About, folder: Path
) -> tuple[list[Made], list[str]]:
    """Draw all that can be drawn into a folder.

    Returns
    -------
    list of Made
        What was drawn.
    list of str
        Warnings: what was left out of it, and what could not be drawn, and why.

    Raises
    ------
    UsageError
        As :func:`check` does; nothing is drawn then.
    """
    check(specs, about)
    found, warnings = [], []
    for told in specs:
        try:
            found.append(make(told, results, about, folder))
        except PlacecueError as error:
            warnings.append(f"{told['name']} is not drawn: {error}")
        else:
            warnings += found[-1].spec.warnings
    return found, warnings


def stem(name: str) -> str:
    """Return the name of a figure's files, without suffix: ``figure-7``."""
    return re.sub(r"[\W_]+", "-", name.lower()).strip("-") or "figure"
