"""Streaming matches against what a look at the whole log gives."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue.logs import open_log
from placecue.logs.joining.items import Item
from placecue.logs.joining.synchronise import Match, Synchroniser, interpolate
from placecue.logs.writing.writer import McapWriter
from placecue.observation import LaserScan, Observation, Pose2D

TOLERANCE, WINDOW, GAP = 50, 400, 10_000


def joined(items: list[Item], driver: Any, followers: list[Any]) -> tuple[list[Match], int]:
    synchroniser = Synchroniser(driver, followers, TOLERANCE, WINDOW, GAP)
    matches = [match for item in items for match in synchroniser.push(item)]
    return [*matches, *synchroniser.finish()], synchroniser.late


def item(stamp: int, role: Any) -> Item:
    return Item(stamp, role, lambda: stamp)


times = st.lists(st.integers(1, 3000), unique=True, min_size=1, max_size=40)


@settings(max_examples=200, deadline=None)
@given(images=times, scans=times, poses=times, data=st.data())
def test_streaming_finds_what_a_look_at_everything_finds(
    images: list[int], scans: list[int], poses: list[int], data: st.DataObject
) -> None:
    stamps = {"image": images, "scan": scans, "pose": poses}
    # Each topic has a delay of its own; a topic's messages stay in order.
    delays = {role: data.draw(st.integers(0, WINDOW - 100), label=role) for role in stamps}
    events = sorted(
        (stamp + delays[role], role, stamp) for role, all_of in stamps.items() for stamp in all_of
    )
    matches, late = joined([item(s, r) for _, r, s in events], "image", ["scan", "pose"])
    assert late == 0
    assert [match.driver.stamp for match in matches] == sorted(images)
    for match in matches:
        t = match.driver.stamp
        distance = min(abs(stamp - t) for stamp in scans)
        if distance <= TOLERANCE:
            assert match.scan is not None
            assert abs(match.scan.stamp - t) == distance
        else:
            assert match.scan is None
        before = max((s for s in poses if s <= t), default=None)
        after = min((s for s in poses if s >= t), default=None)
        if before is not None and after is not None and after - t < WINDOW - delays["pose"]:
            expected = (before,) if before == t else (before, after)
            assert tuple(pose.stamp for pose in match.poses) == expected


def test_a_driver_does_not_wait_longer_than_the_window() -> None:
    synchroniser = Synchroniser("image", ["scan"], TOLERANCE, WINDOW, GAP)
    assert list(synchroniser.push(item(1000, "image"))) == []
    assert list(synchroniser.push(item(1399, "image"))) == []
    (match,) = synchroniser.push(item(1400, "image"))
    assert match.driver.stamp == 1000
    assert match.scan is None


def test_what_comes_too_late_is_left_out_and_counted() -> None:
    items = [item(1000, "scan"), item(5000, "scan"), item(2000, "scan")]
    matches, late = joined(items, "scan", [])
    assert [match.driver.stamp for match in matches] == [1000, 5000]
    assert late == 1


def test_one_wild_stamp_does_not_spoil_the_rest() -> None:
    stamps = [100, 200, 300, 400]
    items = [each for stamp in stamps for each in (item(stamp, "scan"), item(stamp, "image"))]
    for role in ("image", "scan"):
        spoilt = [*items[:4], item(999_999, role), *items[4:]]
        matches, late = joined(spoilt, "image", ["scan"])
        assert late == 0
        assert [match.driver.stamp for match in matches][:4] == stamps
        assert [match.scan.stamp for match in matches[:4] if match.scan] == stamps


@pytest.mark.parametrize(
    ("before", "after", "share", "expected"),
    [(0.0, 1.0, 0.25, 0.25), (3.0, -3.0, 0.5, np.pi), (-3.0, 3.0, 0.5, -np.pi), (1, 1, 0.7, 1)],
)
def test_interpolation(before: float, after: float, share: float, expected: float) -> None:
    pose = interpolate(Pose2D(0, 0, before, "map"), Pose2D(4, -8, after, "map"), share)
    assert (pose.x, pose.y) == pytest.approx((4 * share, -8 * share))
    assert pose.theta == pytest.approx(expected)
    assert pose.frame == "map"


def peak(path: Path, count: int) -> int:
    """Return the most memory that reading a log of so many observations takes, bytes."""
    image = np.random.default_rng(0).integers(0, 255, (40, 40), np.uint8)
    scan = LaserScan(np.linspace(-1, 1, 100), np.ones(100), 0.0, 10.0)
    with McapWriter(path, chunk_size=50_000, compression="none") as writer:
        for i in range(count):
            pose = Pose2D(float(i), 0.0, 0.0)
            writer.write(Observation(i * 10**8, image=image, scan=scan, pose=pose, label="x"))
    log = open_log(path)
    tracemalloc.start()
    assert sum(1 for _ in log) == count
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def test_memory_does_not_grow_with_the_log(tmp_path: Path) -> None:
    peak(tmp_path / "warm.mcap", 30)  # imports and caches
    short, long = peak(tmp_path / "a.mcap", 100), peak(tmp_path / "b.mcap", 1000)
    assert long < 1.25 * short
