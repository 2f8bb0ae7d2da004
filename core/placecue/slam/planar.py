"""Poses in the plane as arrays of x, y (m) and heading (rad), and what is done with them."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from placecue.observation import Pose2D

Array = NDArray[np.float64]


def array_of(pose: Pose2D) -> Array:
    """Return a pose as an array, shape (3,)."""
    return np.array([pose.x, pose.y, pose.theta])


def pose_of(values: Array, frame: str) -> Pose2D:
    """Return an array, shape (3,), as a pose in a frame, its heading within [-pi, pi)."""
    return Pose2D(float(values[0]), float(values[1]), wrapped(float(values[2])), frame)


def wrapped(angle: float) -> float:
    """Return an angle within [-pi, pi)."""
    return (angle + pi) % (2 * pi) - pi


def compose(one: Array, other: Array) -> Array:
    """Return ``other``, given in the frame of ``one``, in the frame that ``one`` is given in."""
    x, y, theta = one.tolist()
    u, v, turn = other.tolist()
    c, s = cos(theta), sin(theta)
    return np.array([x + c * u - s * v, y + s * u + c * v, wrapped(theta + turn)])


def between(one: Array, other: Array) -> Array:
    """Return ``other`` as it is seen from ``one``; both are given in one frame."""
    dx, dy = float(other[0] - one[0]), float(other[1] - one[1])
    theta = float(one[2])
    c, s = cos(theta), sin(theta)
    return np.array([c * dx + s * dy, c * dy - s * dx, wrapped(float(other[2]) - theta)])


def moved(points: Array, pose: Array) -> Array:
    """Return points (n, 2), given in the frame of a pose, in the frame that it is given in."""
    c, s = cos(pose[2]), sin(pose[2])
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + pose[:2])


def carried(covariance: Array, step: Array) -> Array:
    """Return what an uncertainty, given at a pose in its own axes, is after a step from there.

    Parameters
    ----------
    covariance : ndarray, shape (3, 3)
        Of x, y and heading, in the axes of the pose before the step.
    step : ndarray, shape (3,)
        The next pose, seen from the one before.

    Returns
    -------
    ndarray, shape (3, 3)
        In the axes of the pose after the step; the uncertainty of the step itself is not in it.
    """
    c, s = cos(step[2]), sin(step[2])
    # A turn of the earlier pose moves the later one sideways by its distance.
    jacobian = np.array(
        [
            [c, s, s * step[0] - c * step[1]],
            [-s, c, c * step[0] + s * step[1]],
            [0.0, 0.0, 1.0],
        ]
    )
    return np.asarray(jacobian @ covariance @ jacobian.T)
