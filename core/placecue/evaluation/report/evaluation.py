"""The page of an evaluation: what was run, what came out, and where it went wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from placecue.evaluation.report import confusion
from placecue.evaluation.report.figure import Figure
from placecue.evaluation.report.mistakes import Mistakes, find_mistakes, recording_of
from placecue.evaluation.report.page import Page, Section
from placecue.evaluation.report.table import Cell, Facts, Notes, Table
from placecue.evaluation.report.views import OpenRecording, with_views
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results

#: Bytes that the mistakes may take, and that the page as a whole should.
MISTAKES, PAGE = 4_000_000, 9_000_000
#: About what a cell of a confusion matrix, and the rest of the page, take, bytes.
CELL, REST = 75, 500_000


def write_evaluation_report(
    folder: Path,
    about: About,
    results: Results,
    figures: Mapping[str, tuple[str, str]],
    summary: Sequence[Table],
    significance: Sequence[Table],
    open_recording: OpenRecording | None = None,
) -> Path:
    """Write ``report.html`` of an evaluation into a folder.

    Parameters
    ----------
    folder : Path
        That of the run.
    about : About
        What was evaluated.
    results : Results
        What came out, failed pairs included.
    figures : mapping of str to (str, str)
        SVG document and caption, by the name of the figure.
    summary : sequence of Table
        Methods by experiment, a paper's numbers beside them.
    significance : sequence of Table
        Tests between methods.
    open_recording : callable, optional
        Takes the name of a recording in ``about.recordings`` and gives its observations; without
        it mistakes have no pictures.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    DataError
        If a figure is no SVG, or the file cannot be written.
    """
    return evaluation_page(about, results, figures, summary, significance, open_recording).write(
        folder
    )


def evaluation_page(
    about: About,
    results: Results,
    figures: Mapping[str, tuple[str, str]],
    summary: Sequence[Table],
    significance: Sequence[Table],
    open_recording: OpenRecording | None = None,
) -> Page:
    """Return the page; see :func:`write_evaluation_report`."""
    drawn = [Figure(name, svg, caption) for name, (svg, caption) in figures.items()]
    matrices = confusion.of_results(results)
    cells = sum(each.counts.size for each in matrices.matrices)
    rest = sum(len(each.svg) for each in drawn) + CELL * cells + REST
    mistakes = _mistakes(about, results, open_recording, min(MISTAKES, max(0, PAGE - rest)))
    sections = [
        Section("What was run", [_facts(about, results), *_warnings(about)]),
        Section("Summary", summary),
        Section("Figures", drawn),
        Section("Significance", significance),
        Section("Confusion", [matrices] if matrices.matrices else []),
        Section("Mistakes", [mistakes] if mistakes.total else []),
        Section("What failed", _failed(results)),
        Section("Recordings", _recordings(about)),
        Section("Methods", _methods(about)),
        Section("Time", _time(about, results)),
    ]
    return Page(about.title or "Evaluation", sections, _lead(about, results))


def _lead(about: About, results: Results) -> str:
    pairs = len({each.pair for each in results})
    failed = f", {len(results.failed)} of {len(results)} failed" if results.failed else ""
    return (
        f"{len(results.methods)} methods on {pairs} pairs of {len(about.recordings)} recordings"
        f"{failed}."
    )


def _facts(about: About, results: Results) -> Facts:
    experiments = ", ".join(f"{name} ({count} pairs)" for name, count in about.experiments.items())
    versions = ", ".join(f"{name} {version}" for name, version in about.versions.items())
    worlds = ", ".join(name for name in results.worlds if name)
    return Facts([
        ("Command", about.command),
        ("Began", about.began),
        ("Experiments", experiments),
        ("Worlds", worlds),
        ("Versions", versions),
    ])  # fmt: skip


def _warnings(about: About) -> list[Notes]:
    return [Notes(about.warnings)] if about.warnings else []


def _recordings(about: About) -> list[Table]:
    recordings = about.recordings
    if not recordings:
        return []
    keys = list(dict.fromkeys(key for each in recordings.values() for key in each.metadata))
    classes = sorted({name for each in recordings.values() for name in each.classes})
    rows = [
        [
            name,
            *(each.metadata.get(key) for key in keys),
            *(each.classes.get(of) for of in classes),
            sum(each.classes.values()),
            each.log,
            each.digest[:12],
        ]
        for name, each in recordings.items()
    ]
    headings = ["recording", *keys, *classes, "samples", "log", "digest"]
    return [Table(headings, rows, note="Labelled samples of each class.")]


def _methods(about: About) -> list[Table]:
    rows = [
        [name, ", ".join(each.cues), each.integrator or None, each.words]
        for name, each in about.methods.items()
    ]
    return [Table(["method", "cues", "integrator", "chosen by"], rows)] if rows else []


def _mistakes(
    about: About, results: Results, open_recording: OpenRecording | None, budget: int
) -> Mistakes:
    found = find_mistakes(results, about.methods)
    if open_recording is None:
        note = "No pictures and scans: the recordings were not at hand when this page was made."
        return replace(found, notes=[note]).within(budget)
    named = {str(each.pair): recording_of(each.pair, about) for each in results}
    return with_views(found, open_recording, named).within(budget)


def _failed(results: Results) -> list[Table]:
    rows = [
        [each.method, each.pair.experiment, str(each.pair), each.error] for each in results.failed
    ]
    return [Table(["method", "experiment", "pair", "why"], rows)] if rows else []


def _time(about: About, results: Results) -> list[Table]:
    spent: dict[str, Counter[str]] = {}
    for each in results.of():
        spent.setdefault(each.method, Counter()).update(each.seconds)
    steps = list(dict.fromkeys(step for each in spent.values() for step in each))
    tables = []
    if about.seconds:
        rows: list[list[Cell]] = [[step, float(taken)] for step, taken in about.seconds.items()]
        tables.append(Table(["step", "seconds"], rows, "By step"))
    if steps:
        rows = [
            [method, *(each.get(step) for step in steps), float(sum(each.values()))]
            for method, each in spent.items()
            if each
        ]
        tables.append(Table(["method", *steps, "all"], rows, "By method, s"))
    return tables
