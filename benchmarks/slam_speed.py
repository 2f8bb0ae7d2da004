"""How fast poses are corrected over an hour's drive, and what it takes of memory."""

from __future__ import annotations

import gc
import time
from collections.abc import Iterator
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from labelling_memory import corners, seen
from slam_drives import office_drive

from placecue import Observation, Pose2D
from placecue.slam.mapper import Mapper
from placecue_office.drive import odometry

#: Scans a second; what the wheels err by; and how many scans that is in an hour.
RATE, DRIFT, SCANS = 5, 0.03, 18_000
#: On new ground: m and rad from scan to scan, scans before memory is looked at, and scans after.
STEP, TURN, WARM, FRESH = 0.2, 0.24, 1000, 2500


def hour(scans: int = SCANS) -> dict[str, Any]:
    """Follow a robot that drives a floor's tour to and fro for an hour, then one on new ground."""
    drive = office_drive("second_floor", 0, DRIFT)
    count, known = len(drive.observations), drive.true
    assert known is not None
    turns = [order for _ in range(scans // (2 * count) + 1) for order in (1, -1)]
    order = np.concatenate([np.arange(count)[::each] for each in turns])[:scans]
    true = known[order]
    raw = odometry(true, DRIFT, np.random.default_rng(0))
    mapper, took, now = Mapper(), np.empty(scans), time.process_time
    grown: list[tuple[int, int, int]] = []  # scans, bytes of the process, keyframes
    for number, at in enumerate(order.tolist()):
        if number % count == 0:
            grown.append((number, _resident(), len(mapper.keyframes)))
        pose = Pose2D(*raw[number].tolist())
        stamp = number * 10**9 // RATE
        observation = Observation(stamp, scan=drive.observations[at].scan, pose=pose)
        begun = now()
        mapper.follow(observation)
        took[number] = now() - begun
    ms = 1000 * took
    return {
        "scans": scans,
        "hours": scans / RATE / 3600,
        "way": float(np.hypot(*np.diff(true[:, :2], axis=0).T).sum()),
        "per_second": float(scans / took.sum()),
        "median_ms": float(np.median(ms)),
        "late_ms": float(np.quantile(ms, 0.99)),
        "worst_ms": float(ms.max()),
        "late_ms_of_last_tenth": float(np.quantile(ms[-scans // 10 :], 0.99)),
        "keyframes": len(mapper.keyframes),
        "loops": mapper.account.loops,
        "off": float(np.hypot(*(mapper.trajectory.poses(mapper.poses)[-1] - true[-1])[:2])),
        "grown": grown,
        **new_ground(),
    }


def new_ground() -> dict[str, Any]:
    """Follow a robot through an endless row of like rooms, of which it looks into every third."""
    drive = list(islice(_ahead(), WARM + FRESH))
    true = np.array([(each.pose.x, each.pose.y, each.pose.theta) for each in drive])
    raw = odometry(true, DRIFT / 3, np.random.default_rng(1)).tolist()
    mapper, before, kept = Mapper(), 0, 0
    for number, each in enumerate(drive):
        if number == WARM:
            before, kept = _resident(), len(mapper.keyframes)
        mapper.follow(Observation(each.stamp, scan=each.scan, pose=Pose2D(*raw[number])))
    return {
        "bytes": (_resident() - before) / FRESH,
        "keyframe_bytes": (_resident() - before) / (len(mapper.keyframes) - kept),
        "new_off": float(np.hypot(*(mapper.trajectory.poses(mapper.poses)[-1] - true[-1])[:2])),
    }


def _ahead() -> Iterator[Observation]:
    lanes = dict[int, np.ndarray]()
    for number, pose in enumerate(_poses_ahead()):
        scan = seen(number, pose, lanes).scan
        yield Observation(number * 10**9 // RATE, scan=scan, pose=pose)


def _poses_ahead() -> Iterator[Pose2D]:
    heading = 0.0
    for (x1, y1), (x2, y2) in pairwise(corners()):
        length, before = np.hypot(x2 - x1, y2 - y1), heading
        heading = float(np.arctan2(y2 - y1, x2 - x1))
        turn = (heading - before + np.pi) % (2 * np.pi) - np.pi
        for angle in before + np.sign(turn) * np.arange(TURN, abs(turn), TURN):
            yield Pose2D(x1, y1, float(angle))
        for t in np.arange(0, length, STEP) / length:
            yield Pose2D(float(x1 + t * (x2 - x1)), float(y1 + t * (y2 - y1)), heading)


def _resident() -> int:
    gc.collect()
    pages = Path("/proc/self/statm").read_text().split()[1]
    return int(pages) * 4096
