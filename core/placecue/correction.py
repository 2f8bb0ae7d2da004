"""What is learned late of where the robot has been: a loop closed, and poses of before moved."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray


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

    def moved(self, stamps: NDArray[np.int64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where things are now that were seen at some times.

        Each keeps its place beside the last of the moments before it, as if it stood on a rigid
        piece of the map.

        Parameters
        ----------
        stamps : ndarray of int64, shape (k,)
            When each was put where it is, ns.
        poses : ndarray of float64, shape (k, 3)
            Where it was put, by the pose as it was told: x, y (m) and heading (rad).
        """
        at = np.maximum(np.searchsorted(self.stamps, stamps, side="right") - 1, 0)
        old, new = self.before[at], self.after[at]
        turn = (new[:, 2] - old[:, 2] + pi) % (2 * pi) - pi
        (dx, dy), c, s = (poses - old)[:, :2].T, np.cos(turn), np.sin(turn)
        x, y = new[:, 0] + c * dx - s * dy, new[:, 1] + s * dx + c * dy
        return np.column_stack([x, y, poses[:, 2] + turn])
