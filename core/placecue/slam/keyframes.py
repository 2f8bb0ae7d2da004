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

#: Keyframes that follow one another hang together no farther apart than this, m.
BESIDE = 4.0


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
    piece : int
        How often the map had been begun anew.
    """

    stamp: int
    way: float
    cloud: NDArray[np.float32]
    scan: LaserScan
    piece: int = 0


def small(scan: LaserScan, before: LaserScan | None) -> LaserScan:
    """Return a scan that takes less memory.

    Its lengths take 32 bits each, which is finer than any scanner, and its angles are those of the
    scan ``before`` where they are the same.
    """
    ranges: Any = np.asarray(scan.ranges, dtype=np.float32)
    same = before is not None and np.array_equal(before.angles, scan.angles)
    angles = before.angles if before is not None and same else scan.angles
    return LaserScan(angles, ranges, scan.range_min, scan.range_max, scan.mount)


def beside(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    number: int,
    before: int,
    after: int,
) -> list[int]:
    """Return the keyframes just before and after one that were made near it, and itself.

    Parameters
    ----------
    keyframes : sequence of Keyframe
        All.
    poses : ndarray, shape (len(keyframes), 3)
        Their poses.
    number : int
        The one.
    before, after : int
        How many of either side to look at.
    """
    some = np.arange(max(0, number - before), min(len(keyframes), number + after + 1))
    near = np.hypot(*(poses[some, :2] - poses[number, :2]).T) <= BESIDE
    piece = keyframes[number].piece
    return [n for n in some[near].tolist() if keyframes[n].piece == piece]


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
