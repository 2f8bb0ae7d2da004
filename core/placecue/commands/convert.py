"""``placecue convert``: any source -> MCAP."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.checks import check_choice
from placecue.commands.logs import open_source, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.logs.reader import McapLog
from placecue.logs.writing.convert import copy
from placecue.logs.writing.kept import Kept, left_out
from placecue.logs.writing.writer import DIALECTS, McapWriter
from placecue.source import innermost

WRITES = None


#: What is copied of a log: what makes observations, or everything.
KEEP = ("used", "all")
#: How many topics that are left out are named.
NAMED = 5


def run(config: dict[str, Any]) -> None:
    """Write the observations of a source as MCAP."""
    out = path_of(config, "out")
    name, count = convert(config, out)
    print(f"{count} observations of {name} in {out}")
    print(f"next: {shlex.join(('placecue', 'info', str(out)))}")
    current_plugins().tell("run_finished", command="convert", out=out)


def convert(config: dict[str, Any], out: Path) -> tuple[str, int]:
    """Write the source that a config describes; return its name and how many observations.

    What else a log holds is copied beside them, or it is told that it is left out.
    """
    keep = config.get("keep", KEEP[0])
    check_choice("keep", keep, KEEP)
    source = open_source(config, current_plugins())
    logs = [each for each in map(innermost, single_logs(source)) if isinstance(each, McapLog)]
    kept = Kept(logs) if keep == "all" and logs else None
    made(out.parent)
    encoding = config["encoding"]
    writer = McapWriter(
        out,
        encoding=encoding,
        metadata=source.metadata,
        camera=source.camera,
        profile=kept.profile(DIALECTS[encoding].profile) if kept and encoding in DIALECTS else None,
    )
    with progress.shown(), writer:
        count = copy(source, writer, kept)
    if kept is not None:
        print(f"{kept.count} other messages copied as they are")
    elif told := _left_out(logs):
        print(told)
    return source.name, count


def _left_out(logs: Sequence[McapLog]) -> str:
    """Return what of logs is not in their copy; empty where that is nothing."""
    topics = [topic for each in logs for topic in left_out(each)]
    records = {name for each in logs for name in each.file.contents.metadata} - {"placecue"}
    told = [str(topic) for topic in topics[:NAMED]]
    told += [f"{len(topics) - NAMED} more topics"] * (len(topics) > NAMED)
    told += [f"metadata {name}" for name in sorted(records)]
    attached = [name for each in logs for name in each.file.contents.attachments]
    told += [f"attachment {name}" for name in attached[:NAMED]]
    told += [f"{len(attached) - NAMED} more attachments"] * (len(attached) > NAMED)
    return f"left out: {', '.join(told)}; keep=all copies them" if told else ""
