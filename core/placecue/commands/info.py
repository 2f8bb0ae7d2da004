"""``placecue info``: what is in a log, and which topics would be used; what any source gives."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from rich.text import Text

from placecue import progress
from placecue.commands import as_json, tables
from placecue.commands.logs import open_source, single_logs
from placecue.commands.paths import path_of
from placecue.commands.source_summary import SourceSummary, walk
from placecue.commands.straightening import Straightening
from placecue.components.manager import current_plugins
from placecue.errors import UsageError
from placecue.evaluation.map_figure import draw_semantic_map
from placecue.evaluation.map_styles import category_styles
from placecue.evaluation.thumbnail import thumbnail
from placecue.labels.relabelled import Hits, Relabelled
from placecue.logs.info import LogSummary, TopicSummary, summarise
from placecue.logs.reader import McapLog
from placecue.logs.writing.trail import Trail
from placecue.observation import PARTS
from placecue.progress import track
from placecue.semantic_map import SemanticMap
from placecue.source import Source, innermost

WRITES = None
NO_LABEL = "without a label"


def run(config: dict[str, Any]) -> None:
    """Print what is in each log."""
    out = path_of(config, "out") if config["out"] else None
    logs = single_logs(open_source(config, current_plugins()))
    if out is not None and len(logs) > 1:
        raise UsageError(f"out={out} takes the way of one log, and log= names {len(logs)}")
    as_data = as_json.wanted(config)
    documents = []
    for source in logs:
        with progress.shown():
            summary = summary_of(source)
        if as_data:
            documents.append(document(summary))
        elif isinstance(summary, LogSummary):
            print_summary(summary)
        else:
            print_walk(summary)
        if out is not None:
            draw_way(summary, out, told=not as_data)
        elif not as_data:
            print_way(summary)
    if as_data:
        as_json.tell(documents)


def summary_of(source: Source) -> LogSummary | SourceSummary:
    """Look at a log, under other labels where the config asks for them; walk through others."""
    inner, straightening = innermost(source), Straightening(source)
    if not isinstance(inner, McapLog):
        found: LogSummary | SourceSummary = walk(source)
    elif isinstance(source, Relabelled):
        hits = Hits(source)
        found = summarise(inner, hits.label)
        hits.tell()
    else:
        found = summarise(inner)
    if not straightening.sources:
        return found
    for each in track(source, f"correcting poses of {source.name}", source.count()):
        straightening.observe(each)
    trail = Trail()
    for each in straightening.observations():
        trail.add(each)
    return replace(found, trail=trail.points or found.trail)


def document(summary: LogSummary | SourceSummary) -> dict[str, Any]:
    """Return a summary as plain data, the way of the robot left out."""
    # A counter is a mapping that asdict does not know how to make again.
    plain: dict[str, Any] = {"labels": dict(summary.labels), "trail": ()}
    plain["metadata"] = dict(summary.metadata)
    if isinstance(summary, SourceSummary):
        plain["parts"] = dict(summary.parts)
    data = asdict(replace(summary, **plain))
    del data["trail"]
    return {**data, "duration": summary.duration, "coverage": summary.coverage}


def print_walk(summary: SourceSummary) -> None:
    """Print what a source that is no log of messages gives."""
    print(f"{summary.path}: {summary.observations} observations, {summary.duration:.1f} s")
    for key, value in summary.metadata.items():
        print(f"  {key}: {value}")
    rows = [[part, str(summary.parts.get(part, 0))] for part in PARTS]
    tables.table(["part", "observations"], rows)
    print_labels(summary)


def print_summary(summary: LogSummary) -> None:
    """Print the topics of a log, what each part is read from, and its labels."""
    state = "" if summary.whole else ", cut or damaged"
    print(f"{summary.path}: {summary.size / 1e6:.1f} MB, {summary.duration:.1f} s{state}")
    for key, value in summary.metadata.items():
        print(f"  {key}: {value}")
    tables.table(
        ["topic", "schema", "encoding", "messages", "per second", "largest gap (s)"],
        [_row(topic) for topic in summary.topics],
    )
    print()
    for part in summary.parts:
        print(f"{part.part:<6} {', '.join(part.topics) or 'none'}: {part.reason}")
    print_labels(summary)
    if summary.problem:
        print(f"cannot be read as it is: {summary.problem}")


def print_labels(summary: LogSummary | SourceSummary) -> None:
    """Print how much is labelled, and how."""
    if summary.coverage is not None:
        print(f"{summary.observations} observations, {100 * summary.coverage:.1f} % with a label")
    square = " #" if tables.console().options.ascii_only else " ■"
    styles = category_styles(_classes(summary))
    for label, count in sorted(summary.labels.items()):
        mark = Text(f"  {label or NO_LABEL}: {count}")
        tables.console().print(mark.append(square, styles[label][0]) if label else mark)


def print_way(summary: LogSummary | SourceSummary) -> None:
    """Print the way of the robot as a small picture, coloured by label."""
    if not summary.trail:
        return
    console = tables.console()
    colours = {name: colour for name, (colour, _) in category_styles(_classes(summary)).items()}
    print(f"\nthe way, {_extent(summary)}:")
    console.print(thumbnail(summary.trail, colours, plain=console.options.ascii_only))


def draw_way(summary: LogSummary | SourceSummary, out: Path, told: bool = True) -> None:
    """Draw the way of the robot into a picture file."""
    if not summary.trail:
        raise UsageError(f"{summary.path} gives no poses, so there is no way to draw into {out}")
    way = [(x, y, label or NO_LABEL) for x, y, label in summary.trail]
    classes = [*_classes(summary), *[NO_LABEL] * any(not label for _, _, label in summary.trail)]
    nothing = SemanticMap((), (), (), ())
    draw_semantic_map(nothing, out, truth=way, classes=classes, title=Path(summary.path).name)
    if told:
        tables.written([("the way", out)])


def _classes(summary: LogSummary | SourceSummary) -> list[str]:
    return sorted(label for label in summary.labels if label)


def _extent(summary: LogSummary | SourceSummary) -> str:
    xs, ys = [x for x, _, _ in summary.trail], [y for _, y, _ in summary.trail]
    return f"{max(xs) - min(xs):.1f} m wide and {max(ys) - min(ys):.1f} m high"


def _row(topic: TopicSummary) -> list[str]:
    return [
        topic.name,
        topic.schema,
        topic.encoding,
        "-" if topic.count is None else str(topic.count),
        "-" if topic.rate is None else f"{topic.rate:.1f}",
        "-" if topic.gap is None else f"{topic.gap.seconds:.2f}",
    ]
