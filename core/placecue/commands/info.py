"""``placecue info``: what is in a log, and which topics would be used."""

from __future__ import annotations

from typing import Any

from placecue import progress
from placecue.commands import show
from placecue.logs.info import LogSummary, summarise

OUT_IS_FOLDER = False


def run(config: dict[str, Any]) -> None:
    """Print what is in each log."""
    logs = config["log"] if isinstance(config["log"], list) else [config["log"]]
    for log in logs:
        with progress.shown():
            summary = summarise(log)
        print_summary(summary)


def print_summary(summary: LogSummary) -> None:
    """Print the topics of a log, what each part is read from, and its labels."""
    state = "" if summary.whole else ", cut or damaged"
    print(f"{summary.path}: {summary.size / 1e6:.1f} MB, {summary.duration:.1f} s{state}")
    for key, value in summary.metadata.items():
        print(f"  {key}: {value}")
    show.table(
        ["topic", "schema", "encoding", "messages", "per second"],
        [
            [
                topic.name,
                topic.schema,
                topic.encoding,
                "-" if topic.count is None else str(topic.count),
                "-" if topic.rate is None else f"{topic.rate:.1f}",
            ]
            for topic in summary.topics
        ],
    )
    print()
    for part in summary.parts:
        print(f"{part.part:<6} {', '.join(part.topics) or 'none'}: {part.reason}")
    if summary.observations is not None:
        print(f"{summary.observations} observations")
    for label, count in sorted(summary.labels.items()):
        print(f"  {label or 'without a label'}: {count}")
    if summary.problem:
        print(f"cannot be read as it is: {summary.problem}")
