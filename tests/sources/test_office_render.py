"""The renderer and the beams in a bare room of 6 by 4 m, against geometry worked by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from placecue.observation import Pose2D
from placecue_office.arrays import CEILING, FLOOR, Geometry
from placecue_office.blocks import Block, blocks_of
from placecue_office.camera import Camera
from placecue_office.laser import Laser
from placecue_office.light import ILLUMINATIONS, light_up
from placecue_office.plan import Plan, Room, Wall
from placecue_office.scene import build_geometry, build_skin
from placecue_office.shade import _corner, develop
from placecue_office.trace import trace

CAMERA = Camera(width=320, height=240, field_of_view=90.0, above_floor=1.0, noise=0.0)
FOCAL = 160.0  # half the width, for 90 degrees
BOX = Block(
    np.array([[4.0, 1.5], [5.0, 1.5], [5.0, 2.5], [4.0, 2.5]]), 0.0, 0.5, ("wood",) * 4, "wood"
)


def bare_room() -> Plan:
    corners = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]])
    outside = corners + 0.05 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    walls = [
        Wall(np.array([a, b]), 0.1, 0.0, 2.7)
        for a, b in zip(outside, np.roll(outside, -1, axis=0), strict=True)
    ]
    room = Room("room", corners, "tiles #806040", "paint #c03030", "ceiling #e0e0e0")
    nothing = np.empty((0, 4))
    return Plan("bare", 2.7, (room,), tuple(walls), (), (), np.array([[3.0, 2, 1, 1]]), nothing)


def seen(
    blocks: list[Block], pose: Pose2D
) -> tuple[Geometry, NDArray[np.float32], NDArray[np.int32]]:
    geometry = build_geometry(bare_room(), blocks)
    return geometry, *trace(geometry, CAMERA.eye(pose), CAMERA.width, CAMERA.height)


def walls_only() -> list[Block]:
    return [block for block in blocks_of(bare_room(), ()) if block.solid]


def test_the_far_wall_stands_where_perspective_puts_it() -> None:
    _, depth, surface = seen(walls_only(), Pose2D(2.0, 2.0, 0.0))
    column = 160
    assert depth[column, 120] == pytest.approx(4.0)
    # 1 m below and 1.7 m above the eye, 4 m away: 40 rows below and 68 above the middle.
    np.testing.assert_array_equal(np.flatnonzero(surface[column] >= 0), np.arange(120 - 68, 160))
    assert (surface[column, :52] == CEILING).all()
    assert (surface[column, 160:] == FLOOR).all()


def test_the_side_wall_recedes_with_one_over_the_column() -> None:
    _, depth, _ = seen(walls_only(), Pose2D(2.0, 2.0, 0.0))
    columns = np.arange(0, 60)  # 2 m to the left of the axis, until the corner at 80
    np.testing.assert_allclose(depth[columns, 120], 2.0 * FOCAL / (160 - columns - 0.5), rtol=1e-5)


def test_one_sees_the_front_and_the_top_of_a_low_box() -> None:
    geometry, depth, surface = seen([*walls_only(), BOX], Pose2D(1.0, 2.0, 0.0))
    column = surface[160]
    front = np.flatnonzero(column == 16 + 3)  # the edge from (4, 2.5) to (4, 1.5)
    top = np.flatnonzero(column == len(geometry.faces) + 4)
    # The front is 3 m away, from 0.5 to 1 m under the eye; the top goes on to 4 m.
    np.testing.assert_array_equal(front, np.arange(120 + round(160 * 0.5 / 3), 120 + 53))
    np.testing.assert_array_equal(top, np.arange(120 + 20, 120 + round(160 * 0.5 / 3)))
    assert depth[160, 141] == pytest.approx(160 * 0.5 / 21.5)


def test_paint_colours_the_wall_and_noise_is_of_the_asked_size() -> None:
    plan, blocks = bare_room(), blocks_of(bare_room(), ())
    geometry, skin = build_geometry(plan, blocks), build_skin(plan, blocks, seed=3)
    ground = light_up(plan, blocks, geometry, ILLUMINATIONS["night"])
    image = CAMERA.shoot(geometry, skin, ground, Pose2D(2.0, 2.0, 0.0), key=1)
    red, green, blue = image[100:130, 140:180].reshape(-1, 3).mean(axis=0)
    assert red > 1.7 * green  # sixteen times the light, less what the filters let through
    assert red > 1.7 * blue
    flat = np.full((240, 320, 3), 0.2, dtype=np.float32)
    clean, noisy = (develop(flat, 1.0, size, np.uint64(9)).astype(float) for size in (0.0, 4.0))
    assert np.ptp(clean) == 0
    assert (noisy - clean).std() == pytest.approx(4.0, rel=0.03)
    assert abs((noisy - clean).mean()) < 0.5


def test_colours_leak_into_one_another_and_grey_stays() -> None:
    red = np.zeros((2, 2, 3), dtype=np.float32)
    red[..., 0] = 0.3
    shown = develop(red, 1.0, 0.0, np.uint64(1))[0, 0].astype(float)
    assert shown[0] > shown[1] == shown[2] > 0
    # Gamma 2 and a soft shoulder undone, the sum of the colours is what came in.
    bent = (shown / 255) ** 2 / 1.35
    assert (bent / (1 - 0.35 * bent)).sum() == pytest.approx(0.3, rel=0.01)
    grey = develop(np.full((2, 2, 3), 0.1, dtype=np.float32), 1.0, 0.0, np.uint64(1))[0, 0]
    assert np.ptp(grey) == 0


def test_the_lens_scatters_a_part_of_the_mean_light_everywhere() -> None:
    plan, blocks = bare_room(), blocks_of(bare_room(), ())
    geometry, skin = build_geometry(plan, blocks), build_skin(plan, blocks, seed=3)
    ground = light_up(plan, blocks, geometry, ILLUMINATIONS["night"])
    clear, hazy = (
        replace(CAMERA, flare=flare).shoot(geometry, skin, ground, Pose2D(2, 2, 0.0), 1, 0.5)
        for flare in (0.0, 0.5)
    )
    assert (hazy >= clear).all()
    grey, rise = clear.mean(axis=2), hazy.astype(float) - clear
    dark, bright = grey <= np.quantile(grey, 0.1), grey >= np.quantile(grey, 0.9)
    assert rise[dark].mean() > 1.3 * rise[bright].mean() > 0


def test_walls_are_darker_where_they_meet_the_floor() -> None:
    heights = np.array([_corner(height, 2.7) for height in (0.0, 0.05, 0.3, 1.35, 2.4, 2.7)])
    assert (np.diff(heights[:4]) > 0).all()
    assert (np.diff(heights[3:]) < 0).all()
    assert heights[2] == pytest.approx(heights[4])
    assert heights.max() <= 1


def test_beams_in_the_bare_room_are_as_long_as_trigonometry_says() -> None:
    laser = Laser(beams=361, field_of_view=180.0, max_range=30.0, noise=0.0)
    faces = build_geometry(bare_room(), walls_only()).cut(0.3)
    scan = laser.scan(faces, Pose2D(2.0, 1.5, 0.3), np.random.default_rng(0))
    bearings = np.radians(np.linspace(-90, 90, 361)) + 0.3
    c, s = np.cos(bearings), np.sin(bearings)
    with np.errstate(divide="ignore"):
        along_x = np.where(c > 0, 4.0 / c, 2.0 / -c)
        along_y = np.where(s > 0, 2.5 / s, 1.5 / -s)
    np.testing.assert_allclose(scan.ranges, np.minimum(along_x, along_y), rtol=1e-9)


def test_a_box_is_met_at_the_height_it_has() -> None:
    geometry = build_geometry(bare_room(), [*walls_only(), BOX])
    laser = Laser(beams=1, field_of_view=0.0, max_range=30.0, noise=0.0)
    ahead = Pose2D(1.0, 2.0, 0.0)
    lengths = [
        laser.scan(geometry.cut(height), ahead, np.random.default_rng(0)).ranges[0]
        for height in (0.3, 0.6)
    ]
    assert lengths == pytest.approx([3.0, 5.0])
