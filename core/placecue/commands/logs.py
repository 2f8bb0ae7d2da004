"""Opens what ``log=`` and ``source=`` name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from placecue.config import build
from placecue.discovery.manager import Plugins
from placecue.errors import UsageError
from placecue.observation import PARTS, Part
from placecue.source import Chain, Source


def open_source(
    config: Mapping[str, Any],
    plugins: Plugins,
    log: str = "log",
    parts: Sequence[Part] | None = None,
) -> Source:
    """Open the source of a command.

    A list of logs is read one after the other.

    Parameters
    ----------
    config : mapping
        With ``source``, whose ``path`` is ``${log}`` unless it is given.
    plugins : Plugins
        Builds the source, and is told of each log opened.
    log : str
        The key whose logs to read in place of the source's own.
    parts : sequence of str, optional
        The parts of an observation that the command can use; a source that lets one choose reads
        no others, and does not ask which of several topics to take for them.

    Raises
    ------
    UsageError
        If no log was given to a source that reads one.
    """
    spec = dict(config["source"])
    if log != "log":
        spec["path"] = config[log]
    if "path" in spec and not spec["path"]:
        raise UsageError(
            f"nothing to read: give {log}=FILE, {log}=[FILE,FILE], or source=NAME source.path=FILE"
        )
    if parts is not None and "parts" in spec and spec["parts"] is None:
        spec["parts"] = [part for part in PARTS if part in parts]
    paths = spec.get("path")
    specs = [spec]
    if isinstance(paths, list) and not _kind(spec, plugins).reads_many:
        specs = [{**spec, "path": path} for path in paths]
    sources: list[Source] = [build(each, "source", plugins.registry) for each in specs]
    for source in sources:
        plugins.tell("log_opened", source=source)
    return sources[0] if len(sources) == 1 else Chain(sources)


def _kind(spec: Mapping[str, Any], plugins: Plugins) -> type[Source]:
    kind: type[Source] = plugins.registry.load("source", spec["plugin"])
    return kind


def single_logs(source: Source) -> tuple[Source, ...]:
    """Return the single logs of a source."""
    return source.sources if isinstance(source, Chain) else (source,)
