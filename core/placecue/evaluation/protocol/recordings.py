"""The recordings of an experiment: given logs, a folder of logs, or what is recorded on first use.

A recording has metadata, by which pairs are chosen: what its log says of itself, what its name
tells, what the experiment says.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any

from placecue.errors import UsageError, choices

#: What the logs in a folder are called.
LOG = "*.mcap"


@dataclass(frozen=True)
class Recorded:
    """A recording of an experiment.

    Parameters
    ----------
    name : str
        What pairs call it.
    world : str
        What results are averaged within before they are averaged over; empty where there is one.
    source : mapping
        The config of the source that reads it.
    origin : mapping, optional
        The config of the source that it is recorded from where its log is not there yet.
    metadata : mapping of str to str
        Conditions, as far as they are known before it is opened.
    """

    name: str
    world: str
    source: Mapping[str, Any]
    origin: Mapping[str, Any] | None = None
    metadata: Mapping[str, str] = field(default_factory=dict)

    @property
    def key(self) -> tuple[str, str]:
        """World and name, which tell it from all others."""
        return self.world, self.name

    @property
    def log(self) -> str:
        """What it is read from, for a person."""
        return str(self.source.get("path") or self.source["plugin"])


def recordings_of(config: Mapping[str, Any]) -> list[Recorded]:
    """Return the recordings that a config asks for.

    Parameters
    ----------
    config : mapping
        ``log`` (a path, or a list of paths), or else ``logs`` (a folder of MCAP logs), or else
        ``recordings`` (by name: a path, or a mapping of ``log`` or ``source`` and metadata), or
        else ``make`` (see :func:`made_by`). ``source`` reads them; ``conditions.pattern`` is a
        regular expression whose named groups tell metadata from names.

    Raises
    ------
    UsageError
        If there is none, or two have one name.
    """
    found = list(_found(config))
    if not found:
        raise UsageError(
            "no recordings to evaluate on: give log=[a.mcap,b.mcap], logs=FOLDER, or "
            "experiment=NAME"
        )
    keys = [each.key for each in found]
    twice = sorted({each.name for each in found if keys.count(each.key) > 1})
    if twice:
        raise UsageError(
            f"two recordings are called {twice[0]}: rename a file, or give recordings="
            "{NAME: FILE, ...}"
        )
    pattern = (config.get("conditions") or {}).get("pattern")
    return [_told(each, pattern) for each in found]


def _found(config: Mapping[str, Any]) -> Iterator[Recorded]:
    given = config["source"]
    source = {"plugin": given} if isinstance(given, str) else given
    if config.get("log"):
        logs = config["log"] if isinstance(config["log"], list) else [config["log"]]
        yield from (_read(Path(str(log)).stem, log, source) for log in logs)
    elif config.get("logs"):
        yield from (_read(path.stem, path, source) for path in _logs_in(Path(config["logs"])))
    elif config.get("recordings"):
        named = config["recordings"]
        if not isinstance(named, Mapping):
            raise UsageError(
                f"recordings must be a mapping, {{NAME: FILE}}, got {named!r}; or "
                "give log=[FILE, FILE]"
            )
        yield from (_named(str(name), each, source) for name, each in named.items())
    elif config.get("make"):
        yield from made_by(config["make"])


def _read(name: str, log: Any, source: Mapping[str, Any]) -> Recorded:
    return Recorded(name, "", {**source, "path": str(log)})


def _named(name: str, spec: Any, source: Mapping[str, Any]) -> Recorded:
    if not isinstance(spec, Mapping):
        return _read(name, spec, source)
    told = {str(k): str(v) for k, v in spec.items() if k not in ("log", "source", "world")}
    if "source" in spec:
        read = Recorded(name, "", spec["source"])
    elif "log" in spec:
        read = _read(name, spec["log"], source)
    else:
        raise UsageError(f"recording {name} names neither log nor source: give one of them")
    return replace(read, metadata=told, world=str(spec.get("world", "")))


def _logs_in(folder: Path) -> list[Path]:
    found = sorted(folder.glob(LOG))
    if not found:
        what = "holds no .mcap log" if folder.is_dir() else "is no folder"
        raise UsageError(f"logs={folder} {what}: convert other logs first, with placecue convert")
    return found


def made_by(make: Mapping[str, Any]) -> Iterator[Recorded]:
    """Yield the recordings that are made on first use, or read straight from their sources.

    Parameters
    ----------
    make : mapping
        ``source``: the config of what records them; ``vary``: names with lists of values, one
        recording for each combination; ``worlds``: one name with a value or a list of them, a
        world each; ``name`` and ``path``: formats of their names and paths. A name that stands in
        braces in a text of the source is filled in there; any other is a parameter of it. Without
        a path the source is read itself, which suits what is fast to make.

    Raises
    ------
    UsageError
        If it makes no sense.
    """
    lacking = [key for key in ("source", "vary", "name") if key not in make]
    if lacking:
        raise UsageError(f"make lacks {', '.join(lacking)}: give make.{lacking[0]}=...")
    for world in _combinations(make.get("worlds") or {}):
        for varied in _combinations(make["vary"]):
            given = {**world, **varied}
            source = _source(make["source"], given)
            told = {key: str(value) for key, value in varied.items()}
            name = _formatted(make["name"], {**source, **given}, "name")
            of_world = " ".join(f"{key} {value}" for key, value in world.items())
            if not make.get("path"):
                yield Recorded(name, of_world, source, None, told)
                continue
            path = _formatted(make["path"], {**source, **given}, "path")
            yield Recorded(name, of_world, {"plugin": "mcap", "path": path}, source, told)


def _source(source: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the config of a source with names filled in, and those that it does not name added."""
    texts = {key: value for key, value in source.items() if isinstance(value, str)}
    named = {name for name in given if any(f"{{{name}}}" in text for text in texts.values())}
    filled = {
        key: _formatted(text, given, f"source.{key}")
        for key, text in texts.items()
        if any(f"{{{name}}}" in text for name in named)
    }
    return {**source, **filled, **{k: v for k, v in given.items() if k not in named}}


