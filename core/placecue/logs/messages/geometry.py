"""Rotations and frames of reference in 3D, as far as a robot in the plane needs them."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, sin

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from placecue.observation import Pose2D

Matrix = NDArray[np.float64]
#: A quaternion shorter than this has no direction left.
LEAST = 1e-100


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
        Quaternion x, y, z, w.
    stamp : int
        Time, ns.
    """

    parent: str
    child: str
    translation: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    stamp: int = 0

    def matrix(self) -> Matrix:
        """Return the homogeneous matrix that takes child coordinates to the parent, (4, 4)."""
        result = np.eye(4)
        # All zeros is what an unset message holds: no rotation.
        if hypot(*self.rotation) > LEAST:
            result[:3, :3] = Rotation.from_quat(self.rotation).as_matrix()
        result[:3, 3] = self.translation
        return result


def yaw(x: float, y: float, z: float, w: float) -> float:
    """Return the heading of a quaternion, rad, in [-pi, pi]."""
    return atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def quaternion(theta: float) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w of a heading, rad."""
    return 0.0, 0.0, sin(theta / 2), cos(theta / 2)


def flatten(matrix: Matrix, frame: str) -> Pose2D:
    """Return the planar part of a homogeneous matrix."""
    return Pose2D(
        float(matrix[0, 3]), float(matrix[1, 3]), atan2(matrix[1, 0], matrix[0, 0]), frame
    )


class TransformTree:
    """Frames of reference and the latest transform from each to its parent."""

    def __init__(self) -> None:
        self.transforms: dict[str, Transform] = {}

    def add(self, transform: Transform) -> None:
        """Take in a transform; it replaces an older one of the same child."""
        self.transforms[transform.child] = transform

    def frames(self) -> set[str]:
        """Return the names of all frames."""
        return set(self.transforms) | {each.parent for each in self.transforms.values()}

    def ancestors(self, frame: str) -> list[str]:
        """Return a frame and those above it, up to the root."""
        line = [frame]
        while line[-1] in self.transforms and self.transforms[line[-1]].parent not in line:
            line.append(self.transforms[line[-1]].parent)
        return line

    def lookup(self, target: str, source: str) -> Matrix | None:
        """Return the matrix that takes ``source`` coordinates to ``target``, (4, 4), or None."""
        above = self.ancestors(target)
        common = next((frame for frame in self.ancestors(source) if frame in above), None)
        if common is None:
            return None
        matrix: Matrix = np.linalg.inv(self._up(target, common)) @ self._up(source, common)
        return matrix

    def _up(self, frame: str, ancestor: str) -> Matrix:
        matrix = np.eye(4)
        while frame != ancestor:
            transform = self.transforms[frame]
            matrix = transform.matrix() @ matrix
            frame = transform.parent
        return matrix
