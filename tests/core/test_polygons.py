"""Outlines of masks, against counting cells and matplotlib's own test of points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path
from scipy.ndimage import label

from placecue.polygons import area_of, holds, outlines

RING = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0))


def mask_of(*rows):
    """Return a mask from lines of a drawing, the lowest y last."""
    return np.array([[letter == "#" for letter in row] for row in rows[::-1]])


def test_a_rectangle_has_four_corners_counter_clockwise():
    [[ring]] = outlines(mask_of("....", ".##.", ".##."))
    assert sorted(ring) == [(1, 0), (1, 2), (3, 0), (3, 2)]
    assert area_of(ring) == 4


def test_a_hole_goes_clockwise_in_the_polygon_around_it():
    [[outline, hole]] = outlines(mask_of("####", "#..#", "####"))
    assert area_of(outline) == 12
    assert area_of(hole) == -2
    assert sorted(hole) == [(1, 1), (1, 2), (3, 1), (3, 2)]


def test_cells_that_touch_at_a_corner_are_apart():
    polygons = outlines(mask_of("#.", ".#"))
    assert [area_of(outline) for [outline] in polygons] == [1, 1]
    [[outline, *holes]] = outlines(mask_of("###", "#.#", "##."))  # the hole touches the outside
    assert area_of(outline) + sum(map(area_of, holes)) == 7


def test_an_island_in_a_hole_is_a_polygon_of_its_own():
    island = mask_of("#####", "#...#", "#.#.#", "#...#", "#####")
    assert [[area_of(ring) for ring in polygon] for polygon in outlines(island)] == [[25, -9], [1]]


def test_nothing_has_no_outline():
    assert outlines(np.zeros((3, 4), bool)) == []


masks = st.integers(0, 9999).map(lambda seed: np.random.default_rng(seed).random((9, 7)) < 0.55)


@settings(max_examples=60, deadline=None)
@given(masks)
def test_polygons_cover_the_cells_and_nothing_else(mask):
    polygons = outlines(mask)
    assert sum(area_of(ring) for each in polygons for ring in each) == mask.sum()
    assert len(polygons) == label(mask)[1]
    for i, j in np.ndindex(mask.shape):
        assert holds(polygons, j + 0.5, i + 0.5) == mask[i, j]


@given(st.floats(-1, 5), st.floats(-1, 4))
def test_inside_as_others_tell_it(x, y):
    if min(abs(x), abs(x - 4), abs(y), abs(y - 3)) > 1e-9:
        assert holds([(RING,)], x, y) == Path(RING).contains_point((x, y))


def test_the_size_of_a_ring():
    assert area_of(RING) == pytest.approx(12)
    assert area_of(RING[::-1]) == pytest.approx(-12)
