"""What scans are laid on: where the robot was last, and the old map there."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import hypot

import numpy as np
from numpy.typing import NDArray

from placecue.slam.cloud import Points
from placecue.slam.keyframes import Keyframe, beside, joined
from placecue.slam.likelihood import Field
from placecue.slam.matching import Target
from placecue.slam.planar import Array, between

#: Scans are laid on so many keyframes that the robot was at last, and on so many before and after
#: those that it has been found to be back at.
LOCAL, AROUND = 10, 3


class LocalMap:
    """Some keyframes, joined.

    Attributes
    ----------
    numbers : list of int
        Which keyframes.
    points : ndarray, shape (n, 2)
        Their end points, m.
    """

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self._last: deque[int] = deque(maxlen=LOCAL)
        self._back: dict[int, int] = {}  # keyframes, and which earlier ones they are back at
        self.points: Points = np.empty((0, 2))
        self._target: Target | None = None
        self._field: Field | None = None

    @property
    def target(self) -> Target:
        """The end points, to lay scans on; made when it is first asked for."""
        if self._target is None:
            self._target = Target(self.points)
        return self._target

    @property
    def field(self) -> Field:
        """Distances from the end points, made when it is first asked for."""
        if self._field is None:
            self._field = Field(self.points)
        return self._field

    def is_at(self, number: int) -> None:
        """Say that the robot is at a keyframe now."""
        if number in self._last:
            self._last.remove(number)
        self._last.append(number)

    def is_back(self, later: int, earlier: int) -> None:
        """Say that a keyframe lies where an earlier one, or the same one earlier, was made."""
        self._back[later] = earlier

    def forget(self) -> None:
        """Forget where the robot was: it is lost."""
        self._last.clear()

    def gather(self, keyframes: Sequence[Keyframe], poses: NDArray[np.float64]) -> None:
        """Join the keyframes at the poses of now."""
        near = set(self._last)
        for number in self._last:
            if number in self._back:
                near |= set(beside(keyframes, poses, self._back[number], AROUND, AROUND))
        self.numbers = sorted(near)
        self.points = joined(keyframes, poses, self.numbers)
        self._target = self._field = None

    def nearest(
        self, poses: NDArray[np.float64], pose: Array, away: float, turned: float
    ) -> int | None:
        """Return the keyframe nearest to a pose, seen from the same side; None if none is near.

        Parameters
        ----------
        poses : ndarray, shape (n, 3)
            Of all keyframes.
        pose : ndarray, shape (3,)
            Where the robot is.
        away, turned : float
            How far from it, m, and how differently turned, rad, the keyframe may be.
        """
        best, found = away, None
        for number in self.numbers:
            off = between(poses[number], pose)
            if hypot(off[0], off[1]) < best and abs(off[2]) < turned:
                best, found = hypot(off[0], off[1]), number
        return found
