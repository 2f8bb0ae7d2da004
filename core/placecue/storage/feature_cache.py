"""Features that are kept between runs, by log, cue, version and parameters.

``FOLDER/LOG/CUE-KEY/000000.npz`` holds the features of the first observations of the log with
that digest by one cue; ``FOLDER/learned/CUE-KEY/state.npz`` what a cue has learned from given
observations. Files are written whole and hold arrays and JSON only, so that runs side by side may
share the folder, a killed run goes on where it was, and reading never runs code.
"""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from inspect import signature
from pathlib import Path
from pickle import PicklingError
from types import TracebackType
from typing import Any, Self

import joblib
import numpy as np

from placecue.components.registry import Registry
from placecue.cue import Cue
from placecue.errors import ComponentError, PlacecueError, UnusableObservation, UsageError
from placecue.extraction import AnyCue, Extracted, Extraction, ready
from placecue.features import Features, single, stack
from placecue.guard import call
from placecue.observation import READING, Observation, Origin
from placecue.storage import cache_folder
from placecue.storage.arrays import read_arrays, write_arrays
from placecue.storage.shard import SIZE, Entry, Shard
from placecue.storage.state import Decoder, Encoder, learned

log = logging.getLogger(__name__)

LEARNED = "learned"
_GIGA = 1e9


