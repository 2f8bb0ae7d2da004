"""``placecue report``: a run folder, or several -> tables, figures and the page, made again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from placecue.commands import files, reporting, tables
from placecue.commands.paths import path_of
from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.errors import UsageError
from placecue.evaluation.results import about as abouts
from placecue.evaluation.results.about import About
from placecue.evaluation.results.areas import FILE as AREAS
from placecue.evaluation.results.areas import AreaStore, areas_table, write_areas
from placecue.evaluation.results.kept import kept, merged
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.tables import FILE, summary_table
from placecue.evaluation.writing import FIGURES, report_page, write_tables_and_figures
from placecue.observation import Observation
from placecue.source import Source, guarded

WRITES = files.EVALUATED
#: A folder that holds this is reported on; others are merged into a new one.
RESUMES = abouts.FILE


def run(config: dict[str, Any]) -> None:
    """Make everything again that follows from results."""
    out = path_of(config, "out")
    folders = config["merge"]
    if folders:
        if not isinstance(folders, list):
            raise UsageError(f"merge must list run folders, merge=[A,B], got {folders!r}")
        about, results = merged([Path(str(folder)) for folder in folders])
        about.save(out)
        results.save(out)
        AreaStore(out).take_over([Path(str(folder)) for folder in folders])
    else:
        about, results = kept(out)
    tables.written(write(config, out, about, results))
    current_plugins().tell("run_finished", command="report", out=out)


def write(
    config: Mapping[str, Any], out: Path, about: About, results: Results
) -> list[tuple[str, Path]]:
    """Print the summary; write tables, figures and the page of results, and return where."""
    # Of methods only: what accumulators made of one may have failed, too.
    there = set(results.methods)
    shown = summary_table(results, [m for m in about.methods if m in there], results.experiments)
    tables.table(shown.columns, [[shown.shown(cell) for cell in row] for row in shown.rows])
    areas = AreaStore(out).of(about.areas)
    if areas:
        write_areas(areas, out)
        told = areas_table(areas)
        tables.table(told.columns, [[told.shown(cell) for cell in row] for row in told.rows])
    made, warnings = write_tables_and_figures(out, about, results)
    for line in warnings:
        print(f"note: {line}")
    about = replace(about, warnings=[*about.warnings, *warnings])
    reopen = partial(open_recording, about)
    reporting.write(config, out, lambda: report_page(about, results, made, reopen, areas))
    return [
        ("results", out / FILE),
        *([("areas", out / AREAS)] if areas else []),
        ("figures", out / FIGURES),
        *reporting.written(config, out),
    ]


def open_recording(about: About, name: str) -> Iterable[Observation]:
    """Return the images and scans of a recording by its name."""
    spec: Mapping[str, Any] = about.recordings[name].source
    seen: Sequence[str] = ("image", "scan")
    spec = {**spec, "parts": list(seen)} if "parts" in spec else dict(spec)
    source: Source = guarded(build(spec, "source", current_plugins().registry))
    return source
