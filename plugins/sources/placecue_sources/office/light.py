"""Light in the plan: lamps on the ceiling and daylight through the windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from placecue_sources.office.arrays import Geometry, Ground
from placecue_sources.office.blocks import Block
from placecue_sources.office.plan import Panel, Plan, Points
from placecue_sources.office.raster import Raster
from placecue_sources.office.trace import cast

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
    """

    lamps: Colour
    sky: Colour
    view: Colour


ILLUMINATIONS: dict[str, Illumination] = {
    "cloudy": Illumination((0.40, 0.35, 0.27), (0.50, 0.62, 0.80), (1.4, 1.55, 1.75)),
    "night": Illumination((0.75, 0.60, 0.38), (0.0, 0.0, 0.0), (0.02, 0.02, 0.035)),
    "sunny": Illumination((0.10, 0.09, 0.07), (2.4, 1.95, 1.30), (2.8, 2.7, 2.4)),
}

#: How bright a lamp looks, in strengths of its light.
LAMP_SHINE = 4.0


def light_up(
    plan: Plan, blocks: list[Block], geometry: Geometry, light: Illumination, cell: float = 0.1
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
    cell : float
        Width of a cell, m.
    """
    raster = Raster.over(plan, cell)
    centres = raster.centres()
    rooms = _nearest_room(plan, raster)
    direct = _direct(plan, geometry, centres, light).reshape(*raster.shape, 3)
    return Ground(
        rooms=rooms,
        light=_bounced(direct, rooms).astype(np.float32),
        contact=_contact(blocks, raster),
        shine=np.array([light.view, LAMP_SHINE * np.array(light.lamps)]),
        x=float(raster.origin[0]),
        y=float(raster.origin[1]),
        cell=cell,
    )


def _nearest_room(plan: Plan, raster: Raster) -> NDArray[np.int64]:
    """Return the room of each cell; cells in walls take the nearest."""
    rooms = plan.room_at(raster.centres()).reshape(raster.shape)
    nearest = ndimage.distance_transform_edt(rooms < 0, return_distances=False, return_indices=True)
    return np.ascontiguousarray(rooms[tuple(nearest)])


def _direct(
    plan: Plan, geometry: Geometry, centres: Points, light: Illumination
) -> NDArray[np.float64]:
    walls = np.ascontiguousarray(geometry.faces[geometry.spans[:, 1] - geometry.spans[:, 0] > 2.0])
    total = np.zeros((len(centres), 3))
    drop = plan.height - 1.0
    for x, y, length, width in plan.lamps:
        squared, seen = _seen(walls, np.array([x, y]), centres)
        falloff = (drop**2 / (drop**2 + squared)) ** 1.5
        total += np.outer(seen * falloff * (length * width / 0.36), light.lamps)
    for panel in plan.panels:
        if panel.window:
            total += np.outer(_through(panel, plan, walls, centres), light.sky)
    return total


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
