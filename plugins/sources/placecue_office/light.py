"""Light in the plan: lamps on the ceiling and daylight through the windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from placecue_office.arrays import Geometry, Ground, Sun
from placecue_office.blocks import Block
from placecue_office.plan import Panel, Plan, Points
from placecue_office.raster import Raster
from placecue_office.sun import shining
from placecue_office.trace import cast

Colour = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Illumination:
    """The light of a time of day.

    Parameters
    ----------
    lamps : (float, float, float)
        Strength of the lamps, red, green, blue.
    sky : (float, float, float)
        Strength of the light that a square metre of window lets in.
    view : (float, float, float)
        Brightness of what is seen through a window.
    sun : (float, float, float)
        Light of the sun on a surface that faces it.
    lit : float
        Part of the rooms with windows whose lamps are on; the others' always are.
    varies : float
        Standard deviation of the daylight from one recording to the next, as a part of it.
    """

    lamps: Colour
    sky: Colour
    view: Colour
    sun: Colour = (0.0, 0.0, 0.0)
    lit: float = 1.0
    varies: float = 0.0


ILLUMINATIONS: dict[str, Illumination] = {
    "cloudy": Illumination(
        (0.40, 0.35, 0.27), (0.38, 0.47, 0.60), (1.25, 1.4, 1.6), lit=0.9, varies=0.2
    ),
    "night": Illumination((0.225, 0.175, 0.108), (0.0, 0.0, 0.0), (0.02, 0.02, 0.035)),
    "sunny": Illumination(
        (0.40, 0.35, 0.27),
        (1.5, 1.45, 1.35),
        (3.2, 3.6, 4.3),
        sun=(13.0, 11.6, 8.8),
        lit=0.1,
        varies=0.25,
    ),
}

#: A room whose daylight is below this part of the brightest room's has its lamps on, always.
DARK = 0.35

#: How far from south the sun may stand, and how high, degrees. South is down in the plan.
SUN_BEARING, SUN_ELEVATION = 80.0, (12.0, 42.0)

#: How far it is at most from there in one recording, to the side and in height, degrees.
SUN_MOVES = 8.0, 3.0

#: How bright a lamp looks, in strengths of its light.
LAMP_SHINE = 4.0


def light_up(
    plan: Plan,
    blocks: list[Block],
    geometry: Geometry,
    light: Illumination,
    rng: np.random.Generator | None = None,
    usual: np.random.Generator | None = None,
    cell: float = 0.1,
) -> Ground:
    """Compute the light in every cell of a plan.

    Direct light reaches as far as no wall stands in between; a part of each room's mean light
    comes back from its walls.

    Parameters
    ----------
    plan : Plan
    blocks : list of Block
        What stands in it, for the shadows on the floor.
    geometry : Geometry
        Its faces.
    light : Illumination
        The time of day.
    rng : Generator, optional
        Decides how bright the day is, and how far the sun has moved.
    usual : Generator, optional
        Decides where the sun about stands, and which lamps are on: the same for recordings that
        are made close together.
    cell : float
        Width of a cell, m.
    """
    rng, usual = rng or np.random.default_rng(0), usual or np.random.default_rng(1)
    day = max(1 + light.varies * float(rng.standard_normal()), 0.4)
    bearing, elevation = _sun_stands(usual, rng)
    sun = shining(plan, bearing, elevation if max(light.sun) > 0 else 0.0, light.sun)
    raster = Raster.over(plan, cell)
    centres = raster.centres()
    rooms = _nearest_room(plan, raster)
    walls = np.ascontiguousarray(geometry.faces[geometry.spans[:, 1] - geometry.spans[:, 0] > 2.0])
    daylight = day * _daylight(plan, walls, centres).reshape(raster.shape)
    on = _lamps_on(plan, daylight, rooms, light.lit, usual)
    lamps = _lamplight(plan, walls, centres, on).reshape(raster.shape)
    direct = daylight[..., None] * np.array(light.sky) + lamps[..., None] * np.array(light.lamps)
    direct += _sun_bounce(sun, rooms)
    return Ground(
        rooms=rooms,
        light=_bounced(direct, rooms).astype(np.float32),
        contact=_contact(blocks, raster),
        shine=np.array([day * np.array(light.view), LAMP_SHINE * np.array(light.lamps)]),
        x=float(raster.origin[0]),
        y=float(raster.origin[1]),
        cell=cell,
        sun=sun,
    )


def _sun_stands(usual: np.random.Generator, rng: np.random.Generator) -> tuple[float, float]:
    """Return bearing and elevation of the sun, rad."""
    aside, up = (each * rng.uniform(-1, 1) for each in SUN_MOVES)
    bearing = -90.0 + SUN_BEARING * usual.uniform(-1, 1) + aside
    return float(np.radians(bearing)), float(np.radians(usual.uniform(*SUN_ELEVATION) + up))


def _nearest_room(plan: Plan, raster: Raster) -> NDArray[np.int64]:
    """Return the room of each cell; cells in walls take the nearest."""
    rooms = plan.room_at(raster.centres()).reshape(raster.shape)
    nearest = ndimage.distance_transform_edt(rooms < 0, return_distances=False, return_indices=True)
    return np.ascontiguousarray(rooms[tuple(nearest)])


def _daylight(plan: Plan, walls: NDArray[np.float64], centres: Points) -> NDArray[np.float64]:
    windows = (panel for panel in plan.panels if panel.window)
    return sum(
        (_through(window, plan, walls, centres) for window in windows), np.zeros(len(centres))
    )


def _lamplight(
    plan: Plan, walls: NDArray[np.float64], centres: Points, on: NDArray[np.bool_]
) -> NDArray[np.float64]:
    total, drop = np.zeros(len(centres)), plan.height - 1.0
    for x, y, length, width in plan.lamps[on]:
        squared, seen = _seen(walls, np.array([x, y]), centres)
        total += seen * (drop**2 / (drop**2 + squared)) ** 1.5 * (length * width / 0.36)
    return total


def _lamps_on(
    plan: Plan,
    daylight: NDArray[np.float64],
    rooms: NDArray[np.int64],
    lit: float,
    rng: np.random.Generator,
) -> NDArray[np.bool_]:
    """Return which lamps are on: those of a room are switched together."""
    means = np.array([daylight[rooms == room].mean() for room in range(len(plan.rooms))])
    dark = means <= DARK * means.max()
    switched = rng.random(len(plan.rooms)) < lit
    if not len(plan.lamps):
        return np.zeros(0, dtype=bool)
    return np.asarray((dark | switched)[plan.room_at(plan.lamps[:, :2])])


def _sun_bounce(sun: Sun, rooms: NDArray[np.int64], share: float = 0.06) -> NDArray[np.float64]:
    """Return the sunlight that a room's patches throw back into it, shape (rows, columns, 3)."""
    glass = np.zeros(int(rooms.max()) + 1)
    for x0, y0, x1, y1, bottom, top, room in sun.windows:
        across = abs((x1 - x0) * sun.toward[1] - (y1 - y0) * sun.toward[0])
        glass[int(room)] += across * (top - bottom) * sun.toward[3]
    return np.asarray(share * glass[rooms][..., None] * sun.colour)