class FeatureCache(Extraction):
    """Extracts what is not kept yet; to be used in a ``with`` block, which writes the last of it.

    A folder that cannot be written to costs a warning and no more.

    Parameters
    ----------
    folder : Path
        Where features are kept; made if it is not there.
    registry : Registry
        Names the cues.
    max_size : float, optional
        What was used least recently is removed in the end until the rest takes no more, GB.
    """

    def __init__(self, folder: Path, registry: Registry, max_size: float | None = None) -> None:
        self.folder = folder
        self.registry = registry
        self.max_size = max_size
        self._keys = _Keys(registry)
        self._shards: dict[Path, Shard] = {}
        self._about: dict[Path, Mapping[str, Any]] = {}
        self._writable = True
        self._log = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._save_all()
        if self.max_size is not None and self._writable:
            with suppress(OSError):  # another run may be trimming too
                cache_folder.trim(self.folder, self.max_size * _GIGA)

    # ------------------------------------------------------------------ what Extraction promises

    def extract(  # noqa: D102
        self, cue: Cue, observations: Sequence[Observation], *, skip: bool = False
    ) -> Extracted:
        entries = [self._kept(cue, each) for each in observations]
        missing = [row for row, entry in enumerate(entries) if entry is None]
        fresh = super().extract(cue, [observations[row] for row in missing], skip=skip)
        failed = {missing[row]: error for row, error in fresh.failed.items()}
        features: dict[int, Features] = {}
        for number, row in enumerate(fresh.rows):
            assert fresh.features is not None
            features[missing[row]] = single(fresh.features, number)
            self._keep(cue, observations[missing[row]], features[missing[row]])
        for row, error in failed.items():
            self._note(cue, observations[row], error)
        for row, entry in enumerate(entries):
            if entry is not None and entry.features is None:
                failed[row] = entry.unusable()
            elif entry is not None:
                features[row] = entry.get()
        rows = np.array(sorted(features), dtype=np.int64)
        if len(missing) == len(observations):
            return Extracted(rows, fresh.features, failed)  # as it came, not taken apart
        batch = stack([features[row] for row in rows]) if features else None
        return Extracted(rows, batch, failed)

    def _note(self, cue: Cue, observation: Observation, error: UnusableObservation) -> None:
        """Keep that a cue can make nothing of an observation whose parts are there."""
        # What does not decode, or failed for a reason of its own, may not fail next time.
        if not isinstance(error.__cause__, ComponentError) and ready(cue, [observation])[0]:
            self._keep(cue, observation, None, str(error))

    def fit(  # noqa: D102
        self,
        cue: AnyCue,
        observations: Iterable[Observation],
        labels: Any,
        origins: Sequence[Origin | None],
    ) -> AnyCue:
        if any(origin is None for origin in origins):
            return super().fit(cue, observations, labels, origins)
        seen = _digest(
            [
                [[each.log, each.number, each.altered] for each in origins if each is not None],
                np.asarray(labels).tolist(),
            ]
        )
        if self._keys(cue, "") is None:
            return super().fit(cue, observations, labels, origins)
        about = {**self._keys.about(cue), "log": f"{len(origins)} samples", "seen": seen}
        folder = self.folder / LEARNED / f"{about['cue']}-{_digest(about)}"
        if self._restored(cue, folder / "state.npz"):
            cache_folder.touch(folder)
            return cue
        super().fit(cue, observations, labels, origins)
        self._store(cue, folder, about)
        return cue

    # ------------------------------------------------------------------ one observation

    def _kept(self, cue: Cue, observation: Observation) -> Entry | None:
        if observation.origin is None:
            return None
        shard = self._shard(cue, observation.origin)
        entry = None if shard is None else shard.entries.get(observation.origin.number)
        return entry if entry is not None and entry.stamp == observation.stamp else None

    def _keep(
        self, cue: Cue, observation: Observation, features: Features | None, reason: str = ""
    ) -> None:
        shard = observation.origin and self._shard(cue, observation.origin)
        if shard and observation.origin is not None:
            entry = Entry(observation.stamp, features, reason)
            shard.keep(observation.origin.number, entry)

    def _shard(self, cue: Cue, origin: Origin) -> Shard | None:
        """Return the file that an observation belongs to, of the log at hand one a cue is open.

        None if a parameter of the cue is nothing that a key can be made of.
        """
        if origin.log != self._log:
            self._save_all()
            self._log = origin.log
        named = self._keys(cue, origin.altered)
        if named is None:
            return None
        name, key = named
        folder = self.folder / _digest(origin.log) / f"{name}-{key}"
        path = folder / f"{origin.number // SIZE:06d}.npz"
        current = self._shards.get(folder)
        if current is not None and current.path == path:
            return current
        if current is None:
            about = {**self._keys.about(cue), "altered": origin.altered}
            self._about[folder] = {**about, "log": origin.recording.name}
            cache_folder.touch(folder)
        self._save(folder)
        self._shards[folder] = Shard(path)
        return self._shards[folder]

    # ------------------------------------------------------------------ writing

    def _save_all(self) -> None:
        for folder in list(self._shards):
            self._save(folder)
        self._shards.clear()

    def _save(self, folder: Path) -> None:
        current = self._shards.get(folder)
        if current is None or not current.changed or not self._writable:
            return
        try:
            cache_folder.describe(folder, self._about[folder])
            current.save()
        except PlacecueError as error:
            self._give_up(error)

    def _store(self, cue: Cue, folder: Path, about: Mapping[str, Any]) -> None:
        encoder = Encoder(self.registry)
        try:
            state = json.dumps(encoder.state(cue, about["cue"]))
        except UsageError:
            return  # learned something that cannot be kept
        try:
            cache_folder.describe(folder, about)
            write_arrays(folder / "state.npz", {"state": np.array(state), **encoder.arrays})
        except PlacecueError as error:
            self._give_up(error)

    def _restored(self, cue: Cue, path: Path) -> bool:
        try:
            arrays = read_arrays(path)
            state = json.loads(str(arrays.pop("state")))
            Decoder(self.registry, arrays).restore(cue, state)
        except Exception:  # damage has many names; what cannot be read is learned again
            return False
        return True

    def _give_up(self, error: PlacecueError) -> None:
        if self._writable:
            self._writable = False
            reason = error.__cause__ or error
            log.warning(
                f"the feature cache {self.folder} cannot be written ({reason}): features are not "
                "kept; choose another place with cache.folder=PATH, or none with cache.folder=null"
            )


