"""Poses from scans, one observation at a time."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot

import numpy as np
from numpy.typing import NDArray

from placecue.correction import Correction
from placecue.observation import LaserScan, Observation, Pose2D
from placecue.slam.account import Account
from placecue.slam.cloud import Points, cloud_of
from placecue.slam.fusing import Estimate, fused
from placecue.slam.keyframes import Keyframe, joined, small
from placecue.slam.likelihood import Field
from placecue.slam.loops import Loop, LoopFinder
from placecue.slam.matching import Target
from placecue.slam.motion import Motion, Step, unmeasured
from placecue.slam.planar import Array, array_of, between, carried, compose, pose_of
from placecue.slam.pose_graph import PoseGraph
from placecue.slam.trajectory import Trajectory

#: A keyframe is made after so much motion, m and rad.
SPACING, TURNING = 0.5, 0.35
#: Scans are laid on so many keyframes before, and on so many around the place that the robot has
#: been found to be back at.
LOCAL, AROUND = 10, 3
#: A scan with fewer end points says nothing.
FEWEST = 30
#: A scan lies on the map where this share of its points has a partner.
SHARE = 0.45
#: A match may differ from what was expected by so much, m, or by so many standard deviations.
ASTRAY, DEVIATIONS = 0.3, 4.0
#: Where it does not, poses so far around are tried: m with odometry, m without, and rad.
REACH, WIDE_REACH, TURN = 0.6, 1.0, 0.4
#: A robot that moved less than this, m and rad, by its odometry since a scan was laid on the map
#: stands, if half of its beams have changed by less than this, m.
STILL, STILL_TURN, CHANGED = 0.02, 0.01, 0.03
#: After so many scans in a row that lie on nothing the map is begun anew, tied to what is there by
#: this, m, m, rad.
MISSES, TIE = 6, np.array([2.0, 2.0, 0.5])
#: A loop that says no more than this of what is known, m and rad, is left out of the graph.
KNOWN, KNOWN_TURN = 0.03, 0.01
#: Late news of poses that moved less than this, m and rad, is kept back.
NEWS, NEWS_TURN = 0.02, 0.005
#: The least that a pose may be off from the one before, m, m, rad.
FLOOR = np.array([0.003, 0.003, 0.001])


class Mapper:
    """Follows a robot: lays each scan on the ones before, and closes loops.

    Where scans say nothing, odometry is followed; where there is none, the robot is taken to go on
    as it did. Nothing of it is random: the same observations give the same poses.

    Parameters
    ----------
    frame : str
        What the frame of the poses is called.

    Attributes
    ----------
    keyframes : list of Keyframe
        What the map is made of.
    trajectory : Trajectory
        Where the robot was.
    account : Account
        What became of the scans.
    """

    def __init__(self, frame: str = "map") -> None:
        self.frame = frame
        self.keyframes: list[Keyframe] = []
        self.trajectory = Trajectory()
        self.account = Account()
        self._motion = Motion()
        self._loops = LoopFinder()
        self._graph: PoseGraph | None = None
        self._target: Target | None = None
        self._field: Field | None = None
        self._points: Points = np.empty((0, 2))
        self._back: dict[int, int] = {}  # keyframes, and where they have been found to be back at
        self._piece = 0  # the first keyframe since the map was begun anew
        self._pose: Array | None = None
        self._covariance = np.diag(FLOOR**2)  # of the pose, seen from the last keyframe
        self._stamp = 0
        self._way = 0.0
        self._moved = np.zeros(2)  # m and rad since a scan was laid on the map
        self._laid: LaserScan | None = None  # that scan
        self._laid_at = 0  # its time
        self._misses = 0
        self._told: NDArray[np.float64] = np.empty((0, 3))  # keyframes as they were told last

    @property
    def poses(self) -> NDArray[np.float64]:
        """Poses of the keyframes as they are known now, shape (n, 3)."""
        return np.empty((0, 3)) if self._graph is None else self._graph.poses

    def observations(self) -> Iterator[Observation]:
        """Yield stamp, scan and pose of each keyframe, as poses are known now."""
        for keyframe, pose in zip(self.keyframes, self.poses, strict=True):
            placed = pose_of(pose, self.frame)
            yield Observation(keyframe.stamp, scan=keyframe.scan, pose=placed)

    def uncertainty(self, number: int) -> Array:
        """Return the covariance of a keyframe's pose in its own axes, shape (3, 3)."""
        assert self._graph is not None
        return self._graph.uncertainty(number)

    def sure_of(self, x: float, y: float) -> tuple[float, float, float]:
        """Return how sure the pose is that was told nearest to a position.

        Parameters
        ----------
        x, y : float
            m, in the frame of the poses; there must be a keyframe.

        Returns
        -------
        tuple of float
            Standard deviations of x, y (m) and heading (rad), in the axes of that frame.
        """
        number = int(np.hypot(*(self.poses[:, :2] - [x, y]).T).argmin())
        turn = np.eye(3)
        c, s = np.cos(self.poses[number, 2]), np.sin(self.poses[number, 2])
        turn[:2, :2] = [[c, -s], [s, c]]
        a, b, heading = np.sqrt(np.diag(turn @ self.uncertainty(number) @ turn.T)).tolist()
        return a, b, heading

    def follow(self, observation: Observation) -> tuple[Pose2D, Correction | None]:
        """Take in the next observation.

        Returns
        -------
        pose : Pose2D
            Where the robot is.
        correction : Correction or None
            How poses told before have moved, where they have.
        """
        if self._pose is None:
            self._begin(observation)
        elif observation.stamp <= self._stamp:
            self.account.disordered += 1
            return pose_of(self._pose, self.frame), None
        else:
            self._advance(observation)
        assert self._pose is not None
        if self.keyframes:
            seen = between(self.poses[-1], self._pose)
            self.trajectory.add(self._stamp, len(self.keyframes) - 1, seen)
        return pose_of(self._pose, self.frame), self._news()

    # ------------------------------------------------------------------ motion

    def _begin(self, observation: Observation) -> None:
        self._motion.step(observation.pose, observation.stamp)
        pose = observation.pose
        start = np.zeros(3) if pose is None else array_of(pose)
        self._pose = start if np.isfinite(start).all() else np.zeros(3)
        self._stamp = observation.stamp
        if observation.scan is not None:
            self._first(observation.scan)

    def _advance(self, observation: Observation) -> None:
        assert self._pose is not None
        step = self._motion.step(observation.pose, observation.stamp)
        self.account.without += not (step.measured or step.jumped)
        self.account.jumps += step.jumped
        before, seconds = self._pose, (observation.stamp - self._stamp) * 1e-9
        self._pose, self._stamp = compose(before, step.motion), observation.stamp
        self._covariance = carried(self._covariance, step.motion) + step.covariance
        self._moved += [hypot(step.motion[0], step.motion[1]), abs(step.motion[2])]
        if observation.scan is not None:
            if self._graph is None:
                self._first(observation.scan)
            else:
                self._see(observation.scan, step)
        went = between(before, self._pose)
        self._motion.went(went, seconds)
        self._way += hypot(went[0], went[1])
        if observation.scan is not None and self._is_due():
            self._add_keyframe(observation.scan)

    # ------------------------------------------------------------------ scans

    def _first(self, scan: LaserScan) -> None:
        """Begin the map with the first scan that shows enough."""
        self.account.scans += 1
        cloud = cloud_of(scan)
        if len(cloud) < FEWEST:
            self.account.few += 1
            return
        assert self._pose is not None
        self._graph = PoseGraph(self._pose)
        self._keep(scan, cloud)

    def _see(self, scan: LaserScan, step: Step) -> None:
        """Lay a scan on the map, and take the pose from there."""
        self.account.scans += 1
        measured = step.measured
        if measured and self._has_not_moved():
            if alike(self._laid, scan):
                self.account.still += 1
                return
            self.account.stopped += 1
            measured = False
            since = (self._stamp - self._laid_at) * 1e-9
            self._covariance = self._covariance + unmeasured(since)
        cloud = cloud_of(scan)
        if len(cloud) < FEWEST:
            self.account.few += 1
            return
        estimate = self._laid_on_map(cloud, measured)
        if estimate is None:
            self.account.unmatched += 1
            self._misses += 1
            return
        self._misses = 0
        self.account.matched += 1
        self.account.untold += estimate.untold > 0
        self._pose, self._covariance = estimate.pose, estimate.covariance
        self._note(scan)

    def _note(self, scan: LaserScan) -> None:
        self._moved[:], self._laid, self._laid_at = 0.0, scan, self._stamp

    def _has_not_moved(self) -> bool:
        return bool(self._moved[0] <= STILL and self._moved[1] <= STILL_TURN)

    def _laid_on_map(self, cloud: Points, measured: bool) -> Estimate | None:
        assert self._pose is not None
        assert self._target is not None
        expected = self._pose
        for guess in self._guesses(cloud, measured):
            match = self._target.match(cloud, guess)
            if match.share < SHARE:
                continue
            estimate = fused(match, len(cloud), expected, self._covariance)
            if self._believable(between(expected, estimate.pose)):
                return estimate
        return None

    def _guesses(self, cloud: Points, measured: bool) -> Iterator[Array]:
        """Yield where the scan may lie: where it is expected, else where a search puts it."""
        assert self._pose is not None
        yield self._pose
        if self._field is None:
            self._field = Field(self._points)
        reach = REACH if measured else WIDE_REACH
        yield self._field.search(cloud, self._pose, reach, TURN).pose

    def _believable(self, off: Array) -> bool:
        sure = np.sqrt(np.linalg.eigvalsh(self._covariance[:2, :2])[-1])
        return bool(hypot(off[0], off[1]) <= max(ASTRAY, DEVIATIONS * sure))

    # ------------------------------------------------------------------ the map

    def _is_due(self) -> bool:
        if self._graph is None or self._pose is None:
            return False
        step = between(self.poses[-1], self._pose)
        far = hypot(step[0], step[1]) >= SPACING or abs(step[2]) >= TURNING
        return bool(far) or self._misses >= MISSES

    def _add_keyframe(self, scan: LaserScan) -> None:
        cloud = cloud_of(scan)
        if len(cloud) < FEWEST:
            return  # the next one shows more
        assert self._graph is not None
        assert self._pose is not None
        if self._misses >= MISSES:
            self.account.lost += 1
            self._misses, self._piece = 0, len(self.keyframes)
            self._covariance = self._covariance + np.diag(TIE**2)
        relative = between(self.poses[-1], self._pose)
        self._graph.add(self._pose, relative, self._covariance + np.diag(FLOOR**2))
        self._keep(scan, cloud)
        self._close_loops()

    def _keep(self, scan: LaserScan, cloud: Points) -> None:
        assert self._pose is not None
        kept = Keyframe(self._stamp, self._way, cloud.astype(np.float32), small(scan))
        self.keyframes.append(kept)
        self._told = np.vstack([self._told, self._pose])
        self._covariance = np.diag(FLOOR**2)
        self._note(scan)
        self._look_around()

    def _close_loops(self) -> None:
        found = self._loops.find(self.keyframes, self.poses)
        known = [loop for loop in found if self._is_known(loop)]
        closed = [loop for loop in found if loop not in known and self._closes(loop)]
        if not (known or closed):
            return
        self._back.update({loop.later: loop.earlier for loop in (*known, *closed)})
        self.account.confirmed += len(known)
        self.account.loops += len(closed)
        self._loops.closed(self._way)
        self._pose = self.poses[-1].copy()
        self._look_around()

    def _is_known(self, loop: Loop) -> bool:
        """Tell whether a loop says what is known anyway: on old ground the graph stays small."""
        here = between(self.poses[loop.earlier], self.poses[loop.later])
        off = between(loop.relative, here)
        return bool(hypot(off[0], off[1]) <= KNOWN and abs(off[2]) <= KNOWN_TURN)

    def _closes(self, loop: Loop) -> bool:
        assert self._graph is not None
        kept = self._graph.close(loop.earlier, loop.later, loop.relative, loop.covariance)
        if not kept:
            self.account.refused += 1
            self._loops.refused()
        return kept

    def _look_around(self) -> None:
        """Gather what scans are laid on from now on."""
        last = len(self.keyframes)
        near = set(range(max(self._piece, last - LOCAL), last))
        for later, earlier in self._back.items():
            if later >= last - LOCAL:
                near |= set(range(max(0, earlier - AROUND), min(last, earlier + AROUND + 1)))
        self._points = joined(self.keyframes, self.poses, sorted(near))
        self._target, self._field = Target(self._points), None

    def _news(self) -> Correction | None:
        if not len(self._told):
            return None
        off = self.poses - self._told
        turned = np.abs((off[:, 2] + np.pi) % (2 * np.pi) - np.pi)
        if np.hypot(off[:, 0], off[:, 1]).max() < NEWS and turned.max() < NEWS_TURN:
            return None
        stamps = np.array([keyframe.stamp for keyframe in self.keyframes], dtype=np.int64)
        before, self._told = self._told, self.poses.copy()
        return Correction(stamps, before, self._told, self.frame)


def alike(one: LaserScan | None, other: LaserScan) -> bool:
    """Tell whether two scans are of a robot that has not moved: half of the beams are as long."""
    if one is None or len(one.ranges) != len(other.ranges):
        return False
    both = one.valid() & other.valid()
    if not both.any():
        return not (one.valid().any() or other.valid().any())
    return bool(np.median(np.abs(one.ranges[both] - other.ranges[both])) < CHANGED)
