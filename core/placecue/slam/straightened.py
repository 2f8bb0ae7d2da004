"""A source whose poses are corrected by its scans, in one pass."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterator

from placecue.observation import Observation, Part
from placecue.slam.mapper import Mapper
from placecue.source import Chain, Guarded, Source, Wrapped

log = logging.getLogger(__name__)

#: What poses are corrected by.
SEEN: tuple[Part, ...] = ("scan", "pose")
#: Goes up when the same log gives other poses.
VERSION = 2


class Straightened(Wrapped):
    """A source whose observations stand where scans, odometry and loops say.

    An observation after which earlier poses are known better carries the
    :class:`~placecue.correction.Correction`. An observation without pose and scan before the first
    scan stays as it is.

    Parameters
    ----------
    source : Source
        Where observations come from; its poses serve as odometry.
    frame : str
        What the frame of the corrected poses is called.

    Attributes
    ----------
    mapper : Mapper
        Of the last time that the source was read.
    """

    def __init__(self, source: Source, frame: str = "map") -> None:
        super().__init__(source)
        self.frame = frame
        self.mapper = Mapper(frame)

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations at corrected poses."""
        mapper = self.mapper = Mapper(self.frame)
        for observation in self.source:
            placed = any(map(observation.has, SEEN)) or mapper.keyframes
            yield observation.placed(*mapper.follow(observation)) if placed else observation
        if mapper.keyframes:
            log.info(f"{self.name}: {mapper.account.told()}")
        else:
            log.warning(
                f"{self.name}: no scan shows enough to correct poses by; they are the log's own"
            )

    def digest(self) -> str:
        """Return a digest of the source and of what corrects it."""
        told = f"{self.source.digest()} slam {VERSION} {self.frame}"
        return hashlib.sha256(told.encode()).hexdigest()


def frames_of(logs: int) -> list[str]:
    """Return a frame for each of some logs: their maps have nothing to do with one another."""
    return ["map"] if logs == 1 else [f"map_{number}" for number in range(logs)]


def straightened_in(source: Source) -> list[Straightened]:
    """Return what corrects the poses of each log of a source, where something does."""
    if isinstance(source, Straightened):
        return [source]
    if isinstance(source, Chain):
        return [found for each in source.sources for found in straightened_in(each)]
    return straightened_in(source.source) if isinstance(source, (Guarded, Wrapped)) else []
