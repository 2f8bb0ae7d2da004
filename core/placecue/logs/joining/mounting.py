"""Where the laser sits on the robot."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from math import cos, isnan, radians

import numpy as np

from placecue.faults import Faults
from placecue.logs.joining.frames import named, plain
from placecue.logs.joining.transforms import TransformBuffer
from placecue.logs.messages.geometry import Matrix, flatten
from placecue.observation import LaserScan, Pose2D

log = logging.getLogger(__name__)

#: A laser tilted by more than this does not look along the floor, rad.
LEVEL = radians(10.0)
#: A tolerance that any transform meets, ns.
EVER = 2**64


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where a scanner sits.

    Parameters
    ----------
    pose : Pose2D
        In the robot's frame.
    flipped : bool
        Whether the scanner hangs upside down, so that its angles run clockwise.
    range_max : float
        Limit of scans whose messages do not say theirs, m.
    known : bool
        Whether transforms say so. If not, a scan whose message says where it lies is left there.
    """

    pose: Pose2D
    flipped: bool = False
    range_max: float = np.inf
    known: bool = True

    def place(self, scan: LaserScan) -> LaserScan:
        """Return a scan, given in its own frame, as it sits on the robot."""
        inner = scan.mount
        limit = self.range_max if isnan(scan.range_max) else scan.range_max
        if not self.flipped:
            here = inner.x == inner.y == inner.theta == 0.0
            mount = self.pose if here else self.pose.compose(inner) if self.known else inner
            return LaserScan(scan.angles, scan.ranges, scan.range_min, limit, mount)
        mirrored = Pose2D(inner.x, -inner.y, -inner.theta)
        return replace(
            scan,
            range_max=limit,
            angles=-scan.angles[::-1],
            ranges=scan.ranges[::-1].copy(),
            mount=self.pose.compose(mirrored),
        )


class Mountings:
    """Where lasers sit on the robot, by their frames, at the time of each scan.

    Parameters
    ----------
    buffer : TransformBuffer
        Transforms of the log; filled as it is read where something moves.
    base : str
        The robot's frame.
    laser : str or None
        The laser's frame, where it is not the one that scans name.
    range_max : float
        Limit of scans whose messages do not say theirs, m.
    faults : Faults
        Takes what had to be assumed.
    """

    def __init__(
        self,
        buffer: TransformBuffer,
        base: str,
        laser: str | None,
        range_max: float,
        faults: Faults,
    ) -> None:
        self.buffer = buffer
        self.base = base
        self.laser = laser
        self.range_max = range_max
        self.faults = faults
        self._held: dict[str, Mounting] = {}  # of those that do not move
        self._changes = buffer.changes  # when they were found

    def place(self, scan: LaserScan, stamp: int) -> LaserScan:
        """Return a scan of a time, given in its own frame, as it sits on the robot."""
        frame = scan.mount.frame if self.laser is None else self.laser
        if self._changes != self.buffer.changes:
            self._held.clear()
            self._changes = self.buffer.changes
        known = self._held.get(frame)
        return (known or self._mounting(frame, stamp)).place(scan)

    def _mounting(self, frame: str, stamp: int) -> Mounting:
        laser = named(plain(frame), self.buffer)
        steps = self.buffer.steps(self.base, laser)
        if steps and self.buffer.moving(self.base, laser):
            return self._at(laser, stamp)
        matrix = None if steps is None else self.buffer.lookup(self.base, laser, stamp)
        found = self._of(matrix, laser)
        if steps is None or self.buffer.holds(self.base, laser):
            self._held[frame] = found
        return found

    def _at(self, laser: str, stamp: int) -> Mounting:
        matrix = self.buffer.lookup(self.base, laser, stamp)
        if matrix is None:
            matrix = self.buffer.lookup(self.base, laser, stamp, EVER)
            kind = "scans lie where transforms of another time put their laser"
            self.faults.add(kind, f"at stamp {stamp}")
        return self._of(matrix, laser)

    def _of(self, matrix: Matrix | None, laser: str) -> Mounting:
        if matrix is None:
            centre = Pose2D(0.0, 0.0, 0.0, self.base)
            return Mounting(centre, range_max=self.range_max, known=False)
        if abs(matrix[2, 2]) < cos(LEVEL):
            tilt = np.degrees(np.arccos(min(abs(matrix[2, 2]), 1.0)))
            self.faults.add(
                "scans are read as if their laser were level",
                f"'{laser}' is tilted by {tilt:.0f} degrees against '{self.base}'",
            )
        return Mounting(flatten(matrix, self.base), bool(matrix[2, 2] < 0.0), self.range_max)


def check_mounting(buffer: TransformBuffer, base: str, laser: str, asked: bool, where: str) -> None:
    """Warn where transforms do not say where a laser sits.

    Parameters
    ----------
    buffer : TransformBuffer
        Transforms of the log.
    base, laser : str
        The frames of robot and laser.
    asked : bool
        Whether the user named the robot's frame.
    where : str
        Name of the log, for messages.
    """
    laser = named(plain(laser), buffer)
    if laser == base or (not buffer.edges and not asked) or buffer.connected(base, laser):
        return
    log.warning(
        f"{where}: no transform from '{base}' to the laser's frame '{laser}', so the laser is "
        f"taken to sit in the robot's centre; frames: {', '.join(sorted(buffer.frames()))}; "
        "set source.base_frame or source.laser_frame"
    )
