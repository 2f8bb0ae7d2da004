"""Poses from scans on drives through drawn rooms, whose true poses are known."""

import numpy as np
import pytest

from placecue import LaserScan, Observation, Pose2D
from slam_rooms import (
    BEAMS,
    ROUND,
    around_the_block,
    box,
    carried_and_back,
    corrected_carried,
    corrected_round,
    drifting,
    drive,
    scan,
    way,
)

pytest.importorskip("small_gicp")
pytest.importorskip("gtsam")

from placecue.slam.loops import LoopFinder
from placecue.slam.mapper import Mapper
from placecue.slam.verifying import BEST, Loop

#: Between two moments of a drive, ns.
STAMP = 200_000_000
#: Around in a square room.
SQUARE = way([(2, 2), (4, 2), (4, 4), (2, 4), (2, 2.2)], step=0.1)
ROOM = [*box(0, 0, 6, 6), *box(2.8, 2.9, 3.2, 3.1)]


def followed(observations):
    """Return a mapper, the poses it told, shape (n, 3), and its late news."""
    mapper, poses, news = Mapper(), [], []
    for observation in observations:
        pose, correction = mapper.follow(observation)
        poses.append((pose.x, pose.y, pose.theta))
        news += [] if correction is None else [correction]
    return mapper, np.array(poses), news


def off(poses, true):
    """Return how far poses are from the truth, m, shape (n,)."""
    return np.hypot(*(poses - true)[:, :2].T)


@pytest.mark.parametrize("view", [180, 270, 360])
def test_a_square_room_keeps_a_drifting_robot_in_place(view):
    odometry = drifting(SQUARE, stretch=1.05, veer=0.06)
    angles = BEAMS[view]
    mapper, poses, _ = followed(drive(ROOM, SQUARE, odometry, angles=angles))
    assert off(odometry, SQUARE)[-1] > 0.5
    assert off(poses, SQUARE).max() < 0.06
    assert mapper.account.matched + mapper.account.still == len(SQUARE) - 1


def test_a_scanner_off_the_middle_that_looks_back_makes_no_difference():
    mount = Pose2D(-0.2, 0.1, np.pi, "base_link")
    odometry = drifting(SQUARE, stretch=1.05, veer=0.06)
    _, poses, _ = followed(drive(ROOM, SQUARE, odometry, mount=mount))
    assert off(poses, SQUARE).max() < 0.06


def test_without_odometry_scans_alone_tell_the_way():
    true = SQUARE[::2]
    mapper, poses, _ = followed(drive(ROOM, true, None, angles=BEAMS[360]))
    # Without odometry the map begins at the origin: where the first pose is.
    c, s = np.cos(true[0, 2]), np.sin(true[0, 2])
    back = (true[:, :2] - true[0, :2]) @ np.array([[c, -s], [s, c]])
    assert np.hypot(*(poses[:, :2] - back).T).max() < 0.08
    assert mapper.account.without == len(true) - 1


def test_the_length_of_a_corridor_is_what_odometry_says():
    # Two walls that go on beyond what the scanner sees: nothing tells how far the robot has gone.
    corridor = [(-60, 0, 60, 0), (-60, 2, 60, 2)]
    true = way([(0, 1), (6, 1)])
    odometry = drifting(true, stretch=1.05, veer=0.03)
    mapper, poses, _ = followed(drive(corridor, true, odometry))
    assert mapper.account.untold == mapper.account.matched > 20
    assert np.abs(poses[:, 1] - 1).max() < 0.03  # the walls tell the side and the heading
    assert np.abs(poses[:, 2]).max() < 0.02
    assert off(odometry, true)[-1] > 0.4
    # And along it 5 % too much, as the wheels say; their veering is taken out.
    assert poses[-1, 0] - 0 == pytest.approx(1.05 * true[-1, 0], abs=0.08)


