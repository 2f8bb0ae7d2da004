"""``placecue suggest``: model or starter, and log -> the moments that are most worth labelling."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from placecue import progress
from placecue.atomic import made, write_text
from placecue.checks import check_whole
from placecue.commands import files, reporting, tables
from placecue.commands.features import extraction_of
from placecue.commands.models import model_and_log
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.errors import DataError
from placecue.evaluation.report.moments import Moment, Moments
from placecue.evaluation.report.page import Page, Section
from placecue.evaluation.report.views import view
from placecue.logs.joining.labels import COLUMNS, SUGGESTED
from placecue.pipeline import Pipeline
from placecue.source import Source
from placecue.starter.rule import OBJECTS
from placecue.suggesting import choose, looked_at

WRITES = files.SUGGESTED
#: How long before and after a moment its label holds, ns; shorter where another one is near.
AROUND = 100_000_000


def run(config: dict[str, Any]) -> None:
    """Write which moments of a log to label, as a table to fill in and as a page of pictures."""
    out, plugins = path_of(config, "out"), current_plugins()
    check_whole("moments", config["moments"], least=1)
    reporting.is_wanted(config)
    pipeline, log = model_and_log(config, plugins, ())
    with extraction_of(config, plugins) as pipeline.extraction, progress.shown():
        moments = suggested(pipeline, log, config["moments"])
    made(out)
    table = write_text(out / files.SUGGESTIONS, as_csv(moments))
    facts = reporting.facts(config, log.name)
    reporting.write(config, out, lambda: _page(log.name, facts, moments))
    print(f"{len(moments)} moments of {log.name} to label: fill in the column label")
    tables.written([("to fill in", table), *reporting.written(config, out)])
    print(f"next: {_next(config['model'], pipeline, table)}")
    plugins.tell("run_finished", command="suggest", out=out)


def _next(model: Any, pipeline: Pipeline, table: Path) -> str:
    """Return what makes use of the labels: the model goes on learning, or a first one is made."""
    if model is not None:
        return f"placecue teach model={model} log=FILE labels={table}"
    cue = "lite0" if OBJECTS in pipeline.cues else "laser"
    return (
        f"placecue train log=FILE source.labels={table} cue={cue} integrator=none "
        f"classifier@cues.{cue}.classifier=nearest_mean out=model"
    )


def suggested(pipeline: Pipeline, log: Source, count: int) -> list[Moment]:
    """Return the moments of a log that are most worth labelling, in order of time."""
    beliefs, described, names = [], [], []
    for observation, belief, seen in looked_at(pipeline, progress.track(log, "looking")):
        beliefs.append(belief)
        names.append(observation.log_name)
        described.append(seen)
    if not beliefs:
        raise DataError(f"no observation of {log.name} is usable")
    width = max(map(len, described))
    looks = np.zeros((len(described), width))
    for row, each in enumerate(described):  # of one that lacks a cue there is nothing to compare
        looks[row] = each if len(each) == width else 0
    confidence = np.array([belief.confidence for belief in beliefs])
    # By log as well: two may have been recorded at the same time.
    chosen = {
        (beliefs[row].stamp, names[row]): beliefs[row] for row in choose(confidence, looks, count)
    }
    # Read again, so that no picture of the others is kept.
    views = {key: view(each) for each in log if (key := (each.stamp, each.log_name)) in chosen}
    return [
        Moment(number, key[1], key[0], chosen[key].label, chosen[key].confidence, *views[key])
        for number, key in enumerate(sorted(chosen), 1)
    ]


def as_csv(moments: Sequence[Moment]) -> str:
    """Return a table of labels by time whose labels are to be filled in."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*COLUMNS, SUGGESTED, "confidence", "number", "log"])
    stamps = [each.stamp for each in moments]
    for row, each in enumerate(moments):
        beside = stamps[max(row - 1, 0) : row] + stamps[row + 1 : row + 2]
        near = [abs(each.stamp - other) // 2 for other in beside]
        around = min([AROUND, *near])
        start, end = each.stamp - around, max(each.stamp + around, each.stamp + 1)
        confidence = f"{each.confidence:.4g}"
        writer.writerow(
            [_seconds(start), _seconds(end), "", each.suggested, confidence, each.number, each.log]
        )
    return text.getvalue()


def _seconds(stamp: int) -> str:
    sign, stamp = ("-", -stamp) if stamp < 0 else ("", stamp)
    return f"{sign}{stamp // 10**9}.{stamp % 10**9:09d}"


def _page(name: str, facts: Any, moments: Sequence[Moment]) -> Page:
    note = (
        f"Write what each is into the column label of {files.SUGGESTIONS}; lines may be left "
        "empty. Moments are chosen where the model is unsure, unlike each other."
    )
    sections = [Section("Moments to label", [Moments(moments)], note), Section("Run", [facts])]
    return Page(f"What to label in {name}", sections)
