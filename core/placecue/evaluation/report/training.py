"""The page of a training: what was trained, and what was found on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from placecue.evaluation.report.figure import Figure
from placecue.evaluation.report.page import Page, Part, Section
from placecue.evaluation.report.table import Cell, Facts, Table
from placecue.evaluation.search_figure import SCORE, search_rows
from placecue.evaluation.training_report import (
    RELIABILITY,
    SEARCHES,
    TRADE_OFF,
    held_out_reliability,
    searches,
)
from placecue.guard import call
from placecue.pipeline import Pipeline


def training_page(
    pipeline: Pipeline, folder: Path, about: Mapping[str, Any], command: str = ""
) -> Page:
    """Return the page of a pipeline fresh from training.

    Parameters
    ----------
    pipeline : Pipeline
        As trained.
    folder : Path
        Its model folder, with what :func:`write_training_report` has drawn.
    about : mapping
        The manifest of the model.
    command : str
        The command line.
    """
    sections = [
        Section("What was trained", [_facts(pipeline, about, command)]),
        Section("Logs", [_logs(about["logs"])] if about["logs"] else []),
        Section("Cues and classifiers", [_models(about["pipeline"])]),
        Section("Parameter searches", _searches(pipeline, folder)),
        Section("Reliability", _reliability(pipeline, folder)),
        Section("Accuracy over cost", _trade_off(pipeline, folder)),
    ]
    lead = f"A model of {len(pipeline.classes)} classes from {' + '.join(pipeline.cues)}."
    return Page(f"Training of {folder.resolve().name}", sections, lead)


def _facts(pipeline: Pipeline, about: Mapping[str, Any], command: str) -> Facts:
    rejection = pipeline.rejection_
    unknown = f"below a confidence of {rejection.threshold:.3g}" if rejection is not None else ""
    return Facts([
        ("Command", command),
        ("Made", str(about["created"])),
        ("Classes", ", ".join(pipeline.classes)),
        ("Integrator", call(pipeline.integrator, "summary")),
        ("Unknown", unknown),
        ("Versions", ", ".join(f"{name} {each}" for name, each in about["versions"].items())),
    ])  # fmt: skip


def _logs(logs: Sequence[Mapping[str, Any]]) -> Table:
    keys = list(dict.fromkeys(key for log in logs for key in log["metadata"]))
    rows = [
        [log["name"], *(_text(log["metadata"].get(key)) for key in keys), log["digest"][:12]]
        for log in logs
    ]
    return Table(["log", *keys, "digest"], rows)


def _models(composition: Mapping[str, Any]) -> Table:
    rows = [
        [name, _words({k: v for k, v in spec.items() if k != "classifier"}),
         _words(spec.get("classifier"))]
        for name, spec in composition["cues"].items()
    ]  # fmt: skip
    integrator = composition.get("integrator")
    if integrator:
        rows.append(["integrator", _words(integrator), None])
    return Table(["model", "component and its parameters", "classifier and its parameters"], rows)


def _words(spec: Any) -> str:
    """Return a component and its parameters as a config names them."""
    if isinstance(spec, Mapping):
        inside = ", ".join(f"{k}={_words(v)}" for k, v in spec.items() if k != "plugin")
        name = str(spec.get("plugin", ""))
        return f"{name}({inside})" if inside else name
    if isinstance(spec, (list, tuple)):
        return f"[{', '.join(map(_words, spec))}]"
    return "null" if spec is None else str(spec)


def _searches(pipeline: Pipeline, folder: Path) -> list[Part]:
    parts: list[Part] = []
    for name, results in searches(pipeline).items():
        parts += _pictured(folder / SEARCHES / f"{name}.png", name, "over its parameters.")
        headings = [*(key for key in results if key != SCORE), "balanced accuracy (%)"]
        rows: list[list[Cell]] = [[*row[:-1], float(row[-1])] for row in search_rows(results)]
        parts.append(Table(headings, rows, f"All points of the search of {name}", folded=True))
    return parts


def _reliability(pipeline: Pipeline, folder: Path) -> list[Part]:
    measured = held_out_reliability(pipeline)
    if not measured:
        return []
    rows: list[list[Cell]] = [
        [name, int(each.counts.sum()), 100 * each.error] for name, each in measured.items()
    ]
    caption = "How often decisions are right that are made with a given probability."
    picture = _pictured(folder / RELIABILITY, "Reliability", caption)
    return [*picture, Table(["model", "held-out samples", "calibration error (%)"], rows)]


def _trade_off(pipeline: Pipeline, folder: Path) -> list[Part]:
    if not getattr(pipeline.integrator, "trade_off_", None):
        return []
    caption = "Held-out accuracy, and how often each cue is used, over the cost of a sample."
    return _pictured(folder / f"{TRADE_OFF}.png", "Accuracy over cost", caption)


def _pictured(path: Path, name: str, caption: str) -> list[Part]:
    return [Figure(name, "", caption, path.read_bytes())] if path.is_file() else []


def _text(value: Any) -> str | None:
    return None if value is None else str(value)
