"""An hour's drive: how fast poses are corrected, and what it takes of memory."""

from __future__ import annotations

import gc
import time
from pathlib import Path
from typing import Any

import numpy as np
from slam_drives import office_drive

from placecue import Observation, Pose2D
from placecue.slam.mapper import Mapper
from placecue_office.drive import odometry

#: Scans a second; what the wheels err by; and how many scans that is in an hour.
RATE, DRIFT, SCANS = 5, 0.03, 18_000


def hour() -> dict[str, Any]:
    """Follow a robot that drives a floor's tour to and fro for an hour."""
    drive = office_drive("second_floor", 0, DRIFT)
    count, known = len(drive.observations), drive.true
    assert known is not None
    turns = [order for _ in range(SCANS // (2 * count) + 1) for order in (1, -1)]
    order = np.concatenate([np.arange(count)[::each] for each in turns])[:SCANS]
    true = known[order]
    raw = odometry(true, DRIFT, np.random.default_rng(0))
    mapper, took, now = Mapper(), np.empty(SCANS), time.process_time
    first = Mapper()
    for observation in drive.observations[:50]:  # so that what is imported is not counted
        first.follow(observation)
    gc.collect()
    before = _resident()
    for number, at in enumerate(order.tolist()):
        pose = Pose2D(*raw[number].tolist())
        stamp = number * 10**9 // RATE
        observation = Observation(stamp, scan=drive.observations[at].scan, pose=pose)
        begun = now()
        mapper.follow(observation)
        took[number] = now() - begun
    gc.collect()
    ms = 1000 * took
    return {
        "scans": SCANS,
        "hours": SCANS / RATE / 3600,
        "way": float(np.hypot(*np.diff(true[:, :2], axis=0).T).sum()),
        "per_second": float(SCANS / took.sum()),
        "median_ms": float(np.median(ms)),
        "late_ms": float(np.quantile(ms, 0.99)),
        "worst_ms": float(ms.max()),
        "late_ms_of_last_tenth": float(np.quantile(ms[-SCANS // 10 :], 0.99)),
        "keyframes": len(mapper.keyframes),
        "bytes": (_resident() - before) / SCANS,
        "loops": mapper.account.loops,
    }


def _resident() -> int:
    pages = Path("/proc/self/statm").read_text().split()[1]
    return int(pages) * 4096
