"""Tasks that come before all others: recording what is not there yet, and extracting cues."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from placecue.atomic import made
from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.errors import DataError
from placecue.evaluation.protocol.bench import Bench, opened
from placecue.evaluation.protocol.recordings import Recorded
from placecue.learning.collecting import collect
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.source import Source, guarded
from placecue.storage.feature_cache import FeatureCache

#: The metadata of a made log that says what it was made by.
MADE_BY = "made_by"


@dataclass(frozen=True)
class Contents:
    """What a recording is.

    Parameters
    ----------
    digest : str
        Of its content.
    metadata : mapping of str to str
        What its log says of itself.
    """

    digest: str
    metadata: Mapping[str, str]


def recorded(each: Recorded) -> float:
    """Record a log that is not there yet; return what that took, s.

    Raises
    ------
    DataError
        If the log that is there was made by something else.
    """
    if each.origin is None:
        return 0.0
    began, path = perf_counter(), Path(str(each.source["path"]))
    source: Source = guarded(build(each.origin, "source", current_plugins().registry))
    digest = source.digest()
    if path.exists():
        known = opened(each, {}).metadata.get(MADE_BY)
        if known is not None and known != digest:
            raise DataError(
                f"{path} was recorded by another version or with other parameters: remove it, or "
                "give another make.path"
            )
        return 0.0
    made(path.parent)
    metadata = {**source.metadata, MADE_BY: digest}
    with McapWriter(path, metadata=metadata, camera=source.camera) as writer:
        copy(source, writer)
    return perf_counter() - began


def contents_of(each: Recorded, labels: Mapping[str, Any], every: int) -> Contents:
    """Return what a recording is."""
    source = opened(each, labels, every)
    return Contents(source.digest(), dict(source.metadata))


@dataclass(frozen=True)
class ExtractionTask:
    """A recording from which all cues are to be extracted that learn nothing.

    Parameters
    ----------
    bench : Bench
    recording : Recorded
    cues : tuple of mapping
        Configs of cues.
    """

    bench: Bench
    recording: Recorded
    cues: tuple[Mapping[str, Any], ...]

    def __str__(self) -> str:
        return f"cues of {' '.join(filter(None, self.recording.key))}"


def extracted(task: ExtractionTask) -> dict[str, int]:
    """Extract cues into the cache, in one pass; return how many samples each class has."""
    registry = current_plugins().registry
    plugins = [str(spec["plugin"]) for spec in task.cues]
    cues = {
        # Of one kind there may be several, with other parameters.
        f"{plugin} {n + 1}" if plugins.count(plugin) > 1 else plugin: build(spec, "cue", registry)
        for n, (plugin, spec) in enumerate(zip(plugins, task.cues, strict=True))
    }
    bench = task.bench
    source = bench.open(*task.recording.key)
    with FeatureCache(Path(bench.cache), registry) as extraction:
        samples = collect(source, cues, extraction, bench.scheme, skip=bench.skip)
    return dict(sorted(Counter(samples.labels.tolist()).items()))
