"""Paths that stand by themselves on the command line, and the format of what is to be read."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from placecue.commands.names import LIVE, MODEL, OUT, PATHS, WHERE
from placecue.errors import DataError, UsageError

if TYPE_CHECKING:
    from placecue.components.registry import Registry

#: Options of Hydra that take the next word.
TAKES_ONE = ("--cfg", "-c", "--info", "-i", "--package", "-p", "--config-name", "-cn",
             "--config-path", "-cp", "--config-dir", "-cd", "--experimental-rerun")  # fmt: skip
#: With these nothing is read.
SILENT = frozenset(("--cfg", "-c", "--info", "-i", "--hydra-help", "-sc"))
#: How many logs are named.
TOLD = 5
KEY = re.compile(r"[+~]{0,2}[\w@./:-]*=|~")
#: Paths that Hydra reads as they stand; all others are put in quotes.
PLAIN = re.compile(r"[A-Za-z/][\w./-]*[/.][\w./-]*")
#: Words that choose a source, or bring one.
CHOOSES = re.compile(r"\+{0,2}(source[=@]|source\.(path|plugin)=|(recipe|world|experiment)=)")
LISTED = re.compile(r"""'(?:\\.|[^'])*'|"(?:\\.|[^"])*"|[^,\[\]]+""")


def prepared(command: str, words: Sequence[str]) -> list[str]:
    """Return words with keys for paths and a source for logs, and tell what will be read.

    Raises
    ------
    UsageError
        See :func:`in_keys` and :func:`with_source`.
    """
    from placecue.components.manager import current_plugins

    found = in_keys(command, words)
    if command == LIVE:
        return found  # what is read is no file
    with suppress(*([UsageError] if command == "doctor" else [])):  # which tells it beside the rest
        found = with_source(found, current_plugins().registry)
    logs = logs_in(found)
    if logs and command in PATHS and not SILENT.intersection(words):
        source = next((w.partition("=")[2] for w in found if w.startswith("source=")), "")
        told = ", ".join(map(_described, logs[:TOLD])) + (", ..." if len(logs) > TOLD else "")
        print(f"progress: {command} {told}{f' ({source})' if source else ''}", file=sys.stderr)
    return found


def _described(log: Path) -> str:
    try:
        size = log.stat().st_size
    except (OSError, ValueError):
        return str(log)
    return f"{log}, {size / 1e6:.1f} MB" if log.is_file() else str(log)


def in_keys(command: str, words: Sequence[str]) -> list[str]:
    """Return words of which paths that stand by themselves have been given their keys.

    Parameters
    ----------
    command : str
        Says what its paths are: :data:`placecue.commands.names.PATHS`.
    words : sequence of str
        What stands after it.

    Raises
    ------
    UsageError
        If there are more than it takes, or one is given twice.
    """
    words = ["json=true" if word == "--json" else word for word in words]
    alone = _alone(words)
    if not alone:
        return list(words)
    taken = set(alone)
    others = [word for number, word in enumerate(words) if number not in taken]
    paths = [words[number] for number in alone]
    given = _given(command, paths, {word.partition("=")[0] for word in others})
    return [*(f"{key}={_value(values)}" for key, values in given.items()), *others]


def _alone(words: Sequence[str]) -> list[int]:
    """Return the places of words that are neither options nor overrides."""
    return [
        number
        for number, word in enumerate(words)
        if not word.startswith("-")
        and not (number and words[number - 1] in TAKES_ONE)
        and (not KEY.match(word) or (word[:1] in "./" and Path(word).exists()))
    ]


def _given(command: str, paths: list[str], keys: set[str]) -> dict[str, list[str]]:
    takes = PATHS.get(command)
    if takes is None:
        raise UsageError(f"{command}: '{paths[0]}' is no key=value, and {command} takes no paths")
    given: dict[str, list[str]] = {}
    read_elsewhere = "source" in keys and not Path(paths[-1]).exists()
    least = 1 if takes == (OUT,) or read_elsewhere else 2
    if OUT in takes and OUT not in keys and len(paths) >= least:
        given[OUT] = [paths.pop()]
    if MODEL in takes and MODEL not in keys:
        models = [path for path in paths if is_model(Path(path))]
        if len(models) == 1:
            given[MODEL] = models
            paths = [path for path in paths if path not in models]
    key = takes[0]
    if paths and (key in keys or key == OUT):
        raise UsageError(
            f"{command}: {paths[0]} stands beside {key}=, which says the same: give one of them"
        )
    if paths:
        given[key] = [each for path in paths for each in _split(command, path)]
    return given


def _split(command: str, path: str) -> list[str]:
    """Return the MCAP files of a recording that ROS 2 has split; else the path itself."""
    if command in (LIVE, WHERE):
        return [path]
    folder = Path(path).expanduser()
    if not folder.exists() and not re.search(r"[./]", path):
        raise UsageError(f"{command}: '{path}' is neither key=value nor a file that is there")
    if not folder.exists():
        raise DataError(f"no such log: {path}")
    if not (folder / "metadata.yaml").is_file():
        return [path]
    return [str(file) for file in sorted(folder.glob("*.mcap"), key=_natural)] or [path]


def _natural(path: Path) -> list[tuple[int, str]]:
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]


def is_model(folder: Path) -> bool:
    """Tell whether a folder is a model's."""
    try:
        told = json.loads((folder / "manifest.json").read_text("utf-8"))
        return bool(told["format"] == "placecue/model")
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return False


def _value(paths: Sequence[str]) -> str:
    quoted = [path if PLAIN.fullmatch(path) else _quoted(path) for path in paths]
    return quoted[0] if len(quoted) == 1 else f"[{','.join(quoted)}]"


def _quoted(path: str) -> str:
    """Return a path between quotes, as Hydra reads it."""
    inner = re.sub(r"(\\*)'", r"\1\1\\'", path)
    doubled = re.sub(r"(\\+)$", r"\1\1", inner)
    return f"'{doubled}'"


def logs_in(words: Iterable[str]) -> list[Path]:
    """Return the paths that ``log=`` names: one, a list, or those of a sweep."""
    for word in words:
        key, _, value = word.partition("=")
        if key == "log":
            listed = (match.strip() for match in LISTED.findall(value))
            plain = (_unquoted(each) for each in listed)
            return [Path(each).expanduser() for each in plain if each not in ("", "null")]
    return []


def _unquoted(text: str) -> str:
    if len(text) > 1 and text[0] == text[-1] and text[0] in "'\"":
        return re.sub(r"\\(['\"\\])", r"\1", text[1:-1])
    return text


def with_source(words: Sequence[str], registry: Registry) -> list[str]:
    """Return words that also say which source reads ``log=``, where nothing says it yet.

    Raises
    ------
    UsageError
        If no source knows what is there, or the logs are of several formats.
    """
    logs = logs_in(words)
    if not logs or any(CHOOSES.match(word) for word in words):
        return list(words)
    from placecue.components.formats import source_of_all

    source = source_of_all(logs, registry)
    return list(words) if source is None else [f"source={source}", *words]
