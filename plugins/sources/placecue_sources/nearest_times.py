"""Files of two folders whose names are times, paired by the nearest."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable, Sequence

from placecue.errors import DataError
from placecue_sources.stamps import nanoseconds

#: How far two files may be apart to belong together, ns: what the tool ``associate.py`` of the
#: data set takes (Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012).
APART = 20_000_000
TIME = re.compile(r"\d{1,10}\.\d+")


def are_times(names: Iterable[str]) -> bool:
    """Tell whether names of files, without their endings, are times in seconds."""
    return all(TIME.fullmatch(name) for name in names)


def paired(
    images: Sequence[str], depths: Sequence[str], where: str
) -> list[tuple[int, str | None, str | None]]:
    """Return stamp (ns), image and depth image of each frame, in order of time.

    The nearest of all go together first; what has no partner near enough is a frame of its own.
    A frame has the time of its image, where there is one.

    Parameters
    ----------
    images, depths : sequence of str
        Times in seconds, as the files are called.
    where : str
        Name of the data set, for messages.

    Raises
    ------
    DataError
        If no two are near enough.
    """
    times = sorted((nanoseconds(name), name) for name in images)
    others = sorted((nanoseconds(name), name) for name in depths)
    partner = dict(_nearest_first(times, others))
    if not partner:
        raise DataError(
            f"{where}: no depth image lies within {APART * 1e-9:g} s of a colour image, by the "
            f"times that are their names ({times[0][1]} and {others[0][1]} are the first)"
        )
    taken = set(partner.values())
    frames = [(stamp, name, partner.get(name)) for stamp, name in times]
    alone = [(stamp, None, name) for stamp, name in others if name not in taken]
    return sorted([*frames, *alone], key=lambda frame: frame[0])


def _nearest_first(
    times: Sequence[tuple[int, str]], others: Sequence[tuple[int, str]]
) -> list[tuple[str, str]]:
    candidates = []
    for stamp, name in times:
        first = bisect_left(others, (stamp - APART, ""))
        for other, depth in others[first:]:
            if other > stamp + APART:
                break
            candidates.append((abs(other - stamp), name, depth))
    taken: set[str] = set()
    found = []
    for _, name, depth in sorted(candidates):
        if taken.isdisjoint((f"image {name}", f"depth {depth}")):
            taken |= {f"image {name}", f"depth {depth}"}
            found.append((name, depth))
    return found
