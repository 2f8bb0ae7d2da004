"""Where a camera is silent: scans make the observations there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from placecue.logs.joining.timing import message_times
from placecue.logs.mcap.container import LogFile, Topic

#: A camera is silent where it leaves out so many images.
LEFT_OUT = 5


@dataclass(frozen=True, slots=True)
class Silence:
    """When a camera counts as silent.

    Parameters
    ----------
    after : int
        So long after its last image, ns.
    period : int
        How far apart its images are else, ns; observations of scans are no closer.
    """

    after: int
    period: int


def silence_of(file: LogFile, camera: Topic, least: float, start: int) -> Silence | None:
    """Return when a camera counts as silent; None if it never is.

    By log time, from the index of the messages; a file without one is read through.

    Parameters
    ----------
    file : LogFile
        The log.
    camera : Topic
        The images.
    least : float
        A camera is silent after so long, and five times the usual distance of its images, s.
    start : int
        When the log begins, by a clock that was set, ns.
    """
    stamps = _stamps(file, camera)
    silence = _usual(stamps, least)
    if not stamps:
        return silence
    steps = [after - before for before, after in pairwise(stamps)]
    longest = max(*steps, stamps[0] - start, file.contents.end - stamps[-1], 0)
    return silence if longest >= silence.after else None


def usual(file: LogFile, camera: Topic, least: float) -> Silence:
    """Return when a camera would count as silent; see :func:`silence_of`."""
    return _usual(_stamps(file, camera), least)


def _stamps(file: LogFile, camera: Topic) -> list[int]:
    channels = set(camera.channels)
    found = [t for times in message_times(file) for c, t in times.items() if c in channels]
    # Times in a damaged file may be larger than 64 bits with a sign hold.
    return sorted(each for times in found for each in times)


def _usual(stamps: Sequence[int], least: float) -> Silence:
    steps = [after - before for before, after in pairwise(stamps)]
    period = round(median(steps)) if steps else 0
    return Silence(max(round(least * 1e9), LEFT_OUT * period), period)
