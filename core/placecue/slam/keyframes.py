"""Moments of the way that the map is made of: each with its scan and its pose."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.observation import LaserScan
from placecue.slam.cloud import CELL, Points, thinned
from placecue.slam.planar import moved


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A moment that the map is made of.

    Parameters
    ----------
    stamp : int
        When, ns.
    way : float
        How far the robot had driven, m.
    cloud : ndarray of float32, shape (k, 2)
        End points of the scan in the robot's frame, m.
    scan : LaserScan
        The scan, its lengths in 32 bits.
    """

    stamp: int
    way: float
    cloud: NDArray[np.float32]
    scan: LaserScan


def small(scan: LaserScan) -> LaserScan:
    """Return a scan whose lengths take 32 bits each, which is finer than any scanner."""
    ranges: Any = np.asarray(scan.ranges, dtype=np.float32)
    return LaserScan(scan.angles, ranges, scan.range_min, scan.range_max, scan.mount)


def joined(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    numbers: Iterable[int],
    cell: float = CELL,
) -> Points:
    """Return the end points of some keyframes in the map, thinned, m, shape (n, 2).

    Parameters
    ----------
    keyframes : sequence of Keyframe
        All.
    poses : ndarray, shape (len(keyframes), 3)
        Their poses.
    numbers : iterable of int
        Which to join.
    cell : float
        One point a cell of this side is kept, m.
    """
    clouds = [moved(keyframes[n].cloud.astype(np.float64), poses[n]) for n in numbers]
    return thinned(np.vstack(clouds), cell)
