"""Places that the robot comes back to: proposed by position, verified by their scans."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from placecue.slam.fusing import told
from placecue.slam.keyframes import Keyframe, joined
from placecue.slam.likelihood import Field
from placecue.slam.matching import NEIGHBOURS, Target
from placecue.slam.planar import Array, between, compose, moved

#: A place is come back to after so much way, m.
AWAY = 8.0
#: Poses are off by so much, m, and by so much more a metre of way since the last loop, at most, m.
REACH, DRIFT, FARTHEST = 1.0, 0.05, 6.0
#: The same of headings, rad.
TURN, TURN_DRIFT, WIDEST = 0.15, 0.005, 0.5
#: Keyframes before and after the earlier one, and before the later one, that are laid together.
AROUND, BEHIND = 5, 2
#: Side of a cell of them that holds one point, m.
CELL = 0.1
#: A loop needs this score of the search, and this share of points within so many metres of what
#: was seen before.
SCORE, SHARE, NEAR = 0.35, 0.6, 0.15
#: Best and worst that a loop knows, m, m, rad.
BEST, WORST = np.array([0.02, 0.02, 0.005]), np.array([5.0, 5.0, 1.0])
#: Two loops, so many keyframes apart at least and at most, must say the same, give or take so
#: much (m, m, rad) and so many standard deviations.
APART, TOGETHER, GIVE, AGREE = 2, 8, np.array([0.08, 0.08, 0.02]), 3.0
#: After a loop the next one is looked for after so much way, m.
REST = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """One keyframe as it is seen from an earlier one.

    Parameters
    ----------
    earlier, later : int
        The two.
    relative : ndarray, shape (3,)
        Pose of the later one in the axes of the earlier.
    covariance : ndarray, shape (3, 3)
        Of it, in the axes of the later.
    """

    earlier: int
    later: int
    relative: Array
    covariance: Array


class LoopFinder:
    """Looks for loops at each keyframe; gives those out that another one has confirmed."""

    def __init__(self) -> None:
        self._waiting: deque[Loop] = deque(maxlen=TOGETHER)
        self._closed = 0.0  # way when a loop was closed last
        self.tried = 0

    def find(self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64]) -> list[Loop]:
        """Return loops of the last keyframe, and of those before it that it confirms.

        Parameters
        ----------
        keyframes : sequence of Keyframe
            All so far.
        poses : ndarray, shape (len(keyframes), 3)
            Their poses.
        """
        since = keyframes[-1].way - self._closed
        if since < REST and not self._waiting:
            return []
        for earlier in _candidates(keyframes, poses, _reach(since)):
            self.tried += 1
            loop = verified(keyframes, poses, earlier, _reach(since), _turn(since))
            if loop is not None:
                return self._confirmed(loop, poses)
        return []

    def closed(self, way: float) -> None:
        """Say that a loop was closed when the robot had driven so far, m."""
        self._closed = way
        self._waiting.clear()

    def refused(self) -> None:
        """Say that what was found contradicts the rest; it confirms nothing any more."""
        self._waiting.clear()

    def _confirmed(self, loop: Loop, poses: NDArray[np.float64]) -> list[Loop]:
        agreeing = [each for each in self._waiting if agree(each, loop, poses)]
        self._waiting.append(loop)
        return [*agreeing, loop] if agreeing else []


def agree(one: Loop, other: Loop, poses: NDArray[np.float64]) -> bool:
    """Tell whether two loops, the earlier one first, say the same of where the robot is.

    Parameters
    ----------
    one, other : Loop
        Of keyframes that follow one another closely.
    poses : ndarray, shape (n, 3)
        The keyframes' poses; only how close ones lie to one another counts.

    References
    ----------
    Mangelson, Dominic, Eustice, Vasudevan, Pairwise consistent measurement set maximization for
    robust multi-robot map merging, ICRA 2018; here of two loops.
    """
    if not APART <= other.later - one.later <= TOGETHER:
        return False
    there = between(poses[other.earlier], poses[one.earlier])
    here = between(poses[one.later], poses[other.later])
    off = between(compose(compose(there, one.relative), here), other.relative)
    give = one.covariance + other.covariance + np.diag(GIVE**2)
    return bool(off @ np.linalg.solve(give, off) <= AGREE**2)


def verified(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    earlier: int,
    reach: float,
    turn: float,
) -> Loop | None:
    """Lay the last keyframe on what was seen around an earlier one; None where it does not fit.

    Parameters
    ----------
    keyframes : sequence of Keyframe
        All so far.
    poses : ndarray, shape (len(keyframes), 3)
        Their poses.
    earlier : int
        The one that the robot may have come back to.
    reach, turn : float
        How far off poses may be, m and rad.
    """
    later = len(keyframes) - 1
    around = range(max(0, earlier - AROUND), min(later, earlier + AROUND + 1))
    target = joined(keyframes, poses, around, CELL)
    behind = range(max(0, later - BEHIND), later + 1)
    seen = [between(poses[later], pose) for pose in poses[behind.start : behind.stop]]
    source = joined(keyframes[behind.start :], np.array(seen), range(len(seen)), CELL)
    if min(len(target), len(source)) < NEIGHBOURS:
        return None
    field = Field(target)
    found = field.search(source, poses[later], reach, turn)
    if found.score < SCORE:
        return None
    match = Target(target).match(source, found.pose)
    share = float((field.distances(moved(source, match.pose)) <= NEAR).mean())
    information, untold = told(match, len(source))
    if share < SHARE or untold > 1:
        return None
    covariance = np.linalg.inv(information + np.diag(WORST**-2)) + np.diag(BEST**2)
    return Loop(earlier, later, between(poses[earlier], match.pose), np.asarray(covariance))


def _candidates(
    keyframes: Sequence[Keyframe], poses: NDArray[np.float64], reach: float
) -> list[int]:
    """Return the nearest keyframe of each earlier visit within reach, the nearest two first."""
    ways = np.array([keyframe.way for keyframe in keyframes])
    away = np.hypot(*(poses[:, :2] - poses[-1, :2]).T)
    near = np.flatnonzero((away <= reach) & (ways[-1] - ways >= AWAY))
    if not len(near):
        return []
    visits = np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)
    best = [int(visit[away[visit].argmin()]) for visit in visits]
    return sorted(best, key=lambda number: float(away[number]))[:2]


def _reach(since: float) -> float:
    return min(REACH + DRIFT * since, FARTHEST)


def _turn(since: float) -> float:
    return min(TURN + TURN_DRIFT * since, WIDEST)
