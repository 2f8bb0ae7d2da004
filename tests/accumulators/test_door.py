from dataclasses import replace

import numpy as np
import pytest
from sklearn.base import clone

from doorways import doorway, scan_at
from placecue import LaserScan, Observation, Pose2D
from placecue_accumulators.door import Door


def measured(scan, beams, ranges):
    """Return the scan with other ranges at some beams."""
    changed = scan.ranges.copy()
    changed[beams] = ranges
    return replace(scan, ranges=changed)


HERE = Pose2D(0.0, 0.0, 0.0)


def test_a_door_is_found_at_the_middle_of_its_posts():
    middle = Door().find(scan_at(doorway(0.8), HERE))
    assert (middle.x, middle.y) == pytest.approx((0, 0), abs=1e-6)
    aside = Door().find(scan_at(doorway(0.8), Pose2D(0.0, 0.1, 0.0)))
    assert (aside.x, aside.y) == pytest.approx((0, -0.1), abs=1e-6)


@pytest.mark.parametrize(
    ("width", "is_door"), [(0.55, False), (0.62, True), (0.9, True), (1.04, True), (1.1, False)]
)
def test_the_width_must_be_that_of_a_door(width, is_door):
    assert (Door().find(scan_at(doorway(width), HERE)) is not None) == is_door


def test_there_must_be_depth_behind():
    assert Door().find(scan_at(doorway(far=0.4), HERE)) is None  # a cupboard


def test_thin_posts_are_no_posts():
    # Ahead of the scanner the jamb shows 1.5 cm, then 6 cm, of itself; 5 cm are asked for.
    assert Door().find(scan_at(doorway(depth=(-0.1, 0.015)), HERE)) is None
    assert Door().find(scan_at(doorway(depth=(-0.1, 0.06)), HERE)) is not None


def test_a_post_in_pieces_is_no_post():
    scan = scan_at(doorway(), HERE)
    beside = np.abs(np.degrees(scan.angles) - 90) < 10
    steps = np.where(np.arange(beside.sum()) % 2, 0.03, 0.0)  # 3 cm
    scan = measured(scan, beside, scan.ranges[beside] + steps)
    assert Door().find(scan) is None
    assert Door(max_gap=0.05).find(scan) is not None


def test_the_jamb_may_lie_a_little_ahead():
    # 13 cm before the line of the jamb's front, 0.4 m to each side: 18 degrees ahead.
    assert Door().find(scan_at(doorway(), Pose2D(-0.23, 0, 0))) is not None
    assert Door().find(scan_at(doorway(), Pose2D(-0.35, 0, 0))) is None


@pytest.mark.parametrize(("beams", "needed"), [(361, 50), (181, 26), (721, 100)])
def test_open_beams_scale_with_the_scanner_and_missing_ones_do_not_count(beams, needed):
    # 50 / 361 of 181 beams are 25.07, of 721 beams 99.9.
    scan = scan_at(doorway(), HERE, beams)
    deep = np.flatnonzero(scan.ranges > 1.5)
    assert Door().find(measured(scan, deep[needed:], np.nan)) is not None
    assert Door().find(measured(scan, deep[needed - 1 :], np.nan)) is None


def test_beams_without_return_look_through_the_door():
    scan = scan_at(doorway(), HERE)
    assert Door().find(measured(scan, scan.ranges > 1.5, np.inf)) is not None


def test_beams_too_short_to_be_true_are_no_posts():
    scan = measured(scan_at(doorway(), HERE), [0, 10, 355], (0.0, 0.015, 0.011))
    assert Door().find(scan) is not None


@pytest.mark.parametrize("fill", [np.nan, 0.0, np.inf])
def test_scans_with_nothing_in_them_have_no_door(fill):
    scan = LaserScan(np.linspace(-1.5, 1.5, 181), np.full(181, fill), 0.01, 30.0)
    assert Door().find(scan) is None
    assert Door().find(LaserScan(np.empty(0), np.empty(0), 0.01, 30.0)) is None


def test_of_a_wider_scan_the_front_counts_however_it_is_mounted():
    around = scan_at(doorway(), HERE, beams=721, field=360)
    assert Door().find(around) is not None
    backwards = scan_at(doorway(), HERE, 721, 360, Pose2D(0, 0, np.pi))
    assert Door().find(backwards) is not None
    ahead = scan_at(doorway(), Pose2D(-0.2, 0, 0), mount=Pose2D(0.2, 0, 0))
    middle = Door().find(ahead)
    assert (middle.x, middle.y) == pytest.approx((0.2, 0), abs=1e-6)


def test_a_scanner_that_sees_behind_finds_a_jamb_just_passed():
    passed = Pose2D(0.23, 0, 0)  # the jamb's end lies 18 degrees behind straight left and right
    assert Door().find(scan_at(doorway(), passed)) is None
    middle = Door().find(scan_at(doorway(), passed, beams=721, field=360))
    assert (middle.x, middle.y) == pytest.approx((-0.13, 0), abs=0.01)
    assert Door().find(scan_at(doorway(), Pose2D(0.35, 0, 0), beams=721, field=360)) is None


def test_people_and_clutter_ahead_do_not_hide_a_door():
    scan = scan_at(doorway(), HERE)
    ahead = np.abs(np.degrees(scan.angles)) < 40  # somebody 0.8 m ahead, across 80 degrees
    assert Door().find(measured(scan, ahead, 0.8)) is not None
    across = np.abs(np.degrees(scan.angles)) < 70
    assert Door().find(measured(scan, across, 0.8)) is None  # the way is barred


def test_a_narrow_scanner_finds_none():
    assert Door().find(scan_at(doorway(), HERE, beams=241, field=120)) is None


def drive(door, xs, heading=0.0):
    walls = doorway()
    for i, x in enumerate(xs):
        pose = Pose2D(float(x), 0.05, heading)
        yield door.update(Observation(i, pose=pose, scan=scan_at(walls, pose)))


def test_one_crossing_a_passage():
    door = Door()
    out = [pose for pose in drive(door, np.arange(-2, 2, 0.05)) if pose]
    assert len(out) == 1
    assert (out[0].x, out[0].y) == pytest.approx((0, 0), abs=0.15)
    assert out[0].theta == 0
    back = [pose for pose in drive(door, np.arange(2, -2, -0.05), np.pi) if pose]
    assert len(back) == 1
    assert (back[0].x, back[0].y, back[0].theta) == pytest.approx((0, 0, np.pi), abs=0.15)


def test_standing_in_the_door_is_one_passage_and_reset_forgets_it():
    door = Door()
    assert sum(pose is not None for pose in drive(door, np.zeros(50))) == 1
    door.reset()
    assert sum(pose is not None for pose in drive(door, np.zeros(2))) == 1


def test_it_looks_only_after_a_little_motion():
    door, wall = Door(), doorway(far=0.4)
    poses = [Pose2D(x, 0, 0) for x in (0.0, 0.005, 0.011)]
    door.update(Observation(0, pose=poses[0], scan=scan_at(wall, poses[0])))
    assert door.update(Observation(1, pose=poses[1], scan=scan_at(doorway(), poses[1]))) is None
    assert door.update(Observation(2, pose=poses[2], scan=scan_at(doorway(), poses[2]))) is not None


def test_observations_without_scan_or_pose_are_passed_over():
    door = Door()
    assert door.update(Observation(0, pose=HERE)) is None
    assert door.update(Observation(1, scan=scan_at(doorway(), HERE))) is None


def test_it_clones():
    assert clone(Door(max_width=1.2)).get_params()["max_width"] == 1.2
