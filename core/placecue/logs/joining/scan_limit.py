"""One limit of range for all scans of a topic, whatever each message states."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from placecue.observation import LaserScan

log = logging.getLogger(__name__)


class OneLimit:
    """Gives every scan the limit of the first one of its topic, so that filled beams are alike.

    A beam is judged by the limit that its own message states; what is beyond either is invalid.

    Parameters
    ----------
    range_max : float
        The limit of the first scan, m.
    place : callable
        Applied to each scan before: the mounting of the laser.
    where : str
        Log and topic, for messages.
    told : set of str
        Where it was told already that limits differ; a topic is told of once.
    """

    def __init__(
        self,
        range_max: float,
        place: Callable[[LaserScan, int], LaserScan],
        where: str,
        told: set[str],
    ) -> None:
        self.range_max = range_max
        self.place = place
        self.where = where
        self._told = told

    def __call__(self, scan: LaserScan, stamp: int) -> LaserScan:
        """Return a scan of a time as it sits on the robot, under the one limit."""
        placed = self.place(scan, stamp)
        if placed.range_max == self.range_max:
            return placed
        if self.where not in self._told:
            self._told.add(self.where)
            log.warning(
                f"{self.where}: the first scan counts up to {self.range_max:g} m, others up to "
                f"{placed.range_max:g} m and the like; beams that measured nothing count as "
                f"{self.range_max:g} m in all"
            )
        ranges = np.where(placed.valid(), placed.ranges, np.inf)
        return replace(placed, ranges=ranges, range_max=self.range_max)
