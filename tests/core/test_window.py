"""What part of space a picture shows."""

from __future__ import annotations

import numpy as np
import pytest

from placecue.evaluation.map_figure import draw_semantic_map
from placecue.evaluation.window import window_of, within
from placecue.semantic_map import Area, Node, SemanticMap


def drive(count: int = 200) -> np.ndarray:
    return np.column_stack([np.linspace(0, 30, count), np.linspace(0, 8, count)])


def test_everything_is_shown_where_nothing_is_absurd() -> None:
    np.testing.assert_array_equal(window_of(drive()), [[0, 0], [30, 8]])


@pytest.mark.parametrize("far", [1e3, 1e4, -1e6, 1e300])
def test_a_point_far_from_nearly_all_others_is_left_out(far: float) -> None:
    points = np.vstack([drive(), [[far, 0.0]]])
    window = window_of(points)
    np.testing.assert_array_equal(window, [[0, 0], [30, 8]])
    assert within(points, window).tolist() == [True] * 200 + [False]


def test_a_long_corridor_is_shown_to_its_end() -> None:
    room = np.random.default_rng(0).uniform(0, 10, (900, 2))
    corridor = np.column_stack([np.linspace(10, 85, 60), np.full(60, 5.0)])
    assert window_of(np.vstack([room, corridor]))[1, 0] == 85.0


def test_nothing_and_what_is_not_finite() -> None:
    np.testing.assert_array_equal(window_of(np.empty((0, 2))), [[-1, -1], [1, 1]])
    np.testing.assert_array_equal(window_of(np.full((3, 2), np.nan)), [[-1, -1], [1, 1]])


def test_a_picture_with_a_jump_is_as_large_as_any(tmp_path: object) -> None:
    places = [*drive(40).tolist(), [1e6, -1e6]]
    nodes = tuple(Node(i, x, y, 0) for i, (x, y) in enumerate(places))
    area = Area(0, "hall", 0.5)
    made = SemanticMap((area,), nodes, ((39, 40),), ("hall", "office"))
    points = np.vstack([drive(), np.array([[1e6, -1e6]])])
    path = draw_semantic_map(made, f"{tmp_path}/map.png", points=points, size=400)
    assert 2_000 < path.stat().st_size < 200_000


def test_a_map_of_many_kilometres_is_drawn_coarsely(tmp_path: object) -> None:
    points = np.random.default_rng(0).uniform(-20_000, 20_000, (2000, 2))
    empty = SemanticMap((), (), (), ("hall",))
    path = draw_semantic_map(empty, f"{tmp_path}/map.png", points=points, size=400)
    assert path.stat().st_size < 500_000
