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
from placecue.slam.keyframes import Keyframe, small
from placecue.slam.motion import Motion, Step, unmeasured
from placecue.slam.planar import Array, array_of, between, carried, compose, pose_of
from placecue.slam.scan_map import FLOOR, ScanMap
from placecue.slam.trajectory import Trajectory
from placecue.slam.verifying import seen_through

#: A scan with fewer end points says nothing.
FEWEST = 30
#: A scan lies on the map where this share of its points has a partner.
SHARE = 0.45
#: Nothing need be added to the map there where this share has.
FAMILIAR = 0.9
#: A match may differ from what was expected by so much, m, or by so many standard deviations.
ASTRAY, DEVIATIONS = 0.3, 4.0
#: Where it does not, poses so far around are tried: m with odometry, m without, and rad.
REACH, WIDE_REACH, TURN = 0.6, 1.0, 0.4
#: A robot that moved less than this, m and rad, by its odometry since a scan was laid on the map
#: stands, if half of its beams have changed by less than this, m.
STILL, STILL_TURN, CHANGED = 0.02, 0.01, 0.03
#: A new piece of the map is begun after so many scans in a row that lie on nothing, and where one
#: of less than this share sees through so many of the walls in view: the robot has been carried.
MISSES, SURE, CONTRADICTED = 6, 0.8, 0.4
#: Late news of poses that moved less than this, m and rad, is kept back.
NEWS, NEWS_TURN = 0.02, 0.005
#: Odometry alone may be off by so much more of the way than scans and odometry.
ALONE = 0.15


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
    map : ScanMap
        What scans are laid on.
    trajectory : Trajectory
        Where the robot was.
    account : Account
        What became of the scans.
    """

    def __init__(self, frame: str = "map") -> None:
        self.frame = frame
        self.trajectory = Trajectory()
        self.account = Account()
        self.map = ScanMap(self.account)
        self._motion = Motion()
        self._pose: Array | None = None
        self._covariance = np.diag(FLOOR**2)  # of the pose, seen from the last keyframe
        self._share = 0.0  # of the scan's points that have a partner, if they tell all directions
        self._stamp = 0
        self._way = 0.0
        self._moved = np.zeros(2)  # m and rad since a scan was laid on the map
        self._laid: LaserScan | None = None  # that scan
        self._laid_at = 0  # its time
        self._misses = 0
        self._told: NDArray[np.float64] = np.empty((0, 3))  # keyframes as they were told last
        self._known = self._told  # as they were when that was looked at

    @property
    def keyframes(self) -> list[Keyframe]:
        """What the map is made of."""
        return self.map.keyframes

    @property
    def poses(self) -> NDArray[np.float64]:
        """Poses of the keyframes as they are known now, shape (n, 3)."""
        return self.map.poses

    def observations(self) -> Iterator[Observation]:
        """Yield stamp, scan and pose of each keyframe, as poses are known now."""
        for keyframe, pose in zip(self.keyframes, self.poses, strict=True):
            placed = pose_of(pose, self.frame)
            yield Observation(keyframe.stamp, scan=keyframe.scan, pose=placed)

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
        a, b, heading = np.sqrt(np.diag(turn @ self.map.uncertainty(number) @ turn.T)).tolist()
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
            self.trajectory.add(self._stamp, self.map.base, self.map.seen(self._pose))
        return pose_of(self._pose, self.frame), self._news()

    # ------------------------------------------------------------------ motion

    def _begin(self, observation: Observation) -> None:
        self._motion.step(observation.pose, observation.stamp)
        pose = observation.pose
        start = np.zeros(3) if pose is None else array_of(pose)
        self._pose = start if np.isfinite(start).all() else np.zeros(3)
        self._stamp = observation.stamp
        if observation.scan is not None:
            self._see(observation.scan, Step(np.zeros(3), np.zeros((3, 3)), measured=True))

    def _advance(self, observation: Observation) -> None:
        assert self._pose is not None
        step = self._motion.step(observation.pose, observation.stamp)
        self._share = 0.0
        self.account.without += not (step.measured or step.jumped)
        self.account.jumps += step.jumped
        before, seconds = self._pose, (observation.stamp - self._stamp) * 1e-9
        self._pose, self._stamp = compose(before, step.motion), observation.stamp
        self._covariance = carried(self._covariance, step.motion) + step.covariance
        self._moved += [hypot(step.motion[0], step.motion[1]), abs(step.motion[2])]
        cloud = None if observation.scan is None else self._see(observation.scan, step)
        went = between(before, self._pose)
        self._motion.went(went, seconds)
        self._way += hypot(went[0], went[1])
        if observation.scan is None or not self.keyframes:
            return
        if not self._share:
            self.map.strayed(ALONE * hypot(went[0], went[1]))
        if cloud is not None:
            self._grow(observation.scan, cloud)

    # ------------------------------------------------------------------ scans

    def _see(self, scan: LaserScan, step: Step) -> Points | None:
        """Lay a scan on the map, and take the pose from there.

        Returns its end points, unless they say nothing, or nothing new.
        """
        self.account.scans += 1
        measured = step.measured
        if measured and self.keyframes and self._has_not_moved():
            if alike(self._laid, scan):
                self.account.still += 1
                return None
            self.account.stopped += 1
            measured = False
            since = (self._stamp - self._laid_at) * 1e-9
            self._covariance = self._covariance + unmeasured(since)
        cloud = cloud_of(scan)
        if len(cloud) < FEWEST:
            self.account.few += 1
            return None
        if not self.keyframes:
            self._add(scan, cloud)
            return cloud
        estimate = self._laid_on_map(cloud, measured)
        if estimate is None:
            self.account.unmatched += 1
            self._misses += 1
            return cloud
        self._misses = 0
        self.account.matched += 1
        if estimate.untold:
            self.account.untold += 1
            self._share = 0.0
        self._pose, self._covariance = estimate.pose, estimate.covariance
        self._note(scan)
        return cloud

    def _note(self, scan: LaserScan) -> None:
        self._moved[:], self._laid, self._laid_at = 0.0, scan, self._stamp

    def _has_not_moved(self) -> bool:
        return bool(self._moved[0] <= STILL and self._moved[1] <= STILL_TURN)

    def _laid_on_map(self, cloud: Points, measured: bool) -> Estimate | None:
        assert self._pose is not None
        expected = self._pose
        for guess in self._guesses(cloud, measured):
            match = self.map.local.target.match(cloud, guess)
            if match.share < SHARE:
                continue
            estimate = fused(match, len(cloud), expected, self._covariance)
            if self._believable(between(expected, estimate.pose)):
                self._share = match.share
                return estimate
        return None

    def _guesses(self, cloud: Points, measured: bool) -> Iterator[Array]:
        """Yield where the scan may lie: where it is expected, else where a search puts it."""
        assert self._pose is not None
        yield self._pose
        reach = REACH if measured else WIDE_REACH
        yield self.map.local.field.search(cloud, self._pose, reach, TURN).pose

    def _believable(self, off: Array) -> bool:
        sure = np.sqrt(np.linalg.eigvalsh(self._covariance[:2, :2])[-1])
        return bool(hypot(off[0], off[1]) <= max(ASTRAY, DEVIATIONS * sure))

    # ------------------------------------------------------------------ the map

    def _grow(self, scan: LaserScan, cloud: Points) -> None:
        """Add a keyframe where the map has none, the first of a new piece where nothing fits."""
        assert self._pose is not None
        if self._misses < MISSES and not self.map.is_left_by(self._pose):
            return
        back = self.map.back_at(self._pose, self._way) if self._share >= FAMILIAR else None
        if back is not None:
            self._pose = back
            return
        if self._misses >= MISSES or self._is_contradicted(scan):
            self._misses = 0
            self.account.lost += 1
            self.map.local.forget()
        self._add(scan, cloud)

    def _is_contradicted(self, scan: LaserScan) -> bool:
        """Tell whether a scan that does not lie well sees through the walls that should be here."""
        assert self._pose is not None
        walls = self.map.local.points
        return self._share < SURE and seen_through(scan, self._pose, walls) > CONTRADICTED

    def _add(self, scan: LaserScan, cloud: Points) -> None:
        assert self._pose is not None
        before = self.keyframes[-1].scan if self.keyframes else None
        light, lean = cloud.astype(np.float32), small(scan, before)
        made = Keyframe(self._stamp, self._way, light, lean, self.account.lost)
        self._told = np.vstack([self._told, self._pose])
        self._pose = self.map.add(made, self._pose, self._covariance)
        self._covariance = np.diag(FLOOR**2)
        self._note(scan)

    def _news(self) -> Correction | None:
        if self.poses is self._known or not self.keyframes:
            return None
        self._known = self.poses
        off = self.poses - self._told
        turned = np.abs((off[:, 2] + np.pi) % (2 * np.pi) - np.pi)
        if np.hypot(off[:, 0], off[:, 1]).max() < NEWS and turned.max() < NEWS_TURN:
            return None
        stamps, at = self.trajectory.bases()
        before, self._told = self._told, self.poses.copy()
        return Correction(stamps, before[at], self._told[at], self.frame)


def alike(one: LaserScan | None, other: LaserScan) -> bool:
    """Tell whether two scans are of a robot that has not moved: half of the beams are as long."""
    if one is None or len(one.ranges) != len(other.ranges):
        return False
    both = one.valid() & other.valid()
    if not both.any():
        return not (one.valid().any() or other.valid().any())
    return bool(np.median(np.abs(one.ranges[both] - other.ranges[both])) < CHANGED)
