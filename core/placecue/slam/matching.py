"""Lays a scan on points that were seen before; small_gicp does the work."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, sin
from typing import Any

import numpy as np

from placecue.slam.libraries import small_gicp
from placecue.slam.planar import Array

#: Walls are given a height, so that their normals lie in the plane: layers at these heights, m.
LAYERS = (-0.06, 0.0, 0.06)
#: Neighbours that a normal is fitted to, over all layers.
NEIGHBOURS = 12
#: Pairs of points farther apart than this do not count, m: first, and then again.
REACHES = (0.6, 0.25)
#: Of x, y and heading in small_gicp's order of rotations and translations.
PLANE = np.ix_([3, 4, 2], [3, 4, 2])


@dataclass(frozen=True, slots=True)
class Match:
    """How a scan lies on a target.

    Parameters
    ----------
    pose : ndarray, shape (3,)
        Pose of the scan in the target's frame.
    information : ndarray, shape (3, 3)
        What the match says of x, y and heading in the scan's own axes, in points: the sum over
        pairs of the squared derivatives of the distance to the wall. Nothing along a direction
        means that no wall tells that direction.
    share : float
        The share of points that have a partner, 0 to 1.
    """

    pose: Array
    information: Array
    share: float


class Target:
    """Points to lay scans on.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        m; :data:`NEIGHBOURS` or more.
    """

    def __init__(self, points: Array) -> None:
        library = small_gicp()
        layers = [np.column_stack([points, np.full(len(points), z)]) for z in LAYERS]
        self._cloud: Any = library.PointCloud(np.vstack(layers))
        self._tree: Any = library.KdTree(self._cloud)
        library.estimate_normals(self._cloud, self._tree, NEIGHBOURS)

    def match(self, points: Array, guess: Array) -> Match:
        """Lay points on the target by point-to-line distances.

        Parameters
        ----------
        points : ndarray, shape (k, 2)
            In the scan's own frame, m.
        guess : ndarray, shape (3,)
            Its pose in the target's frame, as far as known.
        """
        library = small_gicp()
        source = library.PointCloud(np.column_stack([points, np.zeros(len(points))]))
        pose, found = guess, None
        for reach in REACHES:
            found = library.align(
                self._cloud,
                source,
                self._tree,
                init_T_target_source=_matrix(pose),
                registration_type="PLANE_ICP",
                max_correspondence_distance=reach,
                num_threads=1,  # so that sums have one order, and results are the same
            )
            pose = _pose(np.asarray(found.T_target_source))
        assert found is not None
        information = np.asarray(found.H, dtype=np.float64)[PLANE]
        return Match(pose, information, found.num_inliers / len(points))


def _matrix(pose: Array) -> Array:
    c, s = cos(pose[2]), sin(pose[2])
    matrix = np.eye(4)
    matrix[:2, :2] = [[c, -s], [s, c]]
    matrix[:2, 3] = pose[:2]
    return matrix


def _pose(matrix: Array) -> Array:
    return np.array([matrix[0, 3], matrix[1, 3], atan2(matrix[1, 0], matrix[0, 0])])
