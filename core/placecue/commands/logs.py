"""Opens what ``log=`` and ``source=`` name, and says where ``out=`` and ``model=`` are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from placecue.checks import check_choice, check_flag
from placecue.commands.label_names import with_names
from placecue.components.build import build
from placecue.components.manager import Plugins
from placecue.errors import UsageError
from placecue.labels.relabelled import relabelled
from placecue.observation import PARTS, Part
from placecue.slam.libraries import check_installed
from placecue.slam.straightened import SEEN, Straightened, frames_of
from placecue.source import Chain, Source, guarded

if TYPE_CHECKING:
    from placecue.pipeline import Pipeline

#: What may become of an observation that a component fails on; the first by default.
ON_ERROR = ("stop", "skip")


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
        With ``source``, whose ``path`` is ``${log}`` unless it is given; ``slam`` corrects its
        poses by its scans; ``rooms``, ``label_map`` and ``unmapped_labels`` give its observations
        other labels.
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
    slam = wants_slam(config)
    if parts is not None and "parts" in spec and spec["parts"] is None:
        needed = {*parts, *(["pose"] if config.get("rooms") else []), *(SEEN if slam else ())}
        spec["parts"] = [part for part in PARTS if part in needed]
    paths = spec.get("path")
    specs = [spec]
    if isinstance(paths, list) and not _kind(spec, plugins).reads_many:
        specs = [{**spec, "path": path} for path in paths]
    sources = [guarded(_built(each, plugins)) for each in specs]
    if slam:
        frames = frames_of(len(sources))
        sources = [Straightened(*each) for each in zip(sources, frames, strict=True)]
    sources = [relabelled(each, with_names(config)) for each in sources]
    for source in sources:
        plugins.tell("log_opened", source=source)
    return sources[0] if len(sources) == 1 else Chain(sources)


def on_error_of(config: Mapping[str, Any]) -> str:
    """Return what becomes of an observation that a component fails on: stop or skip.

    Raises
    ------
    UsageError
        If it is neither.
    """
    on_error: str = config.get("on_error", ON_ERROR[0])
    check_choice("on_error", on_error, ON_ERROR)
    return on_error


def wants_slam(config: Mapping[str, Any]) -> bool:
    """Return whether poses are to be corrected by scans.

    Raises
    ------
    UsageError
        If ``slam`` is neither true nor false, or what it needs is not installed.
    """
    wanted: bool = config.get("slam", False)
    check_flag("slam", wanted)
    if wanted:
        check_installed()
    return wanted


def set_tolerance(pipeline: Pipeline, config: Mapping[str, Any]) -> None:
    """Tell a pipeline what to do where a component fails, and where cues are missing.

    Raises
    ------
    UsageError
        If ``on_error`` is neither stop nor skip, or ``min_cues`` no number of its cues.
    """
    pipeline.on_error = on_error_of(config)
    pipeline.min_cues = config.get("min_cues", pipeline.min_cues)
    _ = pipeline.least  # wrong numbers are told before a log is read


def _built(spec: Mapping[str, Any], plugins: Plugins) -> Source:
    source: Source = build(spec, "source", plugins.registry)
    return source


def _kind(spec: Mapping[str, Any], plugins: Plugins) -> type[Source]:
    kind: type[Source] = plugins.registry.load("source", spec["plugin"])
    return kind


def single_logs(source: Source) -> tuple[Source, ...]:
    """Return the single logs of a source."""
    return source.sources if isinstance(source, Chain) else (source,)
