"""Fixtures that make logs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mcap_logs import JsonLog, Ros2Log


@pytest.fixture
def ros2(tmp_path: Path) -> Any:
    return lambda name="run.mcap", **options: Ros2Log(tmp_path / name, **options)


@pytest.fixture
def as_json(tmp_path: Path) -> Any:
    return lambda name="run.mcap", **options: JsonLog(tmp_path / name, **options)


@pytest.fixture
def small_log(ros2: Any) -> str:
    """Twenty scans at 10 Hz with odometry and labels, in several small chunks."""
    log = ros2("small.mcap", chunk_size=2000)
    for i in range(20):
        t = i * 0.1
        log.string(t, "corridor" if i < 10 else "office")
        log.odom(t, float(i), 0.0, 0.0)
        log.scan(t, [1.0 + i, 2.0, 3.0, 4.0])
    return log.close()
