"""What is expected of the next pose: by odometry, else that the robot goes on as it did."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite

import numpy as np

from placecue.observation import Pose2D
from placecue.slam.planar import Array, array_of, between

#: Faster than this no indoor robot drives or turns, m/s and rad/s: poses that do have jumped.
FASTEST, FASTEST_TURN = 3.0, 4.0
#: Stamps may be wrong by so much, s, where a log's lines come in bursts.
JITTER = 0.25
#: Odometry errs by a share of the way and of the turn, by so much heading a metre (rad/m), and by
#: a little anyway (m, rad).
WAY, TURN, VEER, LEAST, LEAST_TURN = 0.08, 0.08, 0.04, 0.003, 0.002
#: A robot without odometry goes otherwise than it did by so much, m/s and rad/s.
CHANGE, CHANGE_TURN = 0.5, 0.6
#: So long, s, it is taken to go on as it did.
LONGEST_GUESS = 1.0


@dataclass(frozen=True, slots=True)
class Step:
    """What is expected of the motion since the moment before.

    Parameters
    ----------
    motion : ndarray, shape (3,)
        The next pose, seen from the one before.
    covariance : ndarray, shape (3, 3)
        Of it, in the axes of the next pose.
    measured : bool
        Whether odometry says so.
    jumped : bool
        Whether odometry said what cannot be.
    """

    motion: Array
    covariance: Array
    measured: bool
    jumped: bool = False


class Motion:
    """Follows odometry, and how fast the robot has been."""

    def __init__(self) -> None:
        self._pose: Pose2D | None = None
        self._stamp = 0
        self._speed = np.zeros(3)

    def step(self, pose: Pose2D | None, stamp: int) -> Step:
        """Return what is expected of the motion from the moment before to this one.

        Parameters
        ----------
        pose : Pose2D or None
            Odometry; None, or one that is not finite, where there is none.
        stamp : int
            ns, after the one before.
        """
        if pose is not None and not all(map(isfinite, (pose.x, pose.y, pose.theta))):
            pose = None
        before, seconds = self._pose, max((stamp - self._stamp) * 1e-9, 0.0)
        self._pose, self._stamp = pose, stamp
        if pose is None or before is None:
            return self._guess(seconds, jumped=False)
        motion = between(array_of(before), array_of(pose))
        if before.frame != pose.frame or _jumps(motion, seconds):
            return self._guess(seconds, jumped=True)
        return Step(motion, _odometry_covariance(motion), measured=True)

    def went(self, motion: Array, seconds: float) -> None:
        """Say what the motion since the moment before turned out to be."""
        self._speed = motion / seconds if seconds > 1e-3 else self._speed

    def _guess(self, seconds: float, jumped: bool) -> Step:
        motion = self._speed * min(seconds, LONGEST_GUESS)
        return Step(motion, unmeasured(seconds), measured=False, jumped=jumped)


def unmeasured(seconds: float) -> Array:
    """Return how unsure a motion is that nobody has measured, shape (3, 3).

    Parameters
    ----------
    seconds : float
        How long it took.
    """
    time = min(seconds, LONGEST_GUESS)
    way = LEAST + CHANGE * time
    turn = LEAST_TURN + CHANGE_TURN * time
    return np.diag([way**2, way**2, turn**2])


def _jumps(motion: Array, seconds: float) -> bool:
    time = seconds + JITTER
    return hypot(motion[0], motion[1]) > FASTEST * time or abs(motion[2]) > FASTEST_TURN * time


def _odometry_covariance(motion: Array) -> Array:
    way, turn = hypot(motion[0], motion[1]), abs(motion[2])
    along = LEAST + WAY * way
    heading = LEAST_TURN + TURN * turn + VEER * way
    return np.diag([along**2, along**2, heading**2])
