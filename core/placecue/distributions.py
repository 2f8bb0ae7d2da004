"""What is installed, as far as its records can be read.

One broken record (a ``.dist-info`` without a name, an ``entry_points.txt`` that does not parse)
makes ``importlib.metadata.entry_points`` fail for all.
"""

from __future__ import annotations

import re
from importlib.metadata import Distribution, EntryPoint, distributions
from typing import NamedTuple

from placecue.errors import told


class Broken(NamedTuple):
    """A distribution whose records cannot be read.

    Parameters
    ----------
    where : str
        Its records.
    error : str
        What is wrong.
    """

    where: str
    error: str


def installed_entry_points(group: str) -> tuple[list[EntryPoint], list[Broken]]:
    """Return the entry points of a group, and the distributions that may hide some.

    Of two distributions of one name the first on the path that has any counts.

    Parameters
    ----------
    group : str
        Name of the group.
    """
    found: list[EntryPoint] = []
    broken: list[Broken] = []
    seen: set[str] = set()
    for distribution in distributions():
        try:
            name = _name(distribution)
            own = [each for each in distribution.entry_points if each.group == group]
        except Exception as error:  # parsers of what lies about may raise anything
            broken.append(Broken(_where(distribution), told(error)))
            continue
        if own and name not in seen:
            seen.add(name)
            found += own
    return found, broken


def _name(distribution: Distribution) -> str:
    name: str | None = distribution.metadata["Name"]
    if not name:
        raise ValueError("it has no name")
    return re.sub(r"[-_.]+", "-", name).lower()


def _where(distribution: Distribution) -> str:
    return str(getattr(distribution, "_path", "") or distribution.locate_file(""))
