"""``placecue convert``: any source -> MCAP."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.commands.logs import open_source
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter

WRITES = None


def run(config: dict[str, Any]) -> None:
    """Write the observations of a source as MCAP."""
    out = path_of(config, "out")
    name, count = convert(config, out)
    print(f"{count} observations of {name} in {out}")
    print(f"next: placecue info log={out}")
    current_plugins().tell("run_finished", command="convert", out=out)


def convert(config: dict[str, Any], out: Path) -> tuple[str, int]:
    """Write the source that a config describes; return its name and how many observations."""
    source = open_source(config, current_plugins())
    made(out.parent)
    writer = McapWriter(
        out, encoding=config["encoding"], metadata=source.metadata, camera=source.camera
    )
    with progress.shown(), writer:
        return source.name, copy(source, writer)
