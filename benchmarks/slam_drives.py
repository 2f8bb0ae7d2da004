"""Drives for benchmarks/slam.py: observations with odometry, and poses that are known better."""

from __future__ import annotations

import gzip
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from placecue import Observation, Pose2D
from placecue.logs.reader import McapLog
from placecue.logs.rosbag import RosbagLog
from placecue.slam.account import Account
from placecue.slam.mapper import Mapper
from placecue.slam.planar import array_of, between, compose
from placecue.source import Source
from placecue_office.drive import odometry
from placecue_office.simulator import Office
from placecue_sources.carmen import CarmenLog

Poses = NDArray[np.float64]


@dataclass
class Drive:
    """Observations with odometry.

    Parameters
    ----------
    observations : list of Observation
        With scans; their poses are what the wheels say, if they say anything.
    true : ndarray or None
        Poses that are known better, shape (n, 3).
    """

    observations: list[Observation]
    true: Poses | None = None

    @cached_property
    def stamps(self) -> NDArray[np.int64]:
        return np.array([each.stamp for each in self.observations])

    @cached_property
    def raw(self) -> Poses:
        return np.array(
            [
                [np.nan] * 3 if each.pose is None else array_of(each.pose)
                for each in self.observations
            ]
        )

    @property
    def way(self) -> float:
        driven = self.raw[~np.isnan(self.raw[:, 0])] if self.true is None else self.true
        return float(np.hypot(*np.diff(driven[:, :2], axis=0).T).sum())

    def at(self, poses: Poses) -> Iterator[Observation]:
        """Yield the observations at other poses, where they are known."""
        for each, pose in zip(self.observations, poses.tolist(), strict=True):
            if np.isfinite(pose).all():
                yield each.placed(Pose2D(*pose, "map"))


@dataclass
class Found:
    """What became of a drive: poses as they were told at once, and as known at the end."""

    told: Poses
    final: Poses
    account: Account
    seconds: float


def drives(drive: Drive) -> Found:
    """Correct the poses of a drive."""
    mapper, told = Mapper(), []
    begun = time.process_time()
    for observation in drive.observations:
        told.append(array_of(mapper.follow(observation)[0]))
    seconds = time.process_time() - begun
    at = np.searchsorted(mapper.trajectory.stamps(), drive.stamps, side="right") - 1
    final = mapper.trajectory.poses(mapper.poses)[np.maximum(at, 0)]
    return Found(np.array(told), final, mapper.account, seconds)


@lru_cache(maxsize=2)
def true_drive(floor: str, seed: int, run: int = 1) -> tuple[list[Observation], Poses]:
    """Return what is seen on a drive through a simulated floor, and the true poses."""
    seen = list(Office(world=floor, seed=seed, run=run, pose="truth"))
    return seen, np.array([array_of(each.pose) for each in seen])


def office_drive(floor: str, seed: int, drift: float) -> Drive:
    """Return a drive through a simulated floor by wheels that err by so much of way and turns."""
    seen, true = true_drive(floor, seed)
    told = odometry(true, drift, np.random.default_rng((seed, round(1000 * drift))))
    raw = [Pose2D(*pose) for pose in told.tolist()]
    pairs = zip(seen, raw, strict=True)
    return Drive([Observation(each.stamp, scan=each.scan, pose=pose) for each, pose in pairs], true)


def carried_drive(floor: str, seed: int, drift: float) -> tuple[Drive, int]:
    """Return half a drive, and a third of another on the same floor, and where that begins.

    Between the two the robot is carried to where the second begins; its wheels notice nothing. In
    the second drive things stand elsewhere, and it goes another way.
    """
    (seen, true), (again, where) = true_drive(floor, seed), true_drive(floor, seed, run=2)
    half, third = len(seen) // 2, len(again) // 3
    rng = np.random.default_rng((seed, round(1000 * drift)))
    raw, more = odometry(true[:half], drift, rng), odometry(where[:third], drift, rng)
    on = np.array([compose(raw[-1], between(more[0], pose)) for pose in more])
    step = seen[1].stamp - seen[0].stamp
    stamps = seen[0].stamp + step * np.arange(half + third)
    scans = [each.scan for each in (*seen[:half], *again[:third])]
    poses = [Pose2D(*pose) for pose in np.vstack([raw, on]).tolist()]
    made = [
        Observation(int(stamp), scan=scan, pose=pose)
        for stamp, scan, pose in zip(stamps, scans, poses, strict=True)
    ]
    return Drive(made, np.vstack([true[:half], where[:third]])), half


def carmen_drive(name: str) -> Drive:
    """Return a recorded log with its raw odometry, and the poses that others corrected it to."""
    path = Path(os.environ["PLACECUE_DATA"]) / "carmen" / f"{name}-corrected.log.gz"
    raw, observations, true = raw_odometry(path), [], []
    for each in CarmenLog(str(path)):
        pose = Pose2D(*raw[each.stamp].tolist(), "odom")
        observations.append(Observation(each.stamp, scan=each.scan, pose=pose))
        true.append(array_of(each.pose))
    return Drive(observations, np.array(true))


def raw_odometry(path: Path) -> dict[int, Poses]:
    """Return where odometry alone leads, by the stamps of scans, from the first corrected pose.

    The logs hold no whole raw odometry, but its steps: of each scan the ``ODOM`` record before it
    lies where odometry leads from the corrected pose of the scan before, in the order of the file.
    """
    found: dict[int, Poses] = {}
    corrected = told = raw = None
    with gzip.open(path, "rt", errors="replace") as lines:
        for line in lines:
            word, *fields = line.split() or [""]
            if word == "ODOM" and float(fields[-3]) > 0:
                told = np.array(fields[:3], dtype=float)
            elif word == "FLASER" and told is not None:
                before, corrected = corrected, np.array(fields[-9:-6], dtype=float)
                raw = corrected if raw is None else compose(raw, between(before, told))
                found[round(float(fields[-3]) * 1e9)] = raw
    return found


def bag_drive(name: str) -> Drive:
    """Return a robot's log, as it was recorded."""
    path = Path(os.environ["PLACECUE_DATA"]) / "bags" / name
    kind: type[McapLog] = RosbagLog
    log: Source = kind(str(path), parts=["scan", "pose"])
    return Drive([each for each in log if each.scan is not None])
