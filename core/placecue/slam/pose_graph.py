"""A graph of poses and of what is measured between them, kept smooth by gtsam's iSAM2."""

from __future__ import annotations

from math import hypot
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.slam.libraries import gtsam
from placecue.slam.planar import Array, between, compose

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
#: A loop that moves its end farther than this, m or rad, is smoothed from where it puts the robot.
FAR, FAR_TURN = 1.0, 0.3
#: A turn is as loose as the motion that it makes at this distance, m.
ARM = 3.0

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
        self._solver: Any = _solver()
        noise = library.noiseModel.Diagonal.Sigmas(ANCHOR)
        factor = library.PriorFactorPose2(0, library.Pose2(*first), noise)
        self._update([factor], {0: first})
        self.poses: Poses = np.array([first], dtype=np.float64)
        self._bases, self._loose = [0], [0.0]  # of each pose's first edge: from where, how loose

    def __len__(self) -> int:
        return len(self.poses)

    def add(self, pose: Array, relative: Array, covariance: Array, base: int | None = None) -> None:
        """Add the next pose, measured from an earlier one.

        Parameters
        ----------
        pose : ndarray, shape (3,)
            Where it is.
        relative : ndarray, shape (3,)
            The new pose, seen from the earlier one.
        covariance : ndarray, shape (3, 3)
            Of ``relative``, in the axes of the new pose.
        base : int, optional
            The earlier pose; the last one by default.
        """
        number = len(self)
        base = number - 1 if base is None else base
        factor = _edge(base, number, relative, _gaussian(covariance))
        self._update([factor], {number: pose})
        self.poses = np.vstack([self.poses, pose])
        self._bases.append(base)
        self._loose.append(float(np.diag(covariance) @ [1.0, 1.0, ARM**2]))

    def close(self, one: int, other: int, relative: Array, covariance: Array) -> bool:
        """Add a loop, unless it contradicts what is there; poses move as it takes.

        Parameters
        ----------
        one, other : int
            The poses that it joins.
        relative : ndarray, shape (3,)
            The other pose, seen from the one.
        covariance : ndarray, shape (3, 3)
            Of ``relative``, in the axes of the other pose.

        Returns
        -------
        bool
            Whether it was kept.
        """
        library, before, kept = gtsam(), self._error(), self._solver
        kernel = library.noiseModel.mEstimator.Cauchy.Create(KERNEL)
        base = _gaussian(covariance)
        factor = _edge(one, other, relative, library.noiseModel.Robust.Create(kernel, base))
        indices: list[int] = []
        if self._is_far(one, other, relative):
            self._solver = self._begun_anew(factor, self._swung(one, other, relative))
        else:
            indices = list(self._update([factor], {}).getNewFactorsIndices())
        self._settle()
        values = self._solver.calculateEstimate()
        # gtsam's errors are halves of squares.
        off = np.sqrt(2 * _edge(one, other, relative, base).error(values))
        strain = 2 * (self._error() - factor.error(values) - before)
        if off <= OFF and strain <= STRAIN * self._edges(one, other):
            self._read(values)
            return True
        self._solver = kept
        if indices:
            kept.update(library.NonlinearFactorGraph(), library.Values(), indices)
            self._settle()
        return False

    def uncertainty(self, number: int) -> Array:
        """Return the covariance of a pose in its own axes, shape (3, 3)."""
        return np.asarray(self._solver.marginalCovariance(number))

    def _edges(self, one: int, other: int) -> int:
        """Return how many first edges lie between two poses."""
        count = 0
        while one != other:
            one, other = min(one, other), self._bases[max(one, other)]
            count += 1
        return count

    def _is_far(self, one: int, other: int, relative: Array) -> bool:
        off = between(relative, between(self.poses[one], self.poses[other]))
        return bool(hypot(off[0], off[1]) > FAR or abs(off[2]) > FAR_TURN)

    def _swung(self, one: int, other: int, relative: Array) -> Poses:
        """Return the poses where all behind the loosest edge before a loop has moved as one."""
        if one > other:
            one, other, relative = other, one, between(relative, np.zeros(3))
        path = [other]
        while self._bases[path[-1]] > one:
            path.append(self._bases[path[-1]])
        loosest = max(path, key=self._loose.__getitem__)
        behind = {loosest}
        for number in range(loosest + 1, len(self)):
            behind |= {number} if self._bases[number] in behind else set()
        there = compose(self.poses[one], relative)
        move = compose(there, between(self.poses[other], np.zeros(3)))
        swung = self.poses.copy()
        for number in behind:
            swung[number] = compose(move, self.poses[number])
        return swung

    def _begun_anew(self, factor: Any, poses: Poses) -> Any:
        """Return a solver of all that is known and one more edge, begun at some poses."""
        library = gtsam()
        graph, values = library.NonlinearFactorGraph(), library.Values()
        known = self._solver.getFactorsUnsafe()
        for number in range(known.size()):
            if known.exists(number):
                graph.push_back(known.at(number))
        graph.push_back(factor)
        for number, pose in enumerate(poses):
            values.insert(number, library.Pose2(*pose))
        solver = _solver()
        solver.update(graph, values)
        return solver

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


def _solver() -> Any:
    parameters = gtsam().ISAM2Params()
    parameters.setRelinearizeThreshold(1e-3)
    parameters.relinearizeSkip = 1
    return gtsam().ISAM2(parameters)


def _array(values: Any, count: int) -> Poses:
    found = np.asarray(gtsam().utilities.extractPose2(values), dtype=np.float64)
    return found.reshape(count, 3)


def _edge(one: int, other: int, relative: Array, noise: Any) -> Any:
    library = gtsam()
    return library.BetweenFactorPose2(one, other, library.Pose2(*relative), noise)


def _gaussian(covariance: Array) -> Any:
    return gtsam().noiseModel.Gaussian.Covariance(np.asarray(covariance))
