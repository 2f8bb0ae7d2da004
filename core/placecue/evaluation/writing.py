"""Everything that is made of results without computing any: tables, figures, the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from placecue.errors import UsageError
from placecue.evaluation.figures.make import Made, check, make_all
from placecue.evaluation.report.evaluation import evaluation_page
from placecue.evaluation.report.page import Page
from placecue.evaluation.report.table import Table
from placecue.evaluation.report.views import OpenRecording
from placecue.evaluation.results.about import About
from placecue.evaluation.results.areas import AreaResult, areas_table
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.tables import write_results

FIGURES = "figures"
AREAS = (
    "Shares of single beliefs, of the way, of nodes, areas and free space that are labelled "
    "rightly, and the time until the label of the place is; means over pairs"
)
SIGNIFICANCE = "significance"
#: What is drawn where an experiment asks for nothing.
USUAL: Sequence[dict[str, Any]] = (
    {"name": "Scores", "kind": "bars", "title": "Balanced accuracy (%), mean over pairs"},
    {"name": "Summary", "kind": "summary", "title": "Balanced accuracy (%)"},
    {"name": "Recalls", "kind": "classes", "title": "Share of each class recognised (%)"},
    {"name": "Confusion", "kind": "confusion", "title": "What each class was taken for"},
    {"name": "Significance", "kind": "significance", "title": "Joined cues against their parts"},
)


#: And where there are so many methods and pairs that ranks say something.
RANKS = {"name": "Ranks", "kind": "ranks", "title": "Mean ranks over pairs, 1 is the best"}
METHODS, PAIRS = 3, 4


def asked_for(about: About) -> list[dict[str, Any]]:
    """Return what is to be drawn, as mappings of a config."""
    asked = [dict(each) for each in (*about.figures, *about.tables)]
    ranked = len(about.methods) >= METHODS and sum(about.experiments.values()) >= PAIRS
    return asked or [dict(each) for each in (*USUAL, *([RANKS] if ranked else []))]


def check_figures(about: About) -> None:
    """Raise UsageError where a figure or table cannot be drawn, before anything is computed."""
    check(asked_for(about), about)
    for method, of in about.paper.items():
        numbers = of.values() if isinstance(of, Mapping) else [of]
        if not isinstance(of, Mapping) or not all(isinstance(n, (int, float)) for n in numbers):
            raise UsageError(
                f"paper.{method} must give percent by experiment, {{{method}: {{Exp 1: 95.1}}}}, "
                f"got {of!r}"
            )


def write_tables_and_figures(
    folder: Path, about: About, results: Results
) -> tuple[list[Made], list[str]]:
    """Write ``results.csv`` and the figures and tables of an experiment.

    Returns
    -------
    list of Made
        The figures and tables, and where they are.
    list of str
        What could not be drawn, and why.
    """
    write_results(results, folder)
    return make_all(asked_for(about), results, about, folder / FIGURES)


def report_page(
    about: About,
    results: Results,
    made: Sequence[Made],
    open_recording: OpenRecording | None = None,
    areas: Sequence[AreaResult] = (),
) -> Page:
    """Return the page of an evaluation; see :func:`evaluation_page`."""
    figures = {each.spec.name: (svg, _caption(each)) for each in made if (svg := each.svg)}
    told = [each for each in made if each.svg is None]
    summary = [_on_page(each) for each in told if _kind(each) != SIGNIFICANCE]
    if areas:
        table = areas_table(areas)
        summary.append(Table(table.columns, table.rows, title="Areas", note=AREAS, digits=1))
    tests = [each for each in told if _kind(each) == SIGNIFICANCE and each.drawn.table.rows]
    significance = [_on_page(each) for each in tests]
    return evaluation_page(about, results, figures, summary, significance, open_recording)


def _kind(made: Made) -> str:
    return made.spec.kind


def _caption(made: Made) -> str:
    return ". ".join(filter(None, [made.spec.title, *made.drawn.notes]))


def _on_page(made: Made) -> Table:
    table = made.drawn.table
    title = f"{made.spec.name}: {made.spec.title}" if made.spec.title else made.spec.name
    note = ". ".join(made.drawn.notes)
    return Table(table.columns, table.rows, title=title, note=note, digits=table.digits)
