"""Doors, seen by the laser while the robot passes them."""

from __future__ import annotations

from math import hypot, pi, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import Boundary
from placecue.observation import LaserScan, Observation, Pose2D

Floats = NDArray[np.float64]

#: Beams so little behind straight right and left still count as ahead, rad.
HALF_A_BEAM = radians(0.5)


class Frontal(NamedTuple):
    """The beams in front of the robot, from right to left: bearings (rad) and ranges (m)."""

    bearings: Floats
    ranges: Floats
    valid: NDArray[np.bool_]

    def points(self, rows: NDArray[np.intp]) -> Floats:
        """Return the end points of some beams, seen from the scanner, m, shape (k, 2)."""
        bearings = self.bearings[rows]
        towards = np.column_stack([np.cos(bearings), np.sin(bearings)])
        return np.asarray(self.ranges[rows, None] * towards)


def frontal(scan: LaserScan, min_range: float, behind: float = 0.0) -> Frontal:
    """Return the beams within 90 degrees of the robot's heading, by bearing.

    Parameters
    ----------
    scan : LaserScan
        Any field of view, however mounted.
    min_range : float
        Shorter beams are invalid, m.
    behind : float
        So much more to each side, rad, where the scanner sees it.
    """
    bearings = (scan.angles + scan.mount.theta + pi) % (2 * pi) - pi
    half_step = abs(scan.angles[1] - scan.angles[0]) / 2 if scan.angles.size > 1 else 0.0
    rows = np.flatnonzero(np.abs(bearings) <= pi / 2 + half_step + behind)
    rows = rows[np.argsort(bearings[rows], kind="stable")]
    ranges = scan.ranges[rows]
    with np.errstate(invalid="ignore"):
        valid = scan.valid()[rows] & (ranges >= min_range)
    return Frontal(bearings[rows], ranges, valid)


class Door(Boundary):
    """A doorway: two posts beside the scanner, a door's width apart, and depth between them.

    The post on each side is the nearest valid beam within ``post_bearing`` of straight right and
    left, behind too where the scanner sees so far; their ranges must add up to the width of a
    door. A scanner that sees less than 180 degrees finds no doors.

    Parameters
    ----------
    post_bearing : float
        How far a post may lie from straight right and straight left, degrees.
    min_width, max_width : float
        Limits of the sum of the two posts' ranges, m.
    open_beams : int
        At least this many beams between the posts must be longer than ``open_range``; beams
        that are infinite (no return) count, NaN do not (REP 117).
    of_beams : int
        The number of beams over 180 degrees that ``open_beams`` is meant for; for other scanners
        it is scaled. The group's scanner had 361.
    open_range : float
        Length of a beam that looks through the door, m.
    min_support : float
        Extent of the connected end points that make a post, m.
    max_gap : float
        Distance between neighbouring end points that are still connected, m.
    check_every : float
        Motion between one check and the next, m.
    leave_distance : float
        The robot is in the door, and finds no other, until it is this far from it, m.
    min_range : float
        Shorter beams are invalid, m.

    Notes
    -----
    The numbers are those of the group's robot code (Pronobis et al., IJRR 2010, section 5).
    """

    def __init__(
        self,
        post_bearing: float = 20.0,
        min_width: float = 0.6,
        max_width: float = 1.05,
        open_beams: int = 50,
        of_beams: int = 361,
        open_range: float = 1.5,
        min_support: float = 0.05,
        max_gap: float = 0.02,
        check_every: float = 0.01,
        leave_distance: float = 1.0,
        min_range: float = 0.02,
    ) -> None:
        self.post_bearing = post_bearing
        self.min_width = min_width
        self.max_width = max_width
        self.open_beams = open_beams
        self.of_beams = of_beams
        self.open_range = open_range
        self.min_support = min_support
        self.max_gap = max_gap
        self.check_every = check_every
        self.leave_distance = leave_distance
        self.min_range = min_range

    def reset(self) -> None:
        """Forget the door that the robot is in, and where it last looked."""
        self.checked_: Pose2D | None = None
        self.door_: Pose2D | None = None

    def update(self, observation: Observation) -> Pose2D | None:
        """Return the middle of a door, with the robot's heading, once a passage; else None."""
        pose, scan = observation.pose, observation.scan
        if pose is None or scan is None:
            return None
        if not hasattr(self, "door_"):
            self.reset()
        if self._still_in_door(pose) or not self._moved(pose):
            return None
        middle = self.find(scan)
        if middle is not None:
            self.door_ = pose.compose(middle)
        return self.door_

    def find(self, scan: LaserScan) -> Pose2D | None:
        """Look for a door in one scan.

        Parameters
        ----------
        scan : LaserScan
            What the robot sees.

        Returns
        -------
        Pose2D or None
            The middle between the posts in the robot's frame, or None where there is no door.
        """
        front = frontal(scan, self.min_range, radians(self.post_bearing))
        right = self._post(front, -pi / 2)
        left = self._post(front, pi / 2)
        if right is None or left is None:
            return None
        width = front.ranges[right] + front.ranges[left]
        if not self.min_width <= width <= self.max_width:
            return None
        if not self._is_open(front, right, left):
            return None
        if not (self._supported(front, right) and self._supported(front, left)):
            return None
        x, y = front.points(np.array([right, left])).mean(axis=0)
        return Pose2D(scan.mount.x + float(x), scan.mount.y + float(y), 0.0)

    def _still_in_door(self, pose: Pose2D) -> bool:
        door = self.door_
        if door is not None and hypot(pose.x - door.x, pose.y - door.y) > self.leave_distance:
            self.door_ = None
        return self.door_ is not None

    def _moved(self, pose: Pose2D) -> bool:
        last = self.checked_
        if last is not None and hypot(pose.x - last.x, pose.y - last.y) < self.check_every:
            return False
        self.checked_ = pose
        return True

    def _post(self, front: Frontal, side: float) -> int | None:
        beside = front.valid & (np.abs(front.bearings - side) <= radians(self.post_bearing))
        rows = np.flatnonzero(beside)
        return int(rows[front.ranges[rows].argmin()]) if rows.size else None

    def _is_open(self, front: Frontal, right: int, left: int) -> bool:
        with np.errstate(invalid="ignore"):
            deep = np.count_nonzero(front.ranges[right + 1 : left] > self.open_range)
        ahead = np.count_nonzero(np.abs(front.bearings) <= pi / 2 + HALF_A_BEAM)
        return bool(deep * self.of_beams >= self.open_beams * ahead)

    def _supported(self, front: Frontal, post: int) -> bool:
        rows = np.flatnonzero(front.valid)
        points = front.points(rows)
        gaps = np.hypot(*np.diff(points, axis=0).T)
        breaks = np.flatnonzero(gaps > self.max_gap) + 1  # each begins another piece
        at = np.searchsorted(rows, post)
        piece = int(np.searchsorted(breaks, at, side="right"))
        first = breaks[piece - 1] if piece else 0
        last = (breaks[piece] if piece < breaks.size else rows.size) - 1
        return bool(np.hypot(*(points[last] - points[first])) >= self.min_support)