def test_a_loop_is_closed_and_moves_what_was_told_before():
    odometry, observations = around_the_block()
    source, told = corrected_round()
    mapper, news = source.mapper, [each.correction for each in told if each.correction]
    assert off(odometry, ROUND).max() > 1.0
    assert mapper.account.loops >= 2
    stamps = np.array([each.stamp for each in observations])
    at = np.searchsorted(mapper.trajectory.stamps(), stamps, side="right") - 1
    final = mapper.trajectory.poses(mapper.poses)[at]
    assert off(final, ROUND).max() < 0.15
    # What was told with each correction leads from the poses as they were told to those of now.
    told = np.array([(each.pose.x, each.pose.y, each.pose.theta) for each in told])
    for correction in news:
        known = stamps < correction.stamps[-1]
        told[known] = correction.moved(stamps[known], told[known])
    assert np.hypot(*(told - final)[:, :2].T).max() < 0.05


def test_a_loop_that_is_wrong_on_purpose_is_refused(monkeypatch):
    """The robot is said to be back at its start, turned round, on every third keyframe."""

    def lies(self, keyframes, poses, visits):
        later = len(keyframes) - 1
        wrong = np.array([1.0, -1.0, np.pi])
        return [Loop(0, later, wrong, np.diag(BEST**2))] if later % 3 == 2 else []

    monkeypatch.setattr(LoopFinder, "find", lies)
    odometry = drifting(SQUARE, stretch=1.05, veer=0.06)
    mapper, poses, _ = followed(drive(ROOM, SQUARE, odometry))
    assert mapper.account.refused >= 3
    assert mapper.account.loops == 0
    assert off(poses, SQUARE).max() < 0.06


@pytest.mark.parametrize(("rate", "step", "turn"), [(2, 0.4, 0.5), (40, 0.02, 0.05)])
def test_few_or_many_scans_a_second(rate, step, turn):
    true = way([(2, 2), (4, 2), (4, 3.2)], step=step, turn=turn)
    odometry = drifting(true, stretch=1.05, veer=0.1)
    _, poses, _ = followed(drive(ROOM, true, odometry, seconds=1 / rate))
    assert off(odometry, true)[-1] > 0.2
    assert off(poses, true).max() < 0.06


def test_the_same_observations_give_the_same_poses():
    _, observations = around_the_block()
    one, two = (followed(observations[:50])[1] for _ in range(2))
    np.testing.assert_array_equal(one, two)


def test_nodes_know_how_sure_they_are():
    odometry = drifting(SQUARE, stretch=1.05, veer=0.06)
    mapper, _, _ = followed(drive(ROOM, SQUARE, odometry))
    first, last = (
        np.sqrt(np.diag(mapper.map.uncertainty(n))) for n in (0, len(mapper.keyframes) - 1)
    )
    assert (first < 0.002).all()
    assert (last[:2] > first[:2]).all()
    assert (last < 0.1).all()


