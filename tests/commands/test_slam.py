"""``slam=true``: poses are corrected while a log is read, and everything written is by them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from command_line import placecue, succeeds
from mcap_logs import Ros2Log
from placecue import LaserScan, Observation
from placecue.logs.reader import McapLog
from placecue.logs.writing.writer import McapWriter
from placecue.slam.straightened import Straightened
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
    with McapWriter(path, chunk_size=4000) as writer:
        for each in drive(ring(), TRUE, drifting(TRUE, stretch=1.05, veer=0.05)):
            writer.write(Observation(START + each.stamp, scan=each.scan, pose=each.pose))
    return path


def last_error(out: Path) -> float:
    """How far a corrected trajectory ends from where the robot was, m."""
    x, y = np.loadtxt(out / "trajectory.tum")[-1, 1:3]
    return float(np.hypot(x - TRUE[-1, 0], y - TRUE[-1, 1]))


def test_label_writes_corrected_poses(tmp_path: Path, laser_model: Path, drifted: Path) -> None:
    out = tmp_path / "out"
    told = placecue("label", str(laser_model), str(drifted), "slam=true", f"out={out}")
    assert told.status == 0, told.err
    assert "trajectory.tum" in told.out
    assert "scans laid on the map" in told.err
    assert last_error(out) < 0.1
    corrected = [each.pose for each in McapLog(str(out / "annotated.mcap"))]
    assert {pose.frame for pose in corrected} == {"map"}
    assert "single belief" in (out / "semantic_map.svg").read_text()
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


def test_classify_writes_corrected_poses(tmp_path: Path, laser_model: Path, drifted: Path) -> None:
    out = tmp_path / "out"
    told = placecue("classify", str(laser_model), str(drifted), "slam=true", f"out={out}")
    assert told.status == 0, told.err
    assert last_error(out) < 0.1
    assert {each.pose.frame for each in McapLog(str(out / "beliefs.mcap"))} == {"map"}


def test_info_shows_the_corrected_way(drifted: Path) -> None:
    def height(*words: str) -> float:
        told = placecue("info", str(drifted), *words)
        assert told.status == 0, told.err
        return float(re.search(r"wide and (\S+) m high", told.out)[1])

    true = np.ptp(TRUE[:, 1])
    assert height() > true + 0.5  # the wheels veer
    assert height("slam=true") == pytest.approx(true, abs=0.3)


def test_live_follows_with_corrected_poses(
    tmp_path: Path, laser_model: Path, drifted: Path
) -> None:
    robots, out = pytest.importorskip("robots"), tmp_path / "out"
    with robots.robot(robots.recorded(drifted)) as sends:
        told, _ = robots.followed_live(
            *(sends, ("/scan", "/odom"), len(TRUE) - 1),  # the last waits for a pose
            *(str(laser_model), "slam=true", f"out={out}"),
        )
    assert told.status == 0, told.err
    assert last_error(out) < 0.3  # the pose before the last is 0.2 m off the end
    areas = json.loads((out / "semantic_map.json").read_text())["areas"]
    assert {area["frame"] for area in areas} == {"map"}
    for node in rows(out / "nodes.csv"):
        assert 0 < float(node["sigma_x_m"]) < 0.1


def test_a_log_cut_in_the_middle(tmp_path: Path, laser_model: Path, drifted: Path) -> None:
    whole, cut, out = drifted.read_bytes(), tmp_path / "cut.mcap", tmp_path / "out"
    cut.write_bytes(whole[: 3 * len(whole) // 5])
    told = placecue("label", str(laser_model), str(cut), "slam=true", f"out={out}")
    assert told.status == 0, told.err
    assert "cut.mcap" in told.err
    times = np.loadtxt(out / "trajectory.tum")
    assert 10 < len(times) < len(TRUE)
    at = round((times[-1, 0] - START / 1e9) / 0.2)
    assert np.hypot(*(times[-1, 1:3] - TRUE[at, :2])) < 0.1


def test_a_scanner_that_hangs_upside_down(tmp_path: Path) -> None:
    log = Ros2Log(tmp_path / "over.mcap")
    log.transform(0.0, "base_link", "laser", (0.0, 0.0, 0.5), {"x": 1.0, "y": 0, "z": 0, "w": 0})
    odometry = drifting(TRUE, stretch=1.05, veer=0.05)
    for each, pose in zip(drive(ring(), TRUE, odometry), odometry.tolist(), strict=True):
        log.odom(each.stamp / 1e9, *pose)
        turned = each.scan.ranges[::-1].tolist()
        log.scan(each.stamp / 1e9, turned, first=-np.pi / 2, step=np.pi / 180)
    source = Straightened(McapLog(log.close()))
    last = list(source)[-1].pose
    assert np.hypot(last.x - TRUE[-1, 0], last.y - TRUE[-1, 1]) < 0.1
