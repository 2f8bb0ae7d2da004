"""What every task of an experiment reads: recordings, their samples, and how they are cut."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.cue import Cue
from placecue.errors import DataError
from placecue.evaluation.protocol.pairs import Part
from placecue.evaluation.protocol.recordings import Recorded
from placecue.evaluation.protocol.thinned import Thinned
from placecue.folds import FoldScheme, cut
from placecue.labels.relabelled import relabelled
from placecue.learning.collecting import collect
from placecue.learning.samples import Samples
from placecue.source import Chain, Source, guarded
from placecue.storage.feature_cache import FeatureCache

#: Samples of so many recordings by one cue are kept in a process.
KEPT = 16
_samples: dict[tuple[Any, ...], Samples] = {}
_lock = Lock()


@dataclass(frozen=True)
class Bench:
    """Where tasks read and write; small, as it goes to every worker.

    Parameters
    ----------
    out : str
        The folder of the run.
    cache : str
        The folder of the feature cache.
    recordings : tuple of Recorded
        All of them.
    every : int
        Takes every so-many-th observation.
    folds : mapping
        The config of the scheme that samples are cut by.
    labels : mapping
        ``rooms``, ``label_map`` and ``unmapped_labels``.
    skip : bool
        Whether a sample at which a component fails counts as unusable.
    accumulators : mapping of str to mapping
        Configs of accumulators by name, which label the areas of every test.
    """

    out: str
    cache: str
    recordings: tuple[Recorded, ...]
    every: int
    folds: Mapping[str, Any]
    labels: Mapping[str, Any]
    skip: bool = False
    accumulators: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """The folder of the run."""
        return Path(self.out)

    @cached_property
    def scheme(self) -> FoldScheme:
        """How samples are cut."""
        found: FoldScheme = build(self.folds, "folds", current_plugins().registry)
        return found

    def recording(self, world: str, name: str) -> Recorded:
        """Return a recording by its name."""
        return next(each for each in self.recordings if each.key == (world, name))

    def open(self, world: str, name: str) -> Source:
        """Return a recording's observations, thinned and relabelled."""
        return opened(self.recording(world, name), self.labels, self.every)

    def samples(self, world: str, parts: Sequence[Part], name: str, cue: Cue) -> Samples:
        """Return the labelled samples of some parts of recordings, with the features of a cue.

        Features come from the cache; those of the last few calls are kept in memory.
        """
        names = tuple(dict.fromkeys(part.recording for part in parts))
        whole = self._whole(world, names, name, cue)
        [part, *more] = parts
        if part.fold is None:
            return whole
        if more:
            raise DataError("folds are of one recording each")
        rows = self._rows(whole, part)
        return whole.take(rows)

    def _whole(self, world: str, names: tuple[str, ...], name: str, cue: Cue) -> Samples:
        key = (self.out, self.every, world, names, name, repr(cue.get_params()))
        with _lock:
            if key in _samples:
                _samples[key] = _samples.pop(key)  # what was asked for last stands last
                return _samples[key]
        sources = [self.open(world, each) for each in names]
        observations = sources[0] if len(sources) == 1 else Chain(sources)
        with FeatureCache(Path(self.cache), current_plugins().registry) as extraction:
            found = collect(observations, {name: cue}, extraction, self.scheme, skip=self.skip)
        with _lock:
            _samples[key] = found
            while len(_samples) > KEPT:
                del _samples[next(iter(_samples))]
        return found

    def _rows(self, samples: Samples, part: Part) -> Any:
        folds = cut(self.scheme, samples.labels, samples.stamps, samples.groups)
        assert part.fold is not None
        if part.fold >= len(folds):
            raise DataError(
                f"{part.recording} can be cut into {len(folds)} folds only, not into "
                f"{self.scheme.n_folds}: give folds.n_folds={len(folds)}"
            )
        training, held_out = folds[part.fold]
        return held_out if part.held_out else training


def opened(recorded: Recorded, labels: Mapping[str, Any], every: int = 1) -> Source:
    """Return the observations of a recording, with other labels where that is asked for."""
    source: Source = guarded(build(recorded.source, "source", current_plugins().registry))
    source = relabelled(source, labels)
    return source if every == 1 else Thinned(source, every)


def digest_of(*values: Any) -> str:
    """Return a digest of plain data."""
    text = json.dumps(values, sort_keys=True, ensure_ascii=False, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{value!r} is no plain data")
