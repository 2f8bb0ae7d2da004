"""A drive as a recording of rerun, read back by rerun's own SDK where it is installed."""

import re
import subprocess
import sys

import numpy as np
import pytest

from placecue import (
    Area,
    LaserScan,
    Node,
    Observation,
    OneAgainstAll,
    Pose2D,
    Scores,
    SemanticMap,
    UsageError,
)
from placecue.belief import Belief
from placecue.logs.writing.rerun_log import RerunLog

CLASSES = ("kitchen", "office")
RING = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0))


def recorded(path):
    scores = Scores(np.array([[0.5, -0.5]]), OneAgainstAll(CLASSES))
    scan = LaserScan(np.zeros(1), np.ones(1), 0.1, 10.0)
    with RerunLog(path, CLASSES) as recording:
        for i in range(3):
            moment = Observation(10**9 * i, pose=Pose2D(i, 0, 0.5), scan=scan)
            recording.observe(moment, Belief(i, scores, "kitchen", 1.0, {}), None)
        area = Area(0, "kitchen", 0.9, trajectory=((0.0, 0.0),), surface=((RING,),))
        nodes = (Node(0, 0, 0, 0), Node(1, 2, 0, 0, True))
        recording.close_with(SemanticMap((area,), nodes, ((0, 1),), CLASSES))


def test_a_drive_and_its_map_are_read_back(tmp_path):
    pytest.importorskip("rerun", reason="placecue[rerun] is not installed: its wheel is 150 MB")
    path = tmp_path / "drive.rrd"
    recorded(path)
    told = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "print", str(path)],
        capture_output=True,
        text=True,
        check=True,
    )
    paths = set(re.findall(r"/[a-z_/]+", told.stdout))
    assert {"/world/robot", "/world/robot/scan", "/world/beliefs", "/belief"} <= paths
    assert {f"/world/map/{name}" for name in ("surfaces", "nodes", "doors", "names")} <= paths


def test_without_the_sdk_the_line_to_type_is_said(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(UsageError, match=r"pip install 'placecue\[rerun\]'"):
        recorded(tmp_path / "drive.rrd")