def _combinations(lists: Mapping[str, Any]) -> list[dict[str, Any]]:
    values = [each if isinstance(each, list) else [each] for each in lists.values()]
    return [dict(zip(lists, each, strict=True)) for each in product(*values)]


def _formatted(text: str, given: Mapping[str, Any], what: str) -> str:
    try:
        return text.format(**given)
    except (KeyError, IndexError, ValueError) as error:
        raise UsageError(
            f"make.{what}={text!r} cannot be filled in ({error}): name parameters of make.source, "
            "such as {illumination}"
        ) from error


def _told(recorded: Recorded, pattern: str | None) -> Recorded:
    """Return a recording with what its name tells."""
    if not pattern:
        return recorded
    try:
        found = re.search(pattern, recorded.name)
    except re.error as error:
        raise UsageError(f"conditions.pattern={pattern!r} is no pattern: {error}") from error
    told = {k: v for k, v in (found.groupdict() if found else {}).items() if v is not None}
    return replace(recorded, metadata={**told, **recorded.metadata})


def derived(metadata: Mapping[str, str], rules: Mapping[str, Any]) -> dict[str, str]:
    """Return metadata with what follows from it.

    Parameters
    ----------
    metadata : mapping of str to str
    rules : mapping
        By the name of what follows: a mapping of one other name to a table of its values, such as
        ``{season: {run: {1: spring, 3: autumn}}}``.

    Raises
    ------
    UsageError
        If a rule is none, or its table lacks a value.
    """
    found = dict(metadata)
    for name, rule in rules.items():
        if not isinstance(rule, Mapping) or len(rule) != 1:
            raise UsageError(f"conditions.derive.{name} must name one other condition and a table")
        [(known, table)] = rule.items()
        if known not in found:
            continue  # said where a rule for pairs asks for it
        values = {str(key): str(value) for key, value in table.items()}
        if found[known] not in values:
            raise UsageError(
                f"conditions.derive.{name} says nothing of {known} '{found[known]}'; "
                f"{choices(found[known], values)}"
            )
        found[name] = values[found[known]]
    return found


def check_names(names: Sequence[str], known: Sequence[str], what: str) -> None:
    """Raise UsageError where a name is none of those known."""
    for name in names:
        if name not in known:
            raise UsageError(f"{what} names a recording '{name}'; {choices(name, known)}")
