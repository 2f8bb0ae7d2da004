"""Places that the robot comes back to: proposed by position or likeness, verified by scans."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import inf, isinf

import numpy as np
from numpy.typing import NDArray

from placecue.slam.keyframes import Keyframe
from placecue.slam.likeness import SIZE, likeness, signature_of
from placecue.slam.planar import Array, between, compose
from placecue.slam.verifying import BY_LIKENESS, BY_POSITION, Loop, recognised, seen_till, verified

#: A place is come back to after so much way, m, or where the map has been begun anew since.
AWAY = 8.0
#: Poses are off by so much, m, and by so much more a metre of way since the last loop, at most.
#: Places are proposed by position up to this far away, m.
REACH, DRIFT, FARTHEST = 1.0, 0.05, 6.0
#: They are proposed by likeness where poses may be off by more: scans that told where they lie
#: err by so much a metre.
TOLD = 0.02
#: The same of headings, rad.
TURN, TURN_DRIFT, WIDEST = 0.15, 0.005, 0.5
#: A signature is of so many keyframes; so many of the likest places are tried, if they are as
#: alike as this.
TOGETHER_SEEN, TRIES, ALIKE = 6, 3, 0.9
#: Two places are one where they put the robot no farther apart than this, m, rad; of two others
#: one must fit this much of the points better.
SAME, SAME_TURN, CLEAR = 0.5, 0.2, 0.1
#: Two loops, so many keyframes apart at least, or one and so many at the earlier place, and so many
#: at most, must say the same, give or take so much (m, m, rad) and so many standard deviations.
APART, THERE, TOGETHER, GIVE, AGREE = 2, 3, 8, np.array([0.08, 0.08, 0.02]), 3.0
#: After a loop the next one is looked for after so much way, m.
REST = 1.0


class LoopFinder:
    """Looks for loops at each keyframe; gives those out that another one has confirmed."""

    def __init__(self) -> None:
        self._waiting: deque[Loop] = deque(maxlen=TOGETHER)
        self._closed = 0.0  # way when a loop was closed last
        self._strayed = 0.0  # m that poses may be off beside what they drift
        self._signatures = bytearray()  # of all keyframes

    def find(
        self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64], visits: Array
    ) -> list[Loop]:
        """Return loops of the last keyframe, and of those before it that it confirms.

        Parameters
        ----------
        keyframes : sequence of Keyframe
            All so far.
        poses : ndarray, shape (len(keyframes), 3)
            Their poses.
        visits : ndarray, shape (len(keyframes),)
            How far the robot had driven when it was there last, m.
        """
        since = keyframes[-1].way - self._closed
        if since < REST and not self._waiting:
            return []
        last, old = len(poses) - 1, _left(keyframes, visits, -1)
        # Where the robot may have been carried position says little.
        bar = BY_LIKENESS if isinf(self._strayed) else BY_POSITION
        for earlier in _candidates(old, poses, last, _reach(since)):
            loop = verified(keyframes, poses, earlier, last, _reach(since), _turn(since), bar)
            if loop is not None:
                return self._confirmed(loop, poses)
        off = REACH + TOLD * since + self._strayed
        found = self._recognised(keyframes, poses, old, off) if off > FARTHEST else None
        return [] if found is None else self._confirmed(found, poses)

    def find_again(
        self,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        visits: Array,
        number: int,
        known: Sequence[int],
    ) -> list[Loop]:
        """Return loops of a keyframe that the robot is back at, with others than those known.

        Two visits of one place may not have been joined, as the one or the other was off too far.
        """
        old = _left(keyframes, visits, number)
        old[list(known)] = False
        for other in _candidates(old, poses, number, REACH):
            loop = verified(keyframes, poses, other, number, REACH, TURN)
            if loop is not None:
                return self._confirmed(loop, poses)
        return []

    def seen(self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64]) -> None:
        """Note what the last keyframe looks like."""
        signature = signature_of(seen_till(keyframes, poses, len(poses) - 1, TOGETHER_SEEN))
        self._signatures.extend(signature.tobytes())

    def strayed(self, by: float) -> None:
        """Say that poses may be off by so much more, m: infinity for a robot that is lost."""
        self._strayed += by

    def closed(self, way: float) -> None:
        """Say that a loop was closed when the robot had driven so far, m."""
        self.known(way)
        self._waiting.clear()

    def known(self, way: float) -> None:
        """Say that the robot was on known ground when it had driven so far, m."""
        self._closed, self._strayed = way, 0.0

    def refused(self) -> None:
        """Say that what was found contradicts the rest; it confirms nothing any more."""
        self._waiting.clear()

    def _confirmed(self, loop: Loop, poses: NDArray[np.float64]) -> list[Loop]:
        agreeing = [each for each in self._waiting if agree(each, loop, poses)]
        self._waiting.append(loop)
        return [*agreeing, loop] if agreeing else []

    def _recognised(
        self,
        keyframes: Sequence[Keyframe],
        poses: NDArray[np.float64],
        old: NDArray[np.bool_],
        off: float,
    ) -> Loop | None:
        """Return a loop with the one place that looks the same; None where two might be it."""
        tried = [recognised(keyframes, poses, n) for n in self._likest(poses, old, off)]
        found = sorted((loop for loop in tried if loop is not None), key=lambda each: -each.share)
        for other in found[1:]:
            if other.share > found[0].share - CLEAR and not _same(found[0], other, poses):
                return None
        return found[0] if found else None

    def _likest(self, poses: NDArray[np.float64], old: NDArray[np.bool_], off: float) -> list[int]:
        """Return the keyframes within reach that look most alike, one of each visit."""
        away = np.hypot(*(poses[:, :2] - poses[-1, :2]).T)
        known = np.frombuffer(self._signatures, dtype=np.uint8).reshape(-1, SIZE)
        alike = likeness(known[-1], known)
        alike[(away > off) | ~old | (alike < ALIKE)] = -inf
        best: list[int] = []
        while len(best) < TRIES and np.isfinite(alike.max()):
            best.append(int(alike.argmax()))
            alike[np.abs(np.arange(len(alike)) - best[-1]) <= TOGETHER] = -inf
        return best


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
    here_apart, there_apart = abs(other.later - one.later), abs(other.earlier - one.earlier)
    apart = here_apart >= APART or (here_apart and there_apart >= THERE)
    if not apart or here_apart > TOGETHER:
        return False
    there = between(poses[other.earlier], poses[one.earlier])
    here = between(poses[one.later], poses[other.later])
    off = between(compose(compose(there, one.relative), here), other.relative)
    give = one.covariance + other.covariance + np.diag(GIVE**2)
    return bool(off @ np.linalg.solve(give, off) <= AGREE**2)


def _same(one: Loop, other: Loop, poses: NDArray[np.float64]) -> bool:
    """Tell whether two loops of one keyframe put it at the same place."""
    there = compose(poses[one.earlier], one.relative)
    off = between(there, compose(poses[other.earlier], other.relative))
    return bool(np.hypot(off[0], off[1]) <= SAME and abs(off[2]) <= SAME_TURN)


def _left(keyframes: Sequence[Keyframe], visits: Array, number: int) -> NDArray[np.bool_]:
    """Return which keyframes the robot was at long before one, or before it was lost."""
    pieces = np.array([keyframe.piece for keyframe in keyframes])
    return np.asarray((visits[number] - visits >= AWAY) | (pieces != pieces[number]))


def _candidates(
    old: NDArray[np.bool_], poses: NDArray[np.float64], number: int, reach: float
) -> list[int]:
    """Return the nearest keyframe of each earlier visit within reach, the nearest two first."""
    away = np.hypot(*(poses[:, :2] - poses[number, :2]).T)
    near = np.flatnonzero((away <= reach) & old)
    if not len(near):
        return []
    visits = np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)
    best = [int(visit[away[visit].argmin()]) for visit in visits]
    return sorted(best, key=lambda number: float(away[number]))[:2]


def _reach(since: float) -> float:
    return min(REACH + DRIFT * since, FARTHEST)


def _turn(since: float) -> float:
    return min(TURN + TURN_DRIFT * since, WIDEST)
