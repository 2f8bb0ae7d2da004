import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from placecue import Observation, Pose2D
from placecue_accumulators.graph import NavigationGraph, Neighbourhood, Step
from placecue_accumulators.node import NodeLeft


def test_a_node_is_made_where_the_robot_is_farther_than_the_spacing_from_all():
    graph = NavigationGraph(spacing=1.0)
    steps = [graph.visit(x, 0.0) for x in (0.0, 0.6, 1.0, 1.1, 2.0, 2.2)]
    assert steps[0] == Step(0, None, new=True)
    assert steps[1:3] == [None, None]  # one metre is not farther than one metre
    assert steps[3] == Step(1, 0, new=True)
    assert steps[4:] == [None, Step(2, 1, new=True)]
    assert [place.x for place in graph.places] == [0.0, 1.1, 2.2]
    assert graph.edges == {(0, 1), (1, 2)}


def test_coming_closer_to_a_known_node_makes_it_current_and_adds_an_edge():
    graph = NavigationGraph(spacing=1.0)
    for x, y in ((0, 0), (1.1, 0), (1.1, 1.1), (0, 1.1)):
        graph.visit(x, y)
    assert graph.visit(0.0, 0.5) == Step(0, 3, new=False)
    assert graph.edges == {(0, 1), (1, 2), (2, 3), (0, 3)}
    assert graph.current == 0


def test_a_gateway_is_ignored_near_another():
    graph = NavigationGraph(spacing=1.0, gateway_spacing=2.0)
    graph.visit(0, 0)
    assert graph.pass_gateway(0.5, 0) == Step(1, 0, new=True)
    assert graph.pass_gateway(2.4, 0) is None  # 1.9 m from the first
    assert graph.pass_gateway(2.6, 0) == Step(2, 1, new=True)
    assert [place.gateway for place in graph.places] == [False, True, True]


def test_looking_in_through_a_gateway_makes_one_node_behind_it():
    graph = NavigationGraph(spacing=1.0)
    graph.visit(-0.9, 0)
    graph.pass_gateway(0, 0)
    assert [graph.visit(x, 0.0) for x in (0.3, 0.6, 0.8)] == [None] * 3
    assert graph.visit(-0.5, 0.0) == Step(0, 1, new=False)
    assert graph.look_into(1, 0.8, 0.0) == 2
    assert graph.look_into(1, 0.6, 0.1) is None  # one is near
    assert graph.edges == {(0, 1), (1, 2)}
    assert graph.current == 0
    assert graph.visit(0.6, 0.0) == Step(2, 0, new=False)


points = st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=1, max_size=40)


@given(points, st.tuples(st.floats(-9, 9), st.floats(-9, 9)), st.floats(0.1, 5))
def test_nearest_agrees_with_a_tree(known, wanted, within):
    near = Neighbourhood(cell=1.0)
    for number, (x, y) in enumerate(known):
        near.add(x, y, number)
    found = near.nearest(*wanted, within)
    expected = cKDTree(known).query(wanted)[0]
    if found is None:
        assert expected >= within - 1e-9
    else:
        assert np.hypot(*np.subtract(known[found], wanted)) <= expected + 1e-9


def test_nodes_keep_their_distance_on_any_way():
    graph = NavigationGraph(spacing=1.0)
    for x, y in np.random.default_rng(0).normal(0, 0.15, (3000, 2)).cumsum(axis=0):
        graph.visit(x, y)
    at = np.array([(place.x, place.y) for place in graph.places])
    distances = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    assert distances[~np.eye(len(at), dtype=bool)].min() > 1.0


def test_node_left_reports_each_change_of_node():
    boundary = NodeLeft(spacing=1.0)
    at = (0.0, 0.5, 1.1, 1.5, 2.2, 1.2)
    seen = [boundary.update(Observation(i, pose=Pose2D(x, 0, 0))) for i, x in enumerate(at)]
    assert [pose is not None for pose in seen] == [False, False, True, False, True, True]
    assert boundary.update(Observation(9)) is None
    boundary.reset()
    assert boundary.update(Observation(10, pose=Pose2D(50, 0, 0))) is None
