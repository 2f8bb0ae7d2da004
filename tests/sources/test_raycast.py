from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from placecue_sources.raycast import OccupancyGrid, cast_rays


def box(width: int, height: int, resolution: float, origin: tuple[float, float]) -> OccupancyGrid:
    occupied = np.zeros((height, width), dtype=np.uint8)
    occupied[[0, -1]] = 1
    occupied[:, [0, -1]] = 1
    return OccupancyGrid(occupied, resolution, origin)


def test_box_is_measured_exactly() -> None:
    # 20 m by 10 m with walls of 0.05 m, centred on 0: the inner faces are at 9.95 and 4.95.
    grid = box(400, 200, 0.05, (-10.0, -5.0))
    bearings = np.array([0.0, np.pi / 2, np.pi, -np.pi / 2, np.pi / 4, np.arctan2(1, 3)])
    lengths = cast_rays(grid, 1.0, 0.5, bearings, 50.0)
    expected = [8.95, 4.45, 10.95, 5.45, 4.45 * np.sqrt(2), 8.95 * np.sqrt(10) / 3]
    np.testing.assert_allclose(lengths, expected, atol=1e-9)


def test_circle_to_one_cell() -> None:
    resolution, radius = 0.02, 3.0
    axis = (np.arange(400) + 0.5) * resolution - 4.0
    outside = np.hypot(axis[:, None], axis[None, :]) > radius
    grid = OccupancyGrid(outside, resolution, (-4.0, -4.0))
    x, y = 0.7, -1.1
    bearings = np.linspace(-np.pi, np.pi, 721)
    along = x * np.cos(bearings) + y * np.sin(bearings)
    expected = -along + np.sqrt(along**2 - x**2 - y**2 + radius**2)
    # The cells' corners stand up to one diagonal inside the circle, and beams graze them.
    difference = cast_rays(grid, x, y, bearings, 20.0) - expected
    assert np.abs(difference).max() < 2 * resolution
    assert np.abs(difference).mean() < resolution


def test_beam_starting_in_an_occupied_cell_has_no_length() -> None:
    grid = box(10, 10, 0.1, (0.0, 0.0))
    np.testing.assert_array_equal(cast_rays(grid, 0.05, 0.5, np.array([0.0, 1.0, 3.0]), 5.0), 0.0)


def test_nothing_hit_is_infinite() -> None:
    empty = OccupancyGrid(np.zeros((10, 10), dtype=np.uint8), 0.1)
    bearings = np.linspace(-np.pi, np.pi, 73)
    assert np.isinf(cast_rays(empty, 0.5, 0.5, bearings, 100.0)).all()
    assert np.isinf(cast_rays(empty, 0.5, 0.5, bearings, np.inf)).all()
    walled = box(100, 100, 0.1, (0.0, 0.0))
    assert np.isinf(cast_rays(walled, 5.0, 5.0, np.array([0.0]), 4.89)).all()
    np.testing.assert_allclose(cast_rays(walled, 5.0, 5.0, np.array([0.0]), 4.91), 4.9)


def test_beams_enter_the_grid_from_outside() -> None:
    grid = OccupancyGrid(np.ones((10, 10), dtype=np.uint8), 0.1)
    lengths = cast_rays(grid, -2.0, 0.5, np.array([0.0, np.pi, np.pi / 2]), 10.0)
    np.testing.assert_allclose(lengths, [2.0, np.inf, np.inf])


def test_diagonal_wall_lets_no_beam_through() -> None:
    grid = OccupancyGrid(np.eye(50, dtype=np.uint8)[:, ::-1].copy(), 1.0)
    for x, y in ((10.0, 10.0), (10.5, 10.5), (12.3, 4.7)):
        lengths = cast_rays(grid, x, y, np.deg2rad(np.arange(5.0, 85.0, 0.5)), 100.0)
        assert np.isfinite(lengths).all()


def test_picture_is_turned_upright() -> None:
    # The picture's top row is the greatest y: something drawn at the top left is up and left.
    picture = np.zeros((20, 30), dtype=np.uint8)
    picture[0, 0:3] = 255
    grid = OccupancyGrid.from_image(picture, 0.1, (1.0, 2.0))
    lengths = cast_rays(grid, 1.15, 2.05, np.array([np.pi / 2, -np.pi / 2, 0.0]), 10.0)
    np.testing.assert_allclose(lengths, [1.85, np.inf, np.inf])


def test_cells_and_centres() -> None:
    grid = OccupancyGrid(np.zeros((4, 8), dtype=np.uint8), 0.5, (-1.0, 2.0))
    rows, columns = grid.cells([-1.0, 0.3, -1.2], [2.0, 3.9, 2.7])
    assert rows.tolist() == [0, 3, 1]
    assert columns.tolist() == [0, 2, -1]
    x, y = grid.centres([0, 3], [0, 2])
    assert x.tolist() == [-0.75, 0.25]
    assert y.tolist() == [2.25, 3.75]


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    x=st.floats(0.0, 2.0),
    y=st.floats(0.0, 1.5),
    bearing=st.floats(-7.0, 7.0),
)
def test_agrees_with_small_steps(seed: int, x: float, y: float, bearing: float) -> None:
    """The reference looks up the cell at every 0.1 mm along the beam."""
    # On the line between two cells it is a matter of rounding which of them the beam is in.
    x, y = x + 0.0123, y + 0.0077
    assume(min(abs(v / 0.1 - round(v / 0.1)) for v in (x, y)) > 1e-6)
    occupied = np.random.default_rng(seed).random((15, 20)) < 0.15
    grid = OccupancyGrid(occupied, 0.1)
    length = cast_rays(grid, x, y, np.array([bearing]), 3.0)[0]
    t = np.arange(0.0, 3.0, 1e-4)
    columns = np.floor((x + t * np.cos(bearing)) / 0.1).astype(int)
    rows = np.floor((y + t * np.sin(bearing)) / 0.1).astype(int)
    inside = (rows >= 0) & (rows < 15) & (columns >= 0) & (columns < 20)
    hit = np.zeros(t.size, dtype=bool)
    hit[inside] = occupied[rows[inside], columns[inside]]
    first = t[hit.argmax()] if hit.any() else np.inf
    # Small steps jump over cells that are cut at a corner, so they never find a nearer one.
    assert length <= first + 1e-6
    if np.isfinite(length):
        corners = np.argwhere(occupied) * 0.1
        end = np.array([y + length * np.sin(bearing), x + length * np.cos(bearing)])
        away = np.maximum(np.maximum(corners - end, end - corners - 0.1), 0.0)
        assert np.hypot(*away.T).min() < 1e-9


def test_the_grid_may_be_boolean_and_not_contiguous() -> None:
    grid = box(40, 20, 0.1, (0.0, 0.0))
    odd = OccupancyGrid(np.asfortranarray(grid.occupied.astype(bool)), 0.1)
    bearings = np.linspace(-3, 3, 50)
    np.testing.assert_array_equal(
        cast_rays(odd, 1.0, 1.0, bearings, 9.0), cast_rays(grid, 1.0, 1.0, bearings, 9.0)
    )
