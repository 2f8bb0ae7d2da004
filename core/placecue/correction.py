"""What is learned late of where the robot has been: a loop closed, and poses of before moved."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from placecue.observation import Pose2D


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """Poses as they were told, and as they are known now.

    It comes with the first observation after it, so whoever takes observations in order can move
    what it keeps before it goes on.

    Parameters
    ----------
    stamps : ndarray of int64, shape (n,)
        Times of some moments of the way, ns, increasing; one or more.
    before, after : ndarray of float64, shape (n, 3)
        x, y (m) and heading (rad) of the robot at these moments, as they were told last and as
        they are now.
    frame : str
        The frame of the poses; what is in another one stays where it is.
    """

    stamps: NDArray[np.int64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    frame: str = "map"

    def moved(self, stamp: int, pose: Pose2D) -> Pose2D:
        """Return where something is now that was seen at a time.

        It keeps its place beside the last of the moments before it, as if it stood on a rigid
        piece of the map.

        Parameters
        ----------
        stamp : int
            When it was put where it is, ns.
        pose : Pose2D
            Where it was put, by the pose as it was told.
        """
        if pose.frame != self.frame:
            return pose
        at = int(np.searchsorted(self.stamps, stamp, side="right")) - 1
        old, new = self.before[max(at, 0)].tolist(), self.after[max(at, 0)].tolist()
        turn = (new[2] - old[2] + pi) % (2 * pi) - pi
        dx, dy, c, s = pose.x - old[0], pose.y - old[1], cos(turn), sin(turn)
        x, y = new[0] + c * dx - s * dy, new[1] + s * dx + c * dy
        return Pose2D(x, y, pose.theta + turn, pose.frame)

    @property
    def farthest(self) -> float:
        """The largest distance that one of the moments moved, m."""
        return float(np.hypot(*(self.after - self.before)[:, :2].T).max())
