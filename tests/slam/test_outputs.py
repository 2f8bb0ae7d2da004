"""What corrected poses are written as, and how straight walls are told from smeared ones."""

from pathlib import Path

import numpy as np
import pytest

from placecue import Observation, Pose2D
from placecue.commands.straightening import advice
from placecue.logs.reader import McapLog
from placecue.logs.writing.writer import McapWriter
from placecue.sharpness import Sharpness
from placecue.slam.trajectory import tum
from slam_rooms import drifting, drive, ring, scan, way

#: Around the block and on along two sides that were seen before.
TWICE = way([(1, 1), (11, 1), (11, 9), (1, 9), (1, 1), (11, 1), (11, 6)], step=0.25, turn=0.5)


def sharpness_of(odometry):
    measured = Sharpness()
    for observation in drive(ring(), TWICE[: len(odometry)], odometry):
        measured.observe(observation)
    return measured


def test_walls_seen_again_where_they_were_are_sharp_and_others_are_smeared():
    straight, smeared = sharpness_of(TWICE), sharpness_of(drifting(TWICE, 1.01, 0.003))
    assert straight.seen.share > 0.9
    assert smeared.seen.share < 0.5
    assert not advice(straight)
    assert "slam=true" in advice(smeared)[0]


def test_what_was_seen_once_is_neither():
    assert sharpness_of(TWICE[:20]).seen.share is None
    assert not advice(Sharpness())


def test_evo_reads_the_trajectory(tmp_path: Path) -> None:
    interface = pytest.importorskip("evo.tools.file_interface")
    stamps = np.array([1_500_000_000_000_000_001, 1_500_000_000_250_000_000])
    poses = np.array([[1.5, -2.0, 0.0], [1.0, 3.25, 2.0]])
    (tmp_path / "poses.tum").write_text(tum(stamps, poses))
    read = interface.read_tum_trajectory_file(tmp_path / "poses.tum")
    np.testing.assert_allclose(read.positions_xyz, [[1.5, -2, 0], [1, 3.25, 0]])
    np.testing.assert_allclose(read.timestamps - 1.5e9, [0, 0.25], atol=1e-6)
    yaw = read.get_orientations_euler("sxyz")[:, 2]
    np.testing.assert_allclose(yaw, poses[:, 2], atol=1e-6)


@pytest.mark.parametrize("encoding", ["cdr", "json"])
def test_a_corrected_log_has_the_transforms_of_ros_and_its_poses_come_back(
    tmp_path: Path, encoding: str
) -> None:
    path, odometry = tmp_path / "a.mcap", [Pose2D(1.0, 0.0, 0.0), Pose2D(1.0, 1.0, np.pi / 2)]
    corrected = [Pose2D(0.0, 0.0, np.pi / 2, "map"), Pose2D(-1.0, 0.5, np.pi, "map")]
    seen = scan(ring(), np.array([1.0, 1.0, 0.0]))
    with McapWriter(path, encoding=encoding) as writer:
        for number, (pose, told) in enumerate(zip(corrected, odometry, strict=True), 1):
            writer.write(Observation(10**9 * number, scan=seen, pose=told).placed(pose))

    def poses(**options):
        log = McapLog(str(path), parts=["scan", "pose"], **options)
        return [(each.pose.x, each.pose.y, each.pose.theta, each.pose.frame) for each in log]

    def told(of):
        return [pytest.approx((p.x, p.y, p.theta)) for p in of]

    assert [each[:3] for each in poses()] == told(corrected)
    assert {each[3] for each in poses()} == {"map"}
    # map → odom → base_link is the corrected pose again, odom → base_link what was recorded.
    for frame, there in (("map", corrected), ("odom", odometry)):
        assert [each[:3] for each in poses(pose_topic="/tf", pose_frame=frame)] == told(there)
