"""A graph of poses: what a loop moves, and that a wrong one is refused."""

import numpy as np
import pytest

pytest.importorskip("gtsam")

from placecue.slam.pose_graph import PoseGraph

EDGE = np.diag(np.array([0.02, 0.02, 0.01]) ** 2)
LOOP = np.diag(np.array([0.02, 0.02, 0.005]) ** 2)


def square(side=10, stretch=1.0):
    """Return a graph once around a square of 4 sides of edges of 0.5 m."""
    graph = PoseGraph(np.zeros(3))
    step = np.array([0.5 * stretch, 0.0, 0.0])
    for number in range(1, 4 * side + 1):
        turn = np.pi / 2 if number % side == 0 else 0.0
        relative = step + np.array([0.0, 0.0, turn])
        x, y, theta = graph.poses[-1]
        c, s = np.cos(theta), np.sin(theta)
        graph.add(np.array([x + c * step[0], y + s * step[0], theta + turn]), relative, EDGE)
    return graph


def test_a_chain_stands_where_it_was_measured():
    graph = square()
    np.testing.assert_allclose(graph.poses[10], [5.0, 0.0, np.pi / 2], atol=1e-6)
    np.testing.assert_allclose(graph.poses[-1][:2], [0.0, 0.0], atol=1e-6)


def test_uncertainty_grows_along_a_chain_as_its_edges_say():
    graph = PoseGraph(np.zeros(3))
    certain = np.diag([0.04, 0.01, 1e-12])  # of heading hardly anything
    for number in range(1, 5):
        graph.add(np.array([number, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]), certain)
    along, across = np.diag(graph.uncertainty(4))[:2]
    assert along == pytest.approx(4 * 0.04, rel=1e-3)
    assert across == pytest.approx(4 * 0.01, rel=1e-3)


def test_a_right_loop_shares_the_error_out():
    graph = square()
    # The robot is 0.3 m beside where it began: the loop says so, and each edge gives a little.
    assert graph.close(0, 40, np.array([0.3, 0.0, 0.0]), LOOP)
    assert graph.poses[40][0] == pytest.approx(0.3, abs=0.03)
    steps = np.hypot(*np.diff(graph.poses[:, :2], axis=0).T)
    assert np.abs(steps - 0.5).max() < 0.05
    np.testing.assert_allclose(graph.poses[0], np.zeros(3), atol=1e-3)


@pytest.mark.parametrize("wrong", [[3.0, 0.0, 0.0], [0.0, 5.0, 1.0], [-2.0, -2.0, 3.0]])
def test_a_wrong_loop_is_refused_and_moves_nothing(wrong):
    graph = square()
    before = graph.poses.copy()
    assert not graph.close(0, 40, np.array(wrong), LOOP)
    np.testing.assert_array_equal(graph.poses, before)
    # And it has left nothing behind: a right one is taken as if it had not been.
    assert graph.close(0, 40, np.zeros(3), LOOP)
    np.testing.assert_allclose(graph.poses[:, :2], before[:, :2], atol=1e-4)


def test_a_wrong_loop_among_right_ones_is_refused():
    graph = square()
    for number in (36, 38, 40):
        x, y, theta = graph.poses[number]
        assert graph.close(0, number, np.array([x, y, theta]), LOOP)
    assert not graph.close(4, 39, np.array([0.0, 0.0, -np.pi / 2]), LOOP)
    assert np.abs(graph.poses[40][:2]).max() < 0.01


def test_a_robot_that_was_carried_away_is_swung_back_as_one_piece():
    """After ten edges nobody knows what happened; another ten follow, which lie where they lie."""
    graph, step = PoseGraph(np.zeros(3)), np.array([0.5, 0.0, 0.0])
    for number in range(1, 11):
        graph.add(np.array([0.5 * number, 0.0, 0.0]), step, EDGE)
    carried = np.diag(np.array([10.0, 10.0, 1.5]) ** 2)
    for number in range(11, 21):
        graph.add(np.array([0.5 * number, 0.0, 0.0]), step, carried if number == 11 else EDGE)
    # It drives the same ten poses again, the other way round, and is recognised at the last.
    assert graph.close(1, 20, np.array([0.0, 0.0, -3.0]), LOOP)
    x, y, theta = graph.poses[20]
    assert (x, y, theta) == pytest.approx((0.5, 0.0, -3.0), abs=0.02)
    back = np.array([0.5, 0.0]) - 4.5 * np.array([np.cos(-3.0), np.sin(-3.0)])
    np.testing.assert_allclose(graph.poses[11][:2], back, atol=0.05)
    np.testing.assert_allclose(graph.poses[10], [5.0, 0.0, 0.0], atol=0.02)


def test_a_pose_may_be_measured_from_any_before():
    graph, step = PoseGraph(np.zeros(3)), np.array([0.5, 0.0, 0.0])
    for number in range(1, 5):
        graph.add(np.array([0.5 * number, 0.0, 0.0]), step, EDGE)
    graph.add(np.array([1.0, 0.5, 0.0]), np.array([0.0, 0.5, 0.0]), EDGE, base=2)
    # A loop that moves the second moves what hangs on it.
    assert graph.close(0, 2, np.array([1.0, 0.05, 0.0]), np.diag([1e-6, 1e-6, 1e-6]))
    moved = graph.poses[5] - graph.poses[2]
    np.testing.assert_allclose(graph.poses[2][:2], [1.0, 0.05], atol=0.005)
    np.testing.assert_allclose(moved[:2], [0.0, 0.5], atol=0.01)
