"""Sun through a window in a bare room of 6 by 4 m, worked by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from placecue_office.arrays import Ground
from placecue_office.blocks import Block, blocks_of
from placecue_office.light import ILLUMINATIONS, light_up
from placecue_office.plan import Panel, Plan, Room, Wall
from placecue_office.scene import build_geometry
from placecue_office.sun import shading, shining, sunlit

#: In the wall at y = 0, from 1 to 2 m high.
WINDOW = Panel(np.array([[2.0, 0.01], [4.0, 0.01]]), 1.0, 2.0, "window", window=True)
SOUTH, DIAGONAL = -np.pi / 2, np.pi / 4


def room() -> Plan:
    corners = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]])
    outside = corners + 0.05 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    walls = [
        Wall(np.array([a, b]), 0.1, 0.0, 2.7)
        for a, b in zip(outside, np.roll(outside, -1, axis=0), strict=True)
    ]
    one = Room("room", corners, "tiles", "paint", "ceiling")
    lamps = np.array([[3.0, 2.0, 1.0, 1.0]])
    return Plan("bare", 2.7, (one,), tuple(walls), (WINDOW,), (), lamps, corners)


def lit(x: float, y: float, z: float, *things: Block, bearing: float = SOUTH) -> bool:
    plan = room()
    geometry = build_geometry(plan, [*blocks_of(plan, ()), *things])
    ground = light_up(plan, [], geometry, ILLUMINATIONS["sunny"])
    sun = shining(plan, bearing, DIAGONAL, (1.0, 1.0, 1.0))
    ground = Ground(*ground[:-1], sun)
    return bool(sunlit(geometry, sun, shading(geometry, ground), 0, x, y, z))


def test_the_patch_on_the_floor_lies_where_the_ray_through_the_window_ends() -> None:
    # At 45 degrees what comes through at 1 to 2 m falls 1 to 2 m behind the window.
    patch = [y for y in np.arange(0.05, 4.0, 0.1) if lit(3.0, y, 0.0)]
    assert patch == pytest.approx(np.arange(1.05, 2.0, 0.1))
    across = [x for x in np.arange(0.05, 6.0, 0.1) if lit(x, 1.5, 0.0)]
    assert across == pytest.approx(np.arange(2.05, 4.0, 0.1))


def test_on_a_table_the_patch_lies_nearer_to_the_window() -> None:
    assert not lit(3.0, 0.5, 0.0)
    assert lit(3.0, 0.5, 0.7)


def test_a_box_shades_what_is_behind_it() -> None:
    outline = np.array([[2.5, 0.8], [3.5, 0.8], [3.5, 1.0], [2.5, 1.0]])
    box = Block(outline, 0.0, 0.75, ("wood",) * 4, "wood")
    # The ray that ends on the floor at y passes y - 1 to y - 0.8 m high over the box.
    assert [y for y in (1.25, 1.45, 1.65, 1.85) if lit(3.0, y, 0.0, box)] == [1.85]
    assert lit(2.2, 1.25, 0.0, box)
    assert lit(3.0, 1.25, 0.0, replace(box, bottom=1.5, top=1.9))


def test_the_sun_shines_through_windows_on_its_side_only() -> None:
    assert len(shining(room(), SOUTH, DIAGONAL, (1.0, 1.0, 1.0)).windows) == 1
    assert len(shining(room(), -SOUTH, DIAGONAL, (1.0, 1.0, 1.0)).windows) == 0
    assert len(shining(room(), SOUTH, 0.0, (1.0, 1.0, 1.0)).windows) == 0
