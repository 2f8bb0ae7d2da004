"""Logs of a robot in four rooms, and models trained on one of them."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import succeeds
from mcap_logs import Ros2Log
from rooms import Rooms, write_log


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands write into folders of the tests only."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("commands")


@pytest.fixture(scope="session")
def log_a(shared: Path) -> Path:
    return write_log(shared / "a.mcap", Rooms(seed=0))


@pytest.fixture(scope="session")
def log_b(shared: Path) -> Path:
    return write_log(shared / "b.mcap", Rooms(seed=1))


@pytest.fixture(scope="session")
def laser_model(shared: Path, log_a: Path) -> Path:
    out = shared / "laser"
    few = "cues.laser.classifier.search.gamma=[0.01,0.1]"
    succeeds("train", "cue=laser", "integrator=none", few, f"log={log_a}", f"out={out}")
    return out


@pytest.fixture(scope="session")
def labelled(shared: Path, laser_model: Path, log_b: Path) -> Path:
    """What label makes of the second log, one observation at a time."""
    out = shared / "labelled"
    succeeds("label", f"model={laser_model}", f"log={log_b}", "batch=1", f"out={out}")
    return out


@pytest.fixture(scope="session")
def model(shared: Path, log_a: Path) -> Path:
    out = shared / "both"
    parts = {"cues.crfh": 1, "cues.laser": 0.01, "integrator": 0.1}
    few = [f"{each}.classifier.search.gamma=[{gamma}]" for each, gamma in parts.items()]
    words = ["cue=[crfh,laser]", "integrator=svm_das", *few]
    succeeds("train", *words, f"log={log_a}", f"out={out}")
    return out


@pytest.fixture(scope="session")
def plan(shared: Path) -> Path:
    """Two rooms and a hallway of 8 m by 6 m, 0.05 m a pixel, in the default grey values."""
    picture = np.zeros((120, 160), np.uint8)
    picture[70:110, 10:150] = 115  # hallway, 2 m wide
    for left in (10, 85):
        picture[10:65, left : left + 65] = 77  # room
        picture[65:70, left + 20 : left + 40] = 179  # doorway
    path = shared / "plan.png"
    cv2.imwrite(str(path), picture)
    return path


@pytest.fixture(scope="session")
def two_lasers(shared: Path) -> Path:
    """Twenty scans of each of two lasers, in two places."""
    path = shared / "two_lasers.mcap"
    log = Ros2Log(path)
    for i in range(20):
        log.string(0.1 * i, "corridor" if i < 10 else "office")
        for topic in ("/front", "/rear"):
            log.scan(0.1 * i, [1.0 + i, 2.0, 3.0, 4.0, 5.0], topic=topic)
    log.close()
    return path
