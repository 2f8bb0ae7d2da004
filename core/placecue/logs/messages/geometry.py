"""Rotations and frames of reference in 3D, as far as a robot in the plane needs them."""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, atan2, cos, hypot, isfinite, sin
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from placecue.observation import Pose2D

Matrix = NDArray[np.float64]
Quaternion: TypeAlias = tuple[float, float, float, float]

NO_TURN: Quaternion = (0.0, 0.0, 0.0, 1.0)
#: Quaternions shorter than this are zero.
SHORTEST = 1e-6
#: No robot is farther from any origin than once around the Earth, m.
FARTHEST = 4.1e7


@dataclass(frozen=True, slots=True)
class Transform:
    """Where a child frame lies in its parent.

    Parameters
    ----------
    parent, child : str
        Names of the frames.
    translation : tuple of 3 floats
        Origin of the child in the parent, m.
    rotation : tuple of 4 floats
        Quaternion x, y, z, w; of any length.
    stamp : int
        Time, ns.
    """

    parent: str
    child: str
    translation: tuple[float, float, float]
    rotation: Quaternion
    stamp: int = 0

    def matrix(self) -> Matrix:
        """Return the homogeneous matrix that takes child coordinates to the parent, (4, 4)."""
        return rigid(self.translation, self.rotation)

    def fault(self) -> str | None:
        """Return why the transform says nothing, in a few words; None where it is sound."""
        if not self.parent or not self.child or self.parent == self.child:
            return f"it joins '{self.parent}' to '{self.child}'"
        if not all(map(isfinite, (*self.translation, *self.rotation))):
            return "it is not finite"
        if max(map(abs, self.translation)) > FARTHEST:
            return f"it lies {max(map(abs, self.translation)):g} m away"
        return None if normalised(self.rotation) else "its quaternion is zero"


def normalised(rotation: Quaternion) -> Quaternion | None:
    """Return a quaternion x, y, z, w of length one; None where it says nothing: zero, NaN."""
    length = hypot(*rotation)
    if not (isfinite(length) and length > SHORTEST):
        return None
    x, y, z, w = rotation
    return x / length, y / length, z / length, w / length


def rigid(translation: tuple[float, float, float], rotation: Quaternion) -> Matrix:
    """Return the homogeneous matrix of a translation and a quaternion of any length, (4, 4)."""
    x, y, z, w = normalised(rotation) or NO_TURN
    tx, ty, tz = translation
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), tx],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), ty],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), tz],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def slerp(one: Quaternion, other: Quaternion, share: float) -> Quaternion:
    """Return the rotation at a share of the way from one to another, turning the shorter way.

    Both have length one (Shoemake, Animating rotation with quaternion curves, 1985).
    """
    cosine = sum(a * b for a, b in zip(one, other, strict=True))
    sign, cosine = (-1.0, -cosine) if cosine < 0.0 else (1.0, cosine)
    if cosine > 1.0 - 1e-9:
        first, second = 1.0 - share, share
    else:
        angle = acos(cosine)
        first, second = (sin((1.0 - share) * angle) / sin(angle), sin(share * angle) / sin(angle))
    x, y, z, w = (first * a + sign * second * b for a, b in zip(one, other, strict=True))
    return x, y, z, w


def yaw(x: float, y: float, z: float, w: float) -> float:
    """Return the heading of a quaternion of any length, rad, in [-pi, pi]; 0 where it is zero."""
    return atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def quaternion(theta: float) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w of a heading, rad."""
    return 0.0, 0.0, sin(theta / 2), cos(theta / 2)


def flatten(matrix: Matrix, frame: str) -> Pose2D:
    """Return the planar part of a homogeneous matrix."""
    return Pose2D(
        float(matrix[0, 3]), float(matrix[1, 3]), atan2(matrix[1, 0], matrix[0, 0]), frame
    )
