"""``slam=true``: poses are corrected while a log is read, and everything written is by them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from command_line import placecue, succeeds
from placecue import LaserScan, Observation
from placecue.logs.reader import McapLog
from placecue.logs.writing.writer import McapWriter
from results import rows
from slam_rooms import ROUND, drifting, drive, ring

pytest.importorskip("small_gicp")
pytest.importorskip("gtsam")

START = 1_700_000_000 * 10**9
#: One side of the block and the turn after it.
TRUE = ROUND[:60]


@pytest.fixture(scope="module")
def drifted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a robot whose wheels veer."""
    path = tmp_path_factory.mktemp("slam") / "drifted.mcap"
    with McapWriter(path) as writer:
        for each in drive(ring(), TRUE, drifting(TRUE, stretch=1.05, veer=0.05)):
            writer.write(Observation(START + each.stamp, scan=each.scan, pose=each.pose))
    return path


def test_label_writes_corrected_poses(tmp_path: Path, laser_model: Path, drifted: Path) -> None:
    out = tmp_path / "out"
    told = placecue("label", str(laser_model), str(drifted), "slam=true", f"out={out}")
    assert told.status == 0, told.err
    assert "trajectory.tum" in told.out
    assert "scans laid on the map" in told.err
    trajectory = np.loadtxt(out / "trajectory.tum")
    assert np.hypot(*(trajectory[-1, 1:3] - TRUE[-1, :2])) < 0.1
    corrected = [each.pose for each in McapLog(str(out / "annotated.mcap"))]
    assert {pose.frame for pose in corrected} == {"map"}
    for node in rows(out / "nodes.csv"):
        assert 0 < float(node["sigma_x_m"]) < 0.1
        assert 0 < float(node["sigma_heading_rad"]) < 0.05
    plain = succeeds("label", str(laser_model), str(drifted), f"out={tmp_path / 'plain'}")
    assert "trajectory.tum" not in plain.out
    assert {node["sigma_x_m"] for node in rows(tmp_path / "plain/nodes.csv")} == {""}


def test_without_scans_it_says_so_and_keeps_the_poses(tmp_path: Path, drifted: Path) -> None:
    empty = tmp_path / "blind.mcap"
    with McapWriter(empty) as writer:
        for each in list(McapLog(str(drifted)))[:5]:
            blind = LaserScan(each.scan.angles, np.full(181, np.inf), 0.05, 20.0)
            writer.write(Observation(each.stamp, scan=blind, pose=each.pose))
    told = placecue("convert", f"log={empty}", "slam=true", f"out={tmp_path / 'a.mcap'}")
    assert told.status == 0
    assert "no scan shows enough to correct poses by" in told.err
    before, after = ([o.pose for o in McapLog(str(p))] for p in (empty, tmp_path / "a.mcap"))
    np.testing.assert_allclose([(p.x, p.y) for p in after], [(p.x, p.y) for p in before], atol=1e-9)
