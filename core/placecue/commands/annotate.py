"""``placecue annotate``: a copy of a log with a channel of labels."""

from __future__ import annotations

from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.commands.logs import open_source, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.errors import DataError, UsageError
from placecue.labels.relabelled import Relabelled
from placecue.logs.reader import McapLog
from placecue.logs.writing.annotate import annotate, label_events
from placecue.source import Source, innermost

WRITES = None


def run(config: dict[str, Any]) -> None:
    """Copy a log and write the labels that a config asks for into the copy."""
    out, plugins = path_of(config, "out"), current_plugins()
    if not (config["rooms"] or config["label_map"] or config["source"].get("labels")):
        raise UsageError(
            "annotate needs labels to write: give rooms=FILE.geojson, source.labels=FILE.csv, or "
            "label_map={OLD:NEW}"
        )
    source = _single(open_source(config, plugins))
    log, label = _log(source)
    with progress.shown():
        moments = (each.relabelled(label(each)) for each in log.trail())
        events = label_events(progress.track(moments, "finding the labels", log.count()))
        if not events:
            raise DataError(f"not one observation of {log.name} gets a label: nothing to write")
        made(out.parent)
        count = annotate(log.file, events, out, config["topic"])
    names = sorted({name for _, name in events if name})
    print(
        f"{count} messages and {len(events)} labels on {config['topic']} ({', '.join(names)}) in "
        f"{out}"
    )
    print(f"next: placecue info log={out} source.label_topic={config['topic']}")
    plugins.tell("run_finished", command="annotate", out=out)


def _single(source: Source) -> Source:
    logs = single_logs(source)
    if len(logs) > 1:
        raise UsageError(f"annotate takes one log at a time, and log= names {len(logs)}")
    return logs[0]


def _log(source: Source) -> tuple[McapLog, Any]:
    """Return the log itself, and what gives the label of a moment in it."""
    inner = innermost(source)
    if type(inner) is not McapLog:
        raise UsageError(
            f"annotate copies MCAP logs, and {source.name} is none: placecue convert takes rooms= "
            "and label_map= and writes one"
        )
    own = source.label if isinstance(source, Relabelled) else lambda moment: moment.label
    return inner, own
