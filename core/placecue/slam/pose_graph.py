"""A graph of poses and of what is measured between them, kept smooth by gtsam's iSAM2."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.slam.libraries import gtsam
from placecue.slam.planar import Array

#: The first pose is held by this, m, m, rad.
ANCHOR = np.array([1e-3, 1e-3, 1e-4])
#: A loop that is off by more than this, in standard deviations, loses weight.
KERNEL = 3.0
#: A loop is wrong where it is still off by more than this when all else has given way, in
#: standard deviations, or where what lies between its ends gives way by more than this on the
#: average, in squared standard deviations an edge.
OFF, STRAIN = 6.0, 4.0
#: Smoothing stops where poses move less than this, m or rad, or after so many rounds.
STILL, ROUNDS = 1e-3, 12

Poses = NDArray[np.float64]


class PoseGraph:
    """Poses by number, from 0, and edges between them.

    Parameters
    ----------
    first : ndarray, shape (3,)
        The first pose, which stays where it is.

    References
    ----------
    Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert, iSAM2: incremental smoothing and mapping
    using the Bayes tree, IJRR 31(2), 2012. Cauchy's weights for loops, the first edge of each
    pose without.
    """

    def __init__(self, first: Array) -> None:
        library = gtsam()
        parameters = library.ISAM2Params()
        parameters.setRelinearizeThreshold(1e-3)
        parameters.relinearizeSkip = 1
        self._solver: Any = library.ISAM2(parameters)
        noise = library.noiseModel.Diagonal.Sigmas(ANCHOR)
        factor = library.PriorFactorPose2(0, library.Pose2(*first), noise)
        self._update([factor], {0: first})
        self.poses: Poses = np.array([first], dtype=np.float64)

    def __len__(self) -> int:
        return len(self.poses)

    def add(self, pose: Array, relative: Array, covariance: Array) -> None:
        """Add the next pose, measured from the one before.

        Parameters
        ----------
        pose : ndarray, shape (3,)
            Where it is.
        relative : ndarray, shape (3,)
            The new pose, seen from the one before.
        covariance : ndarray, shape (3, 3)
            Of ``relative``, in the axes of the new pose.
        """
        number = len(self)
        factor = _edge(number - 1, number, relative, _gaussian(covariance))
        self._update([factor], {number: pose})
        self.poses = np.vstack([self.poses, pose])

    def close(self, one: int, other: int, relative: Array, covariance: Array) -> bool:
        """Add a loop, unless it contradicts what is there; poses move as it takes.

        Parameters
        ----------
        one, other : int
            The poses that it joins, the earlier first.
        relative : ndarray, shape (3,)
            The later pose, seen from the earlier.
        covariance : ndarray, shape (3, 3)
            Of ``relative``, in the axes of the later pose.

        Returns
        -------
        bool
            Whether it was kept.
        """
        library = gtsam()
        kernel = library.noiseModel.mEstimator.Cauchy.Create(KERNEL)
        base = _gaussian(covariance)
        before = self._error()
        factor = _edge(one, other, relative, library.noiseModel.Robust.Create(kernel, base))
        indices = self._update([factor], {}).getNewFactorsIndices()
        self._settle()
        values = self._solver.calculateEstimate()
        # gtsam's errors are halves of squares.
        off = np.sqrt(2 * _edge(one, other, relative, base).error(values))
        strain = 2 * (self._error() - factor.error(values) - before)
        if off <= OFF and strain <= STRAIN * (other - one):
            self._read(values)
            return True
        self._solver.update(library.NonlinearFactorGraph(), library.Values(), list(indices))
        self._settle()
        return False

    def uncertainty(self, number: int) -> Array:
        """Return the covariance of a pose in its own axes, shape (3, 3)."""
        return np.asarray(self._solver.marginalCovariance(number))

    def _update(self, factors: list[Any], poses: dict[int, Array]) -> Any:
        library = gtsam()
        graph, values = library.NonlinearFactorGraph(), library.Values()
        for factor in factors:
            graph.push_back(factor)
        for number, pose in poses.items():
            values.insert(number, library.Pose2(*pose))
        return self._solver.update(graph, values)

    def _settle(self) -> None:
        """Go on smoothing until poses stand still."""
        last = self._solver.calculateEstimate()
        for _ in range(ROUNDS):
            self._solver.update()
            now = self._solver.calculateEstimate()
            moved = np.abs(_array(now, len(self)) - _array(last, len(self))).max()
            last = now
            if moved < STILL:
                return

    def _error(self) -> float:
        return float(self._solver.getFactorsUnsafe().error(self._solver.calculateEstimate()))

    def _read(self, values: Any) -> None:
        self.poses = _array(values, len(self))


def _array(values: Any, count: int) -> Poses:
    found = np.asarray(gtsam().utilities.extractPose2(values), dtype=np.float64)
    return found.reshape(count, 3)


def _edge(one: int, other: int, relative: Array, noise: Any) -> Any:
    library = gtsam()
    return library.BetweenFactorPose2(one, other, library.Pose2(*relative), noise)


def _gaussian(covariance: Array) -> Any:
    return gtsam().noiseModel.Gaussian.Covariance(np.asarray(covariance))
