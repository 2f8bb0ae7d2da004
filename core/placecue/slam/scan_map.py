"""Keyframes with their scans and poses, and the loops between them."""

from __future__ import annotations

from array import array
from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from placecue.slam.account import Account
from placecue.slam.keyframes import Keyframe
from placecue.slam.local_map import LocalMap
from placecue.slam.loops import AWAY, LoopFinder
from placecue.slam.planar import Array, between, compose
from placecue.slam.pose_graph import PoseGraph
from placecue.slam.verifying import Loop

#: A keyframe is made after so much motion, m and rad, unless the map has one so near already.
SPACING, TURNING = 0.5, 0.35
#: A new piece of the map is tied to what is there by this, m, m, rad: nobody knows how far away it
#: is.
TIE = np.array([10.0, 10.0, 1.5])
#: A loop that says no more than this of what is known, m and rad, is left out of the graph.
KNOWN, KNOWN_TURN = 0.03, 0.01
#: The least that a pose may be off from the one before, m, m, rad.
FLOOR = np.array([0.003, 0.003, 0.001])


class ScanMap:
    """Grows by a keyframe where the robot has not been; where it has, it stays as it is.

    Parameters
    ----------
    account : Account
        Counts what is found.

    Attributes
    ----------
    keyframes : list of Keyframe
        What it is made of.
    base : int
        The keyframe that the robot was at last.
    local : LocalMap
        What scans are laid on.
    """

    def __init__(self, account: Account) -> None:
        self.keyframes: list[Keyframe] = []
        self.base = 0
        self.local = LocalMap()
        self._account = account
        self._graph: PoseGraph | None = None
        self._loops = LoopFinder()
        self._visits = array("d")  # way when the robot was at each last, m
        self._again: set[int] = set()  # those that it has been back at

    @property
    def poses(self) -> NDArray[np.float64]:
        """Poses of the keyframes as they are known now, shape (n, 3)."""
        return np.empty((0, 3)) if self._graph is None else self._graph.poses

    def uncertainty(self, number: int) -> Array:
        """Return the covariance of a keyframe's pose in its own axes, shape (3, 3)."""
        assert self._graph is not None
        return self._graph.uncertainty(number)

    def seen(self, pose: Array) -> Array:
        """Return a pose as it is seen from the keyframe that the robot was at last."""
        return between(self.poses[self.base], pose)

    def is_left_by(self, pose: Array) -> bool:
        """Tell whether a pose is another place than that keyframe's."""
        step = self.seen(pose)
        return bool(hypot(step[0], step[1]) >= SPACING or abs(step[2]) >= TURNING)

    def strayed(self, by: float) -> None:
        """Say that the robot may be off by so much more, m, as scans did not tell where it is."""
        self._loops.strayed(by)

    def add(self, keyframe: Keyframe, pose: Array, covariance: Array) -> Array:
        """Add a keyframe, and close the loops that are found there.

        Parameters
        ----------
        keyframe : Keyframe
            Of another ``piece`` than the one before where the robot was lost.
        pose : ndarray, shape (3,)
            Where it was made.
        covariance : ndarray, shape (3, 3)
            Of the pose as it is seen from the keyframe that the robot was at last.

        Returns
        -------
        ndarray, shape (3,)
            The pose as it is known then.
        """
        if self._graph is None:
            self._graph = PoseGraph(pose)
        else:
            if keyframe.piece != self.keyframes[-1].piece:
                covariance = covariance + np.diag(TIE**2)
                self._loops.strayed(inf)
            spread = covariance + np.diag(FLOOR**2)
            self._graph.add(pose, self.seen(pose), spread, self.base)
        self.keyframes.append(keyframe)
        self._visits.append(keyframe.way)
        self._loops.seen(self.keyframes, self.poses)
        self._go_on_from(len(self.keyframes) - 1, keyframe.way)
        visits = np.array(self._visits)
        return self._close(self._loops.find(self.keyframes, self.poses, visits), pose, keyframe.way)

    def back_at(self, pose: Array, way: float) -> Array | None:
        """Go on from a keyframe that is there already, seen from the same side.

        Parameters
        ----------
        pose : ndarray, shape (3,)
            Where the robot is.
        way : float
            How far it has driven, m.

        Returns
        -------
        ndarray, shape (3,), or None
            The pose as it is known then; None where there is no such keyframe.
        """
        found = self.local.nearest(self.poses, pose, SPACING, TURNING)
        if found is None:
            return None
        self._account.familiar += 1
        if way - self._visits[found] >= AWAY:
            self._loops.known(way)
        self.local.is_back(found, found)
        self._go_on_from(found, way)
        if found in self._again:
            return pose
        self._again.add(found)
        visits, near = np.array(self._visits), self.local.numbers
        loops = self._loops.find_again(self.keyframes, self.poses, visits, found, near)
        return self._close(loops, pose, way)

    def _go_on_from(self, number: int, way: float) -> None:
        self.base, self._visits[number] = number, way
        self.local.is_at(number)
        self.local.gather(self.keyframes, self.poses)

    def _close(self, found: list[Loop], pose: Array, way: float) -> Array:
        """Take in loops that were found where the robot is, and return where it is then."""
        seen = self.seen(pose)
        known = [loop for loop in found if self._is_known(loop)]
        closed = [loop for loop in found if loop not in known and self._closes(loop)]
        if not (known or closed):
            return pose
        for loop in (*known, *closed):
            self.local.is_back(loop.later, loop.earlier)
        self._account.confirmed += len(known)
        self._account.loops += len(closed)
        self._loops.closed(way)
        self.local.gather(self.keyframes, self.poses)
        return compose(self.poses[self.base], seen)

    def _is_known(self, loop: Loop) -> bool:
        """Tell whether a loop says what is known anyway: on old ground the graph stays small."""
        here = between(self.poses[loop.earlier], self.poses[loop.later])
        off = between(loop.relative, here)
        return bool(hypot(off[0], off[1]) <= KNOWN and abs(off[2]) <= KNOWN_TURN)

    def _closes(self, loop: Loop) -> bool:
        assert self._graph is not None
        kept = self._graph.close(loop.earlier, loop.later, loop.relative, loop.covariance)
        if not kept:
            self._account.refused += 1
            self._loops.refused()
        return kept
