"""How alike places look, and walls that are seen through."""

import numpy as np
import pytest

from placecue import Pose2D
from placecue.slam.cloud import cloud_of
from placecue.slam.likeness import SIZE, likeness, signature_of
from placecue.slam.planar import moved
from placecue.slam.verifying import seen_through
from slam_rooms import BEAMS, box, scan

#: Rooms of different shapes, each around (0, 0).
ROOMS = [
    [*box(-2, -2, 2, 2)],
    [*box(-1, -6, 1, 6)],
    [*box(-4, -3, 3, 3), *box(1, 1, 2, 2)],
    [*box(-2, -2, 2, 2), *box(-2, -1, -1, 1)],
]


def signatures(pose):
    clouds = [cloud_of(scan(room, np.array(pose), BEAMS[360]), 0.1) for room in ROOMS]
    return np.array([signature_of(cloud) for cloud in clouds])


def test_a_place_is_most_like_itself_however_the_robot_is_turned():
    before, again = signatures([0.0, 0.0, 0.0]), signatures([0.2, -0.1, 2.0])
    assert before.shape == (len(ROOMS), SIZE)
    alike = np.array([likeness(one, before) for one in again])
    np.testing.assert_array_equal(alike.argmax(axis=1), np.arange(len(ROOMS)))


def test_points_that_are_only_turned_look_the_same():
    rng = np.random.default_rng(0)
    points = rng.uniform(-4, 4, (200, 2))
    one, other = signature_of(points), signature_of(moved(points, np.array([0.0, 0.0, 1.0])))
    assert likeness(one, other[None])[0] == pytest.approx(1.0, abs=1e-6)


def test_nothing_is_like_nothing():
    nothing = signature_of(np.empty((0, 2)))
    assert not nothing.any()
    assert likeness(nothing, nothing[None])[0] == 0.0


def test_a_wall_that_is_seen_through_is_not_there():
    mount = Pose2D(0.1, 0.0, 0.3, "base_link")
    room, at = box(-2, -2, 2, 2), np.array([0.5, 0.2, 1.0])
    seen = scan(room, at, mount=mount)
    ends = moved(seen.points(), at)
    assert seen_through(seen, at, ends) == 0.0
    # Half of these lie at half the way to the wall; those behind the robot are out of sight.
    scanner = at[:2] + moved(np.array([[0.1, 0.0]]), np.array([0.0, 0.0, 1.0]))[0]
    half = scanner + (ends - scanner) / 2
    behind = 2 * scanner - ends
    points = np.vstack([ends, half, behind[10:-10]])
    assert seen_through(seen, at, points) == pytest.approx(0.5)
    # Beyond the wall nothing is seen, so nothing is said.
    assert seen_through(seen, at, np.vstack([ends, scanner + 1.5 * (ends - scanner)])) == 0.0
