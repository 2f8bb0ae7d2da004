"""A camera that dies: scans make the observations, and the rest of the log is not lost."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from placecue import Observation
from placecue.logs import open_log
from placecue.logs.info import summarise
from placecue.logs.writing.writer import McapWriter
from toys import SECOND, Walk

#: The walk has an image and a scan every fifth of a second, for 64 s.
STEP = SECOND // 5


def written(path: Path, keeps: Callable[[int], bool], scans: int = 1) -> str:
    """Write a walk whose camera works where it is said to, and whose laser is faster."""
    with McapWriter(path) as writer:
        for number, seen in enumerate(Walk()):
            for part in range(scans):
                stamp = seen.stamp + part * STEP // scans
                image = seen.image if part == 0 and keeps(number) else None
                about = {"scan": seen.scan, "pose": seen.pose, "label": seen.label}
                writer.write(Observation(stamp, image=image, **about))
    return str(path)


def test_from_the_middle_on(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    log = open_log(written(tmp_path / "log.mcap", lambda number: number < 160))
    with caplog.at_level(logging.WARNING):
        seen = list(log)
    assert [each.stamp for each in seen] == [number * STEP for number in range(320)]
    assert [each.has("image") for each in seen] == [True] * 160 + [False] * 160
    assert all(each.has("scan") and each.has("pose") for each in seen)
    assert [each.label for each in seen] == [each.label for each in Walk()]
    assert "160 observations are of scans alone, where the camera was silent" in caplog.text
    assert log.count() is None
    assert sum(summarise(log).labels.values()) == 320


def test_before_it_begins_and_in_the_middle(tmp_path: Path) -> None:
    silent = [*range(40), *range(100, 140)]
    log = open_log(written(tmp_path / "log.mcap", lambda number: number not in silent))
    seen = list(log)
    assert [each.stamp for each in seen] == [number * STEP for number in range(320)]
    assert [n for n, each in enumerate(seen) if not each.has("image")] == silent


def test_a_faster_laser_is_thinned(tmp_path: Path) -> None:
    log = open_log(written(tmp_path / "log.mcap", lambda number: number < 160, scans=4))
    seen = list(log)
    alone = np.array([each.stamp for each in seen if not each.has("image")])
    assert 155 <= len(alone) <= 215
    assert np.diff(alone).min() >= 0.75 * STEP


def test_some_images_lost_are_no_silence(tmp_path: Path) -> None:
    """Three in a row, 0.8 s from one to the next."""
    log = open_log(written(tmp_path / "log.mcap", lambda number: number % 50 >= 3))
    assert all(each.has("image") for each in log)
    assert log.camera_silence is None
    assert log.count() is not None


def test_a_slow_camera_is_not_silent(tmp_path: Path) -> None:
    """An image every 4 s."""
    log = open_log(written(tmp_path / "log.mcap", lambda number: number % 20 == 0))
    assert len(list(log)) == 16


def test_it_can_be_switched_off_and_is_another_log_then(tmp_path: Path) -> None:
    path = written(tmp_path / "log.mcap", lambda number: number < 160)
    off = open_log(path, silence=None)
    assert len(list(off)) == 160
    # Without scans there is nothing that could stand in; kept features go by number and digest.
    images = open_log(path, parts=["image", "label"])
    assert len(list(images)) == 160
    assert images.digest() != open_log(path).digest()
    whole = written(tmp_path / "whole.mcap", lambda number: True)
    assert open_log(whole, parts=["image"]).digest() == open_log(whole).digest()
