"""``placecue info``: what is in a log, and which topics would be used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.text import Text

from placecue import progress
from placecue.commands import tables
from placecue.commands.logs import open_source, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.errors import UsageError
from placecue.evaluation.map_figure import category_styles, draw_semantic_map
from placecue.evaluation.thumbnail import thumbnail
from placecue.labels.relabelled import Relabelled
from placecue.logs.info import LogSummary, TopicSummary, summarise
from placecue.logs.reader import McapLog
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
    for source in logs:
        with progress.shown():
            summary = summary_of(source)
        print_summary(summary)
        if out is None:
            print_way(summary)
        else:
            draw_way(summary, out)


def summary_of(source: Source) -> LogSummary:
    """Look at a log, under other labels where the config asks for them.

    Raises
    ------
    UsageError
        If it is no log of messages.
    """
    inner = innermost(source)
    if not isinstance(inner, McapLog):
        raise UsageError(
            f"info looks into MCAP logs and bags, and {source.name} is neither: placecue convert "
            "makes a log of it"
        )
    return summarise(inner, source.label if isinstance(source, Relabelled) else None)


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
    if summary.coverage is not None:
        print(f"{summary.observations} observations, {100 * summary.coverage:.1f} % with a label")
    styles = category_styles(_classes(summary))
    for label, count in sorted(summary.labels.items()):
        mark = Text(f"  {label or NO_LABEL}: {count}")
        tables.console().print(mark.append(" ■", styles[label][0]) if label else mark)
    if summary.problem:
        print(f"cannot be read as it is: {summary.problem}")


def print_way(summary: LogSummary) -> None:
    """Print the way of the robot as a small picture, coloured by label."""
    if not summary.trail:
        return
    console = tables.console()
    colours = {name: colour for name, (colour, _) in category_styles(_classes(summary)).items()}
    print(f"\nthe way, {_extent(summary)}:")
    console.print(thumbnail(summary.trail, colours, plain=console.options.ascii_only))


def draw_way(summary: LogSummary, out: Path) -> None:
    """Draw the way of the robot into a picture file."""
    if not summary.trail:
        raise UsageError(f"{summary.path} gives no poses, so there is no way to draw into {out}")
    way = [(x, y, label or NO_LABEL) for x, y, label in summary.trail]
    classes = [*_classes(summary), *[NO_LABEL] * any(not label for _, _, label in summary.trail)]
    nothing = SemanticMap((), (), (), ())
    draw_semantic_map(nothing, out, truth=way, classes=classes, title=Path(summary.path).name)
    tables.written([("the way", out)])


def _classes(summary: LogSummary) -> list[str]:
    return sorted(label for label in summary.labels if label)


def _extent(summary: LogSummary) -> str:
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
