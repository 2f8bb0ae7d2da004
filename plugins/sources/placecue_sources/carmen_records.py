"""The records of a CARMEN log that hold laser scans and odometry, one small class each.

Field lists: CARMEN, the Carnegie Mellon Robot Navigation Toolkit, ``logger/readlog`` messages.
Every record ends in the time of the message (s), the host, and the time of logging (s).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from placecue.observation import LaserScan, Observation, Pose2D

Fields = Sequence[bytes]

# CARMEN's scanner where a record does not say: SICK LMS, which answers 81.83 m and more for "no
# measurement".
SICK_FIELD_OF_VIEW = 180.0
SICK_MAX_RANGE = 80.0

#: No robot is farther from any origin than once around the Earth, m.
FARTHEST = 4.1e7
#: What fits into 64 bits of nanoseconds, s.
LONGEST_TIME = 9_000_000_000


class MalformedRecord(ValueError):
    """A line that does not hold what its first word promises."""


class Record(ABC):
    """Turns the fields of one kind of line into an observation."""

    def read(self, fields: Fields) -> Observation | None:
        """Return the observation of a line, or None where its time is not after 0.

        Parameters
        ----------
        fields : sequence of bytes
            The line's words, the record's name left out.

        Raises
        ------
        MalformedRecord
            If there are too few or too many words, or one is not a number.
        """
        try:
            stamp = _nanoseconds(fields[-3])
            return self.observation(stamp, fields[:-3]) if stamp > 0 else None
        except (IndexError, ValueError, ArithmeticError) as error:
            raise MalformedRecord(str(error)) from error

    @abstractmethod
    def observation(self, stamp: int, fields: Fields) -> Observation:
        """Return the observation at ``stamp`` (ns) from the fields before the three of time."""


@dataclass(frozen=True, slots=True)
class OldLaser(Record):
    """``FLASER n r… x y θ odom_x odom_y odom_θ``: ranges and poses, the scanner left unsaid.

    Parameters
    ----------
    field_of_view : float or None
        Angle that the scanner covers, degrees; None is the SICK LMS's 180. An odd number of
        beams reaches from end to end (181 at 1°); of an even number the last is left out (180
        at 1°, 360 at 0.5°), as CARMEN's SICK driver does.
    max_range : float or None
        Longest range that is a measurement, m; None is 80, see ``SICK_MAX_RANGE``.
    odometry : bool
        Take the odometry's pose, not the corrected one.
    """

    field_of_view: float | None
    max_range: float | None
    odometry: bool

    def observation(self, stamp: int, fields: Fields) -> Observation:
        """Return scan and pose."""
        ranges, rest = _counted(fields)
        poses = _numbers(rest, 6)
        scan = LaserScan(
            angles=_angles(ranges.size, self.field_of_view),
            ranges=ranges,
            range_min=0.0,
            range_max=SICK_MAX_RANGE if self.max_range is None else self.max_range,
        )
        x, y, theta = poses[3:] if self.odometry else poses[:3]
        return Observation(stamp, scan=scan, pose=Pose2D(x, y, theta, _frame(self.odometry)))


@dataclass(frozen=True, slots=True)
class RobotLaser(Record):
    """``ROBOTLASER1``: the scanner's settings, ranges, remissions, and poses.

    The settings are type, start angle, field of view, angular resolution, maximum range, accuracy
    and remission mode; ranges and remissions begin with their number; the laser's pose, the
    robot's pose, and five numbers about its motion follow.

    Parameters
    ----------
    field_of_view : float or None
        Angle that the scanner covers, degrees; None is what the record says.
    max_range : float or None
        Longest range that is a measurement, m; None is what the record says.
    odometry : bool
        Whether the poses are odometry; the record has one pose of the robot either way.
    """

    field_of_view: float | None
    max_range: float | None
    odometry: bool

    def observation(self, stamp: int, fields: Fields) -> Observation:
        """Return scan, with the mounting of the laser on the robot, and the robot's pose."""
        _, start, _, step, longest, _, _ = _numbers(fields[:7], 7)
        ranges, rest = _counted(fields[7:])
        _, rest = _counted(rest, fewest=0)
        poses = _numbers(rest, 11)
        robot = Pose2D(poses[3], poses[4], poses[5], _frame(self.odometry))
        angles = start + step * np.arange(ranges.size, dtype=np.float64)
        scan = LaserScan(
            angles=angles
            if self.field_of_view is None
            else _angles(ranges.size, self.field_of_view),
            ranges=ranges,
            range_min=0.0,
            range_max=longest if self.max_range is None else self.max_range,
            mount=_relative(robot, poses[:3]),
        )
        return Observation(stamp, scan=scan, pose=robot)


@dataclass(frozen=True, slots=True)
class Odometry(Record):
    """``ODOM x y θ tv rv accel``: the wheels' pose alone."""

    def observation(self, stamp: int, fields: Fields) -> Observation:
        """Return the pose."""
        x, y, theta, _, _, _ = _numbers(fields, 6)
        return Observation(stamp, pose=Pose2D(x, y, theta, "odom"))


def _nanoseconds(field: bytes) -> int:
    """Return a time that is given in seconds, ns, to the last digit."""
    seconds = Decimal(field.decode())
    if not abs(seconds) < LONGEST_TIME:
        raise MalformedRecord(f"a time of {seconds} s")
    return int(seconds * 1_000_000_000)


def _frame(odometry: bool) -> str:
    return "odom" if odometry else "map"


def _numbers(fields: Fields, count: int) -> list[float]:
    """Return exactly ``count`` finite numbers."""
    if len(fields) != count:
        raise MalformedRecord(f"{len(fields)} numbers where {count} are due")
    numbers = [float(field) for field in fields]
    if not np.isfinite(numbers).all():
        raise MalformedRecord("a pose or setting is not finite")
    if numbers and max(map(abs, numbers)) > FARTHEST:
        raise MalformedRecord(f"a pose or setting of {max(map(abs, numbers)):g}")
    return numbers


def _counted(fields: Fields, fewest: int = 1) -> tuple[NDArray[np.float64], Fields]:
    """Return the numbers of a list that begins with its length, and the fields after it."""
    count = int(fields[0])
    if not fewest <= count < len(fields):
        raise MalformedRecord(f"{count} readings promised, {len(fields) - 1} numbers there")
    return np.array(fields[1 : count + 1]).astype(np.float64), fields[count + 1 :]


def _angles(beams: int, field_of_view: float | None) -> NDArray[np.float64]:
    """Return the beams' directions, rad, from the right end of the field of view."""
    full = np.deg2rad(SICK_FIELD_OF_VIEW if field_of_view is None else field_of_view)
    gaps = max(beams - beams % 2, 1)
    return np.asarray(-full / 2 + full / gaps * np.arange(beams), dtype=np.float64)


def _relative(robot: Pose2D, laser: Sequence[float]) -> Pose2D:
    """Return where the laser sits in the robot's frame."""
    x, y, theta = laser
    c, s = np.cos(robot.theta), np.sin(robot.theta)
    return Pose2D(
        x=float(c * (x - robot.x) + s * (y - robot.y)),
        y=float(c * (y - robot.y) - s * (x - robot.x)),
        theta=float(np.arctan2(np.sin(theta - robot.theta), np.cos(theta - robot.theta))),
        frame="base_link",
    )