def test_a_robot_that_is_carried_back_knows_the_place_again(monkeypatch):
    true, made, back = carried_and_back()
    source, told = corrected_carried()
    poses = np.array([(each.pose.x, each.pose.y, each.pose.theta) for each in told])
    assert source.mapper.account.lost == 2
    assert off(poses, true)[-1] < 0.05
    final = source.mapper.trajectory.poses(source.mapper.poses)[-back // 2 :]
    assert off(final, true[-len(final) :]).max() < 0.1
    # By position alone it does not: it is metres away from where it thinks.
    monkeypatch.setattr(LoopFinder, "_recognised", lambda *_: None)
    _, poses, _ = followed(made)
    assert off(poses, true)[-back:].min() > 1.0


def test_on_known_ground_nothing_is_added():
    """Around in the room twice: the second time the map has it all."""
    once = way([(2, 2), (4, 2), (4, 4), (2, 4), (2, 2)], step=0.2, turn=0.3)
    turn = way([(2, 2.2), (2, 2), (2.2, 2)], step=0.2, turn=0.3)[1:]
    true = np.vstack([once, turn] * 2)
    mapper, poses, _ = followed(drive(ROOM, true, drifting(true, 1.05, 0.06)))
    made = np.searchsorted([keyframe.stamp for keyframe in mapper.keyframes], STAMP * len(once))
    assert len(mapper.keyframes) <= made + 8
    assert mapper.account.familiar > made // 2
    assert off(poses, true).max() < 0.06


# ---------------------------------------------------------------- bad input


def test_without_scans_odometry_is_followed():
    odometry = drifting(SQUARE)
    observations = [Observation(i, pose=Pose2D(*pose)) for i, pose in enumerate(odometry.tolist())]
    mapper, poses, news = followed(observations)
    np.testing.assert_allclose(poses[:, :2], odometry[:, :2], atol=1e-9)
    assert not news
    assert mapper.account.scans == 0


def test_one_scan_is_a_map():
    mapper, poses, _ = followed(drive(ROOM, SQUARE[:1], SQUARE[:1]))
    np.testing.assert_allclose(poses, SQUARE[:1])
    assert len(mapper.keyframes) == 1


def test_an_open_hall_and_broken_scans_leave_odometry():
    nothing = np.full(181, np.inf)
    nonsense = [nothing, np.full(181, np.nan), np.zeros(181), np.empty(0)]
    made = drive(ROOM, SQUARE[:20], SQUARE[:20])
    for number in range(5, 15):
        ranges = nonsense[number % len(nonsense)]
        empty = LaserScan(BEAMS[180][: len(ranges)], ranges, 0.05, 20.0)
        made[number] = Observation(made[number].stamp, pose=made[number].pose, scan=empty)
    mapper, poses, _ = followed(made)
    assert off(poses, SQUARE[:20]).max() < 0.03
    assert mapper.account.few == 10


def test_odometry_that_jumps_or_is_not_finite_is_passed_over():
    odometry = SQUARE.copy()
    odometry[20:, 0] += 7.0
    odometry[30] = np.nan
    mapper, poses, _ = followed(drive(ROOM, SQUARE, odometry, angles=BEAMS[360]))
    assert off(poses, SQUARE).max() < 0.1
    assert mapper.account.jumps == 1
    assert mapper.account.without == 2  # at the pose that is none, and from there to the next


def test_odometry_that_stops_does_not_stop_the_robot():
    odometry = SQUARE.copy()
    odometry[10:] = odometry[10]
    _, poses, _ = followed(drive(ROOM, SQUARE, odometry, angles=BEAMS[360]))
    assert off(poses, SQUARE).max() < 0.1


def test_observations_out_of_order_move_nothing():
    made = drive(ROOM, SQUARE[:12], SQUARE[:12])
    made[5], made[6] = made[6], made[5]
    mapper, poses, _ = followed(made)
    assert mapper.account.disordered == 1
    np.testing.assert_array_equal(poses[6], poses[5])
    assert off(poses[7:], SQUARE[7:12]).max() < 0.03


def test_a_robot_that_is_carried_away_goes_on_with_a_map_of_its_own():
    elsewhere = [*box(100, 100, 103, 109), *box(101, 104, 101.4, 104.4)]
    there = way([(102.2, 101.5), (102.2, 107.5)])
    true = np.vstack([SQUARE[:15], there])
    odometry = np.vstack([SQUARE[:15], there - there[0] + SQUARE[14]])
    made = drive(ROOM + elsewhere, true, odometry)
    mapper, poses, _ = followed(made)
    assert mapper.account.lost == 1
    # It is followed there as well as here: the way between two moments is right.
    went = np.hypot(*(poses[-1] - poses[-31])[:2])
    assert went == pytest.approx(3.0, abs=0.1)


def test_people_who_walk_past_move_no_wall():
    made = []
    rng = np.random.default_rng(3)
    for number, pose in enumerate(SQUARE):
        x, y = pose[0] + 0.8 * np.cos(number), pose[1] + 0.8 * np.sin(number)
        walls = [*ROOM, *box(x - 0.15, y - 0.15, x + 0.15, y + 0.15)]
        seen = scan(walls, pose, BEAMS[360], noise=0.01 * rng.standard_normal(180))
        made.append(Observation(number * 10**8, scan=seen, pose=Pose2D(*pose.tolist())))
    _, poses, _ = followed(made)
    assert off(poses, SQUARE).max() < 0.06
