"""Words of the command line that Hydra would read as something else than what was typed."""

from __future__ import annotations

import re

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import QuotedString
from hydra.errors import HydraException

#: The last part of keys whose values are paths,
PATHS = frozenset(
    {"out", "log", "path", "model", "labels", "rooms", "root", "folder", "plan", "map"}
)
#: and of those whose values name labels, or a file that does.
LABELS = frozenset({"label_map"})
LIST = re.compile(r"\[(?P<inside>.*)\]", re.DOTALL)


def as_typed(word: str) -> str:
    """Return an override that keeps a path, or a map of labels, as it was typed.

    Hydra reads ``out=2024_01_05`` as the number 20240105, and knows few letters: a path or a map
    with others is put in quotes, and so is one that it takes for a number.

    Parameters
    ----------
    word : str
        An override, such as ``out=2024_01_05``; what is none, or has another key, stays.
    """
    key, equals, value = word.partition("=")
    name = key.lstrip("+~").rpartition(".")[2]
    if not equals or not value or name not in PATHS | LABELS:
        return word
    inside = LIST.fullmatch(value)
    if name in LABELS:
        return word if _readable(word) else f"{key}={_quoted(value)}"
    if inside is not None and not set("[]{}\"'") & set(inside["inside"]):
        parts = inside["inside"].split(",")
        return f"{key}=[{','.join(_kept(key, part.strip()) for part in parts)}]"
    if not _readable(word):
        return f"{key}={_quoted(value)}"
    if any(each in value for each in "[]{}\"'()"):
        return word
    return f"{key}={','.join(_kept(key, part) for part in value.split(','))}"  # a sweep has several


def _kept(key: str, value: str) -> str:
    """Return a single value in quotes where Hydra would make a number or the like of it."""
    if value.lower() in ("", "null"):
        return value
    try:
        read = OverridesParser.create().parse_override(f"{key}={value}").value()
    except HydraException:
        return _quoted(value)
    return value if isinstance(read, str | QuotedString | dict | list) else _quoted(value)


def _readable(word: str) -> bool:
    try:
        OverridesParser.create().parse_override(word)
    except HydraException:
        return False
    return True


def _quoted(value: str) -> str:
    """Return a value between quotes; those inside it stay themselves.

    Before a quote, and before the closing one, every backslash counts twice.
    """
    inner = re.sub(r"(\\*)'", r"\1\1\\'", value)
    inner = re.sub(r"(\\+)$", r"\1\1", inner)
    return f"'{inner}'"