def _through(
    window: Panel, plan: Plan, walls: NDArray[np.float64], centres: Points
) -> NDArray[np.float64]:
    """Return the daylight that reaches each cell through a window, from points along it."""
    along = window.line[1] - window.line[0]
    length = float(np.linalg.norm(along))
    inward = np.array([-along[1], along[0]]) / length
    middle = window.line.mean(axis=0)
    if plan.room_at((middle + 0.3 * inward)[None])[0] < 0:
        inward = -inward
    points = window.line[0] + 0.05 * inward + np.linspace(0.1, 0.9, 5)[:, None] * along
    area = length * (window.top - window.bottom) / len(points)
    total = np.zeros(len(centres))
    for point in points:
        squared, seen = _seen(walls, point, centres)
        ahead = np.clip((centres - point) @ inward, 0, None) / np.sqrt(squared + 1e-9)
        total += area * seen * ahead / (0.8 + squared)
    return total


def _seen(
    walls: NDArray[np.float64], source: Points, centres: Points, beams: int = 720
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the squared distance of each cell from a source, and whether no wall is between."""
    away = centres - source
    squared = np.einsum("ij,ij->i", away, away)
    reach = cast(walls, source[0], source[1], np.linspace(0, 2 * np.pi, beams, endpoint=False))
    beam = np.round(np.arctan2(away[:, 1], away[:, 0]) * (beams / (2 * np.pi))).astype(int) % beams
    return squared, np.sqrt(squared) <= reach[beam] + 0.1


def _bounced(
    direct: NDArray[np.float64], rooms: NDArray[np.int64], share: float = 0.45, floor: float = 0.02
) -> NDArray[np.float64]:
    """Add the light that comes back from the walls; soften the edges of shadows."""
    total = direct + floor
    for room in range(int(rooms.max()) + 1):
        here = rooms == room
        if here.any():
            total[here] += share * direct[here].mean(axis=0)
    return np.asarray(ndimage.gaussian_filter(total, (2.0, 2.0, 0.0)))


def _contact(blocks: list[Block], raster: Raster) -> NDArray[np.float32]:
    """Return what part of the light reaches the floor, less beside and under furniture."""
    low = [block.outline for block in blocks if block.closed and block.bottom < 1.0]
    covered = raster.fill(low).astype(float)
    return np.asarray(1 - 0.6 * ndimage.gaussian_filter(covered, 1.5), dtype=np.float32)
