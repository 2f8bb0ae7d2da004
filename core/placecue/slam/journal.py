"""What was seen and believed, kept so that it can be told again at other poses."""

from __future__ import annotations

import pickle
from array import array
from tempfile import SpooledTemporaryFile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.belief import Belief
from placecue.correction import Correction
from placecue.observation import LaserScan, Observation, Pose2D

#: Up to so many bytes are held in memory; the rest goes into a temporary file.
HELD = 1 << 25


class Journal:
    """Observations without their images, with beliefs; poses stay in memory, and move.

    The rest of each takes about 2 kB in a temporary file that has no name and is gone with the
    process.
    """

    def __init__(self) -> None:
        self._stamps, self._poses, self._frames = array("q"), array("d"), array("q")
        self._names: dict[str, int] = {}  # of frames
        self._starts = array("q", [0])
        self._file = SpooledTemporaryFile(max_size=HELD)  # noqa: SIM115
        self._angles: list[NDArray[np.float64]] = []  # the same for most scans

    def __len__(self) -> int:
        return len(self._stamps)

    def add(self, observation: Observation, belief: Belief | None) -> None:
        """Keep a moment."""
        pose = observation.pose
        told = (np.nan,) * 3 if pose is None else (pose.x, pose.y, pose.theta)
        frame = "" if pose is None else pose.frame
        self._stamps.append(observation.stamp)
        self._poses.extend(told)
        self._frames.append(self._names.setdefault(frame, len(self._names)))
        scan = None if observation.scan is None else self._parts(observation.scan)
        rest = (scan, observation.label, observation.log_name, pose is None, belief)
        self._file.seek(self._starts[-1])
        self._file.write(pickle.dumps(rest, pickle.HIGHEST_PROTOCOL))
        self._starts.append(self._file.tell())

    def move(self, correction: Correction) -> None:
        """Move the poses to where they are known to be now."""
        if correction.frame not in self._names:
            return
        number = self._names[correction.frame]
        rows = np.flatnonzero(np.frombuffer(self._frames, dtype=np.int64) == number)
        poses = np.frombuffer(self._poses, dtype=np.float64).reshape(-1, 3)
        stamps = np.frombuffer(self._stamps, dtype=np.int64)
        poses[rows] = correction.moved(stamps[rows], poses[rows])

    def read(self, number: int) -> tuple[Observation, Belief | None]:
        """Return a moment, at its pose of now."""
        start, end = self._starts[number : number + 2]
        self._file.seek(start)
        scan, label, name, lost, belief = pickle.loads(self._file.read(end - start))  # its own
        x, y, theta = self._poses[3 * number : 3 * number + 3]
        frame = list(self._names)[self._frames[number]]
        observation = Observation(
            self._stamps[number],
            scan=None if scan is None else LaserScan(self._angles[scan[0]], *scan[1:]),
            pose=None if lost else Pose2D(x, y, theta, frame),
            label=label,
            log_name=name,
        )
        return observation, belief

    def _parts(self, scan: LaserScan) -> tuple[Any, ...]:
        """Return a scan as plain data, its lengths in 32 bits where that loses nothing."""
        if not self._angles or not np.array_equal(self._angles[-1], scan.angles):
            self._angles.append(scan.angles)
        short = scan.ranges.astype(np.float32)
        exact = np.array_equal(short, scan.ranges, equal_nan=True)
        ranges = short if exact else scan.ranges
        return len(self._angles) - 1, ranges, scan.range_min, scan.range_max, scan.mount
