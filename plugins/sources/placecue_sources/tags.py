"""Conditions of a recording, as the names of its folders and files tell them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

#: How many names at the end of a path are looked at.
DEPTH = 4
ILLUMINATION = re.compile(
    r"(?P<illumination>cloudy|night|sunny)_?(?P<run>[a-z]?\d+|[a-z](?![a-z]))?"
)


def tags(path: str, patterns: Sequence[re.Pattern[str]]) -> dict[str, str]:
    """Return what the named groups of patterns find in the last names of a path.

    Parameters
    ----------
    path : str
        A file or folder, such as ``COLD/freiburg/seq1_cloudy2.tar``.
    patterns : sequence of compiled patterns
        Searched in small letters; a name further down the path has the last word.
    """
    found: dict[str, str] = {}
    for name in Path(path).expanduser().absolute().parts[-DEPTH:]:
        for pattern in patterns:
            match = pattern.search(name.lower())
            if match:
                found.update({key: value for key, value in match.groupdict().items() if value})
    return found


def stem(path: str) -> str:
    """Return the name of a recording: its folder, or its tar without what says so."""
    return re.sub(r"\.(tar|tgz|tbz2?|txz)(\.\w+)?$", "", Path(path).expanduser().absolute().name)


def conditions(
    dataset: str, path: str, patterns: Sequence[re.Pattern[str]], given: Mapping[str, str] | None
) -> dict[str, str]:
    """Return the metadata of a recording: data set, sequence, what names tell, what was given."""
    found = {"dataset": dataset, "sequence": stem(path), **tags(path, patterns)}
    return {**found, **{key: str(value) for key, value in (given or {}).items()}}