class _Keys:
    """Names and keys of cues, worked out once for as long as a cue stays as it is."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self._known: dict[tuple[int, str], tuple[Cue, str, dict[str, Any], tuple[str, str]]] = {}

    def __call__(self, cue: Cue, altered: str) -> tuple[str, str] | None:
        """Return the name of a cue, and a digest of all that its features depend on.

        None if a parameter is nothing that a digest can be made of, such as a function.
        """
        try:
            parameters = _json(cue.get_params(deep=False))
        except (PicklingError, TypeError, AttributeError):
            return None
        call(cue, "prepare")
        known, state = self._known.get((id(cue), altered)), learned(cue)
        if known is not None and known[:2] == (cue, parameters) and _same(known[2], state):
            return known[3]
        about = {**self.about(cue), "altered": altered, "learned": joblib.hash(_bare(state))}
        found = (about["cue"], _digest([about, parameters]))
        self._known[id(cue), altered] = (cue, parameters, state, found)
        return found

    def about(self, cue: Cue) -> dict[str, Any]:
        """Return what a cue is, as plain data."""
        provided = self.registry.find(cue)
        kind = type(cue)
        parameters = json.loads(_json(cue.get_params(deep=False)))
        usual = _usual(kind)
        return {
            "cue": kind.__name__ if provided is None else provided.component.name,
            "class": f"{kind.__module__}.{kind.__qualname__}",
            "version": cue.version,
            "reading": READING,
            "libraries": _libraries(cue),
            "inside": _versions(cue.get_params(deep=False)),
            "parameters": parameters,
            "changed": {
                name: self._shown(getattr(cue, name))
                for name, value in parameters.items()
                if value != usual.get(name)
            },
        }

    def _shown(self, value: Any) -> Any:
        """Return a parameter for a person: of a component its name, and what is unlike its usual.

        What stands in lists is left as it is.
        """
        if isinstance(value, Mapping):
            return {name: self._shown(each) for name, each in value.items()}
        if not hasattr(value, "get_params"):
            return json.loads(_json(value))
        provided, usual = self.registry.find(value), _usual(type(value))
        name = type(value).__name__ if provided is None else provided.component.name
        given = json.loads(_json(value.get_params(deep=False)))
        changed = {key: each for key, each in given.items() if each != usual.get(key)}
        return {"plugin": name, **changed} if changed else name


def _usual(kind: type) -> dict[str, Any]:
    """Return the defaults of parameters as plain data."""
    defaults = {name: each.default for name, each in signature(kind).parameters.items()}
    plain: dict[str, Any] = json.loads(_json(defaults))
    return plain


def _libraries(cue: Cue) -> dict[str, str]:
    """Return the versions of what reads the parts of an observation that a cue needs."""
    if "image" not in cue.requires:
        return {}
    import cv2

    return {"opencv": cv2.__version__}


def _versions(value: Any) -> Any:
    """Return the versions of components in a value, in the shape of their places."""
    if _is_component(value):
        return [str(getattr(value, "version", "")), _versions(value.get_params(deep=False))]
    if isinstance(value, Mapping):
        found = {str(name): _versions(each) for name, each in value.items()}
        return {name: each for name, each in found.items() if each}
    if isinstance(value, (list, tuple)):
        found_in = [_versions(each) for each in value]
        return found_in if any(found_in) else None
    return None


def _same(before: Mapping[str, Any], now: Mapping[str, Any]) -> bool:
    return before.keys() == now.keys() and all(now[name] is before[name] for name in before)


def _digest(data: Any) -> str:
    return hashlib.sha256(_json(data).encode()).hexdigest()[:16]


def _json(data: Any) -> str:
    return json.dumps(data, sort_keys=True, default=_plain)


def _plain(value: Any) -> Any:
    """Return what stands in JSON for what that cannot hold."""
    return _bare(value) if _is_component(value) else joblib.hash(value)


def _bare(value: Any) -> Any:
    """Return a value with each component in it as its class, parameters and learned state.

    What it keeps for itself under names with ``_`` in front makes no other component of it.
    """
    if _is_component(value):
        name = f"{type(value).__module__}.{type(value).__qualname__}"
        return [name, _bare(value.get_params(deep=False)), _bare(learned(value))]
    if isinstance(value, Mapping):
        return {key: _bare(each) for key, each in value.items()}
    return [_bare(each) for each in value] if isinstance(value, (list, tuple)) else value


def _is_component(value: Any) -> bool:
    return hasattr(value, "get_params") and not isinstance(value, type)
