"""Where the robot was, kept beside the keyframes so that it moves with them."""

from __future__ import annotations

from array import array
from math import hypot

import numpy as np
from numpy.typing import NDArray

from placecue.slam.planar import Array, compose

#: A robot that moved less than this, m and rad, since it was noted last is not noted again.
STEP, STEP_TURN = 0.01, 0.005


class Trajectory:
    """Moments of the way, each as it is seen from a keyframe; a standing robot adds none."""

    def __init__(self) -> None:
        self._stamps = array("q")
        self._keyframes = array("l")
        self._seen = array("d")
        self._last: tuple[int, Array] | None = None

    def __len__(self) -> int:
        return len(self._stamps)

    def add(self, stamp: int, keyframe: int, seen: Array) -> None:
        """Note where the robot is.

        Parameters
        ----------
        stamp : int
            ns.
        keyframe : int
            The one that the robot was at last.
        seen : ndarray, shape (3,)
            The robot's pose, seen from there.
        """
        if self._last is not None and self._last[0] == keyframe:
            step = seen - self._last[1]
            if hypot(step[0], step[1]) < STEP and abs(step[2]) < STEP_TURN:
                return
        self._last = keyframe, seen
        self._stamps.append(stamp)
        self._keyframes.append(keyframe)
        self._seen.extend(seen.tolist())

    def bases(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return when the robot came to another keyframe, ns, and to which; two arrays (k,)."""
        keyframes = np.array(self._keyframes, dtype=np.int64)
        first = np.flatnonzero(np.diff(keyframes, prepend=-1))
        return self.stamps()[first], keyframes[first]

    def stamps(self) -> NDArray[np.int64]:
        """Return the times, ns, shape (n,)."""
        return np.array(self._stamps, dtype=np.int64)

    def poses(self, keyframes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the poses, shape (n, 3).

        Parameters
        ----------
        keyframes : ndarray, shape (k, 3)
            Poses of the keyframes as they are known now.
        """
        seen = np.array(self._seen).reshape(-1, 3)
        made = [compose(keyframes[k], s) for k, s in zip(self._keyframes, seen, strict=True)]
        return np.array(made).reshape(-1, 3)


def tum(stamps: NDArray[np.int64], poses: NDArray[np.float64]) -> str:
    """Return a trajectory as text in the TUM format, which evo reads.

    A line a pose: time in s, x, y and z in m, and the quaternion x, y, z, w.

    Parameters
    ----------
    stamps : ndarray of int64, shape (n,)
        ns.
    poses : ndarray, shape (n, 3)
        x, y, heading.

    References
    ----------
    Sturm, Engelhard, Endres, Burgard, Cremers, A benchmark for the evaluation of RGB-D SLAM
    systems, IROS 2012.
    """
    lines = []
    for stamp, (x, y, theta) in zip(stamps.tolist(), poses.tolist(), strict=True):
        seconds = f"{stamp // 10**9}.{stamp % 10**9:09d}"
        z, w = np.sin(theta / 2), np.cos(theta / 2)
        lines.append(f"{seconds} {x:.6f} {y:.6f} 0 0 0 {z:.9f} {w:.9f}\n")
    return "".join(lines)
