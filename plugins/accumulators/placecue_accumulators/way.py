"""The robot's way: how far it has driven and turned, and where it is broken off."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import hypot, isfinite, pi
from typing import Literal

from placecue.observation import Pose2D
from placecue_accumulators.evidence import ROUNDING
from placecue_accumulators.histogram import Key

#: What became of the way: it goes on, is in another frame, goes on somewhere else, or further on
#: after a stretch that nothing is known of.
Turn = Literal["on", "frame", "jump", "gap"]


def is_pose(pose: Pose2D | None) -> bool:
    """Tell whether there is a pose of finite numbers."""
    return pose is not None and all(map(isfinite, (pose.x, pose.y, pose.theta)))


@dataclass(frozen=True, slots=True)
class Moment:
    """Where the robot was, for boundaries that are noticed later.

    Parameters
    ----------
    way : float
        How far it had driven, m.
    stamp : int
        When, ns.
    node : int or None
        The node it was at.
    key : tuple of int
        The bin of its position.
    of_area, of_node : int
        Viewpoints so far in the two histograms.
    """

    way: float
    stamp: int
    node: int | None
    key: Key
    of_area: int
    of_node: int


class Odometer:
    """Follows poses.

    Parameters
    ----------
    longest_step : float
        A larger distance between one pose and the next is a jump, m, unless there was time for it.
    fastest : float
        The speed that there is time for, m/s.
    longest_gap : float
        A larger distance is a gap even if there was time for it, m.
    """

    def __init__(
        self, longest_step: float = 2.0, fastest: float = 3.0, longest_gap: float = 5.0
    ) -> None:
        self.longest_step = longest_step
        self.fastest = fastest
        self.longest_gap = longest_gap
        self.pose: Pose2D | None = None
        self.stamp = 0
        self.theta = 0.0
        self.way = 0.0

    @property
    def frame(self) -> str:
        """The frame of the last pose."""
        return self.pose.frame if self.pose else "odom"

    def follow(self, pose: Pose2D, stamp: int) -> Turn:
        """Take in the next pose; the heading is unwrapped."""
        last, seconds = self.pose, (stamp - self.stamp) / 1e9
        self.pose, self.stamp = pose, stamp
        if last is None:
            self.theta = pose.theta
            return "on"
        self.theta += (pose.theta - last.theta + pi) % (2 * pi) - pi
        if last.frame != pose.frame:
            return "frame"
        step = hypot(pose.x - last.x, pose.y - last.y)
        if step > max(self.longest_step, self.fastest * seconds):
            return "jump"
        if step > self.longest_gap:
            return "gap"
        self.way += step
        return "on"


class Recent:
    """The last metres of the way.

    Parameters
    ----------
    length : float
        How many, m.
    """

    def __init__(self, length: float) -> None:
        self.length = length
        self._moments: deque[Moment] = deque()

    def add(self, moment: Moment) -> None:
        """Remember a moment, and forget those that are too far behind; standing adds nothing."""
        last = self._moments[-1] if self._moments else None
        if last is None or (moment.way, moment.node, moment.of_area) != (
            (last.way, last.node, last.of_area)
        ):
            self._moments.append(moment)
        while moment.way - self._moments[0].way > self.length:
            self._moments.popleft()

    def since(self, way: float) -> list[Moment]:
        """Return the moments since the robot had driven so far, m."""
        return [moment for moment in self._moments if moment.way >= way - ROUNDING]

    def clear(self) -> None:
        """Forget all."""
        self._moments.clear()
