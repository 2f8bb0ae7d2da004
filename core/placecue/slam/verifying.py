"""Lays what was seen last on what was seen around an earlier keyframe."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from placecue.observation import LaserScan
from placecue.slam.cloud import Points
from placecue.slam.fusing import told
from placecue.slam.keyframes import Keyframe, beside, joined
from placecue.slam.likelihood import Field, Found
from placecue.slam.matching import NEIGHBOURS, Target
from placecue.slam.planar import Array, array_of, between, compose, moved

#: Keyframes before and after the earlier one, and before the later one, that are laid together.
AROUND, BEHIND = 5, 2
#: Side of a cell of them that holds one point, m.
CELL = 0.1
#: A point lies on what was seen before within so many metres.
NEAR = 0.15
#: Best and worst that a loop knows, m, m, rad.
BEST, WORST = np.array([0.02, 0.02, 0.005]), np.array([5.0, 5.0, 1.0])
#: Where nothing is known of the pose: so far around the earlier keyframe it is looked for, m, in
#: steps so many times as wide, and then again around the best, m and rad.
WITHIN, COARSE, AGAIN, AGAIN_TURN = 1.2, 2.0, 0.4, 0.15
#: A wall is seen through where the beam goes on for more than this behind it, m.
BEYOND = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """One keyframe as it is seen from another.

    Parameters
    ----------
    earlier, later : int
        The two: the robot is at the later one, and has been at the other.
    relative : ndarray, shape (3,)
        Pose of the later one in the axes of the earlier.
    covariance : ndarray, shape (3, 3)
        Of it, in the axes of the later.
    share : float
        Of the points seen last, the share that lies on what was seen before, 0 to 1.
    """

    earlier: int
    later: int
    relative: Array
    covariance: Array
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class Bar:
    """What a loop needs.

    Parameters
    ----------
    score : float
        Of the search, 0 to 1.
    share : float
        Of its points, the share that lies on what was seen before.
    through : float
        Of the walls that should be seen again, the share that is seen through at most.
    """

    score: float
    share: float
    through: float


#: Where position proposes a loop, and where likeness alone does.
BY_POSITION, BY_LIKENESS = Bar(0.35, 0.6, 1.0), Bar(0.45, 0.75, 0.15)

Search = Callable[[Field, Points], Found]


def verified(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    earlier: int,
    later: int,
    reach: float,
    turn: float,
    bar: Bar = BY_POSITION,
) -> Loop | None:
    """Lay a keyframe on what was seen around another; None where it does not fit.

    Parameters
    ----------
    keyframes : sequence of Keyframe
        All so far.
    poses : ndarray, shape (len(keyframes), 3)
        Their poses.
    earlier : int
        The one that the robot may have come back to.
    later : int
        Where it is.
    reach, turn : float
        How far off poses may be, m and rad.
    bar : Bar
        What it needs.
    """

    def near(field: Field, source: Points) -> Found:
        return field.search(source, poses[later], reach, turn)

    return _laid(keyframes, poses, earlier, later, near, bar)


def recognised(
    keyframes: Sequence[Keyframe], poses: NDArray[np.float64], earlier: int
) -> Loop | None:
    """Do so with the last keyframe, where it may be at or near an earlier one, turned any way."""

    def anywhere(field: Field, source: Points) -> Found:
        rough = field.search(source, poses[earlier], WITHIN, pi, COARSE)
        return field.search(source, rough.pose, AGAIN, AGAIN_TURN)

    return _laid(keyframes, poses, earlier, len(keyframes) - 1, anywhere, BY_LIKENESS)


def seen_till(
    keyframes: Sequence[Keyframe], poses: NDArray[np.float64], number: int, behind: int = BEHIND
) -> Points:
    """Return what a keyframe and those just before it saw, in its frame, m, shape (n, 2)."""
    numbers = beside(keyframes, poses, number, behind, 0)
    seen = np.array([between(poses[number], poses[each]) for each in numbers])
    return joined([keyframes[each] for each in numbers], seen, range(len(numbers)), CELL)


def seen_through(scan: LaserScan, pose: Array, points: Points) -> float:
    """Return what a scan says against points: the share of those in view that it sees through.

    Parameters
    ----------
    scan : LaserScan
        What is seen.
    pose : ndarray, shape (3,)
        Where the robot is.
    points : ndarray, shape (n, 2)
        Walls, in the frame of the pose, m.
    """
    scanner = compose(pose, array_of(scan.mount))
    dx, dy = (points - scanner[:2]).T
    first = scan.angles[0]
    bearing = (np.arctan2(dy, dx) - scanner[2] - first) % (2 * pi) + first
    beam = np.minimum(np.searchsorted(scan.angles, bearing), len(scan.angles) - 1)
    valid = scan.valid()[beam] & (bearing <= scan.angles[-1])
    further = scan.ranges[beam] - np.hypot(dx, dy)
    through = int((valid & (further > BEYOND)).sum())
    same = int((valid & (np.abs(further) <= NEAR)).sum())
    return through / max(through + same, 1)


def _laid(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    earlier: int,
    later: int,
    search: Search,
    bar: Bar,
) -> Loop | None:
    target = joined(keyframes, poses, beside(keyframes, poses, earlier, AROUND, AROUND), CELL)
    source = seen_till(keyframes, poses, later)
    if min(len(target), len(source)) < NEIGHBOURS:
        return None
    field = Field(target)
    found = search(field, source)
    if found.score < bar.score:
        return None
    match = Target(target).match(source, found.pose)
    share = float((field.distances(moved(source, match.pose)) <= NEAR).mean())
    information, untold = told(match, len(source))
    if share < bar.share or untold > 1:
        return None
    if bar.through < 1 and seen_through(keyframes[later].scan, match.pose, target) > bar.through:
        return None
    covariance = np.linalg.inv(information + np.diag(WORST**-2)) + np.diag(BEST**2)
    relative = between(poses[earlier], match.pose)
    return Loop(earlier, later, relative, np.asarray(covariance), share)
