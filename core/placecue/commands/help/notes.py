"""What the YAML files of the configs say of their keys, in the comments above them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

import yaml

_INNER = re.compile(r"  (?P<key>\w+): (?P<value>.*)")
_KEY = re.compile(r"(?P<key>[\w]+):(?: |$)(?P<value>.*)")
_PACKAGE = re.compile(r"# @package (\S+)")


@dataclass(slots=True)
class Note:
    """Keys that stand together, and what is said of them.

    Parameters
    ----------
    keys : list of str
        One, or several that a comment is for.
    values : list of str
        Their defaults, as written.
    text : str
        The comment in one line; empty where there is none.
    """

    keys: list[str]
    values: list[str]
    text: str = ""


@dataclass(slots=True)
class Option:
    """A YAML file of a config.

    Parameters
    ----------
    title : str
        The first comment.
    package : str
        Where its keys go: ``_global_``, a key, or empty where its group says it.
    notes : list of Note
        Its keys, in its order.
    defaults : list
        Which options it is made of.
    """

    title: str = ""
    package: str = ""
    notes: list[Note] = field(default_factory=list)
    defaults: list[Any] = field(default_factory=list)


def find(path: str, roots: list[str]) -> Option | None:
    """Return an option file, ``GROUP/NAME``; None where no config path holds it.

    Parameters
    ----------
    path : str
        Without its end.
    roots : list of str
        Config paths, such as ``pkg://placecue_conf``.
    """
    for root in roots:
        try:
            file = folder_of(root).joinpath(f"{path}.yaml")
            if file.is_file():
                return read(file.read_text("utf-8"))
        except (ModuleNotFoundError, TypeError, OSError):
            continue  # a plugin names a path that is not there, which is told when it is used
    return None


def folder_of(root: str) -> Traversable:
    """Return the folder that a ``pkg://`` config path names."""
    return files(root.removeprefix("pkg://").replace("/", "."))


def names_in(group: str, roots: list[str]) -> set[str]:
    """Return the options of a group that lie as files in config paths."""
    found: set[str] = set()
    for root in roots:
        try:
            entries = list(folder_of(root).joinpath(group).iterdir())
        except (ModuleNotFoundError, TypeError, OSError):
            continue
        found |= {e.name.removesuffix(".yaml") for e in entries if e.name.endswith(".yaml")}
    return found


def read(text: str) -> Option:
    """Return what a YAML file says of its keys at the top."""
    option, comment = Option(), list[str]()
    for line in text.splitlines():
        package, key = _PACKAGE.match(line), _KEY.match(line)
        if package:
            option.package = package[1]
        elif line.startswith("#"):
            comment.append(line.lstrip("# "))
        elif key and key["key"] in ("defaults", "hydra"):
            option.title, comment = option.title or " ".join(comment), []
        elif key:
            if not option.title and not option.notes and key["key"] == "plugin":
                option.title, comment = " ".join(comment), []
            _take(option, key["key"], key["value"], " ".join(comment))
            comment = []
        elif (inner := _INNER.match(line)) and option.notes and not option.notes[-1].values[-1]:
            option.notes[-1].keys[-1] += f".{inner['key']}"  # the one key of a mapping
            option.notes[-1].values[-1] = inner["value"]
        elif not line.strip() and not option.title:
            option.title, comment = " ".join(comment), []
    option.title = option.title or " ".join(comment)
    loaded = yaml.safe_load(text)
    option.defaults = loaded.get("defaults", []) if isinstance(loaded, dict) else []
    return option


def _take(option: Option, key: str, value: str, comment: str) -> None:
    """Add a key; one without a comment belongs to that of the key before."""
    if key in ("plugin", "name"):
        return
    last = option.notes[-1] if option.notes else None
    if comment or last is None:
        option.notes.append(Note([key], [value], comment))
    else:
        last.keys.append(key)
        last.values.append(value)
