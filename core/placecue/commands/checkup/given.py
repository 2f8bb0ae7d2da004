"""The log and the model that the doctor is given."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from placecue.commands.checkup.finding import Finding
from placecue.commands.logs import open_source, single_logs
from placecue.components.manager import Plugins
from placecue.errors import FOREIGN, PlacecueError, told
from placecue.observation import PARTS
from placecue.source import Source


def logs(config: Mapping[str, Any], plugins: Plugins) -> Iterator[Finding]:
    """Open each log and read it through."""
    from placecue.commands.info import summary_of
    from placecue.commands.source_summary import SourceSummary

    try:
        sources = single_logs(open_source(config, plugins))
    except FOREIGN as error:
        yield Finding("wrong", "log", _reason(error))
        return
    for source in sources:
        try:
            summary = summary_of(source)
        except FOREIGN as error:
            yield Finding("wrong", f"log {source.name}", _reason(error))
            continue
        name = f"log {summary.path}"
        if isinstance(summary, SourceSummary):
            there = ", ".join(f"{summary.parts.get(part, 0)} x {part}" for part in PARTS)
            yield Finding("ok" if summary.observations else "wrong", name,
                          f"{summary.observations} observations over {summary.duration:.1f} s, "
                          f"{there}")  # fmt: skip
        elif summary.problem:
            yield Finding("wrong", name, summary.problem)
        else:
            if not summary.whole:
                yield Finding("note", name, "is cut or damaged; what is left is read")
            for part in summary.parts:
                topics = ", ".join(part.topics) or "none"
                yield Finding("ok" if part.clear else "wrong", f"{name}, {part.part}",
                              f"{topics} ({part.reason})")  # fmt: skip
            yield Finding("ok", name, f"{summary.observations} observations")
        yield from _labels(source, summary.coverage, name)


def _labels(source: Source, coverage: float | None, name: str) -> Iterator[Finding]:
    if coverage == 0:
        mend = "train and scores need labels: rooms=FILE.geojson or source.labels=FILE.csv"
        yield Finding("note", name, "no observation has a label", mend)
    elif coverage is not None:
        yield Finding("ok", name, f"{100 * coverage:.1f} % of the observations have a label")


def model(folder: Path, plugins: Plugins) -> Iterator[Finding]:
    """Load a model."""
    from placecue.storage.model import load_model

    try:
        pipeline = load_model(folder, plugins.registry, "refuse")
    except FOREIGN as error:
        mend = "" if isinstance(error, PlacecueError) else "train it again"
        yield Finding("wrong", f"model {folder}", _reason(error), mend)
        return
    cues = ", ".join(pipeline.cues)
    yield Finding("ok", f"model {folder}",
                  f"{len(pipeline.classes)} classes ({', '.join(pipeline.classes)}), cues {cues}, "
                  f"needs {', '.join(pipeline.requires)}")  # fmt: skip


def _reason(error: BaseException) -> str:
    return str(error) if isinstance(error, PlacecueError) else told(error)
