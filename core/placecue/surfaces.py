"""Rooms as surfaces: free space shared out to the areas of a map."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from placecue.free_space import FREE, Grid
from placecue.polygons import Polygon, outlines
from placecue.semantic_map import Area, SemanticMap

#: No cell of an area.
NOBODY = -1
#: From the middle of a door to where its wall surely begins, m.
DOOR_HALF_WIDTH = 0.6
#: Nearer to a door it is not sure which of its two areas a position of the way lies in, m.
DOOR_APRON = 1.0

Owners = NDArray[np.int32]


def with_surfaces(semantic_map: SemanticMap, grid: Grid | None, reach: float = 10.0) -> SemanticMap:
    """Give each area its surface: the free cells that are reached first from where it was seen.

    Parameters
    ----------
    semantic_map : SemanticMap
        A map; it is not changed.
    grid : Grid or None
        Free space; None leaves all areas without a surface.
    reach : float
        A cell farther than this from every area's way belongs to none, m.

    Returns
    -------
    SemanticMap
        Areas of another frame than the grid's have no surface.
    """
    if grid is None:
        return semantic_map
    owners = shared_out(semantic_map, grid, reach)
    areas = tuple(
        replace(area, surface=surface_of(owners == row, grid))
        for row, area in enumerate(semantic_map.areas)
    )
    return replace(semantic_map, areas=areas)


def shared_out(semantic_map: SemanticMap, grid: Grid, reach: float) -> Owners:
    """Return the row of the area that each cell belongs to, NOBODY where none, by first arrival.

    Free space is walked from the ways of all areas at once, in steps to the sides and corners of
    cells in turn; not through doors, whose own cells are shared out last. Of areas that arrive at
    once the first has it.
    """
    free = grid.states == FREE
    doors = _doors(semantic_map, grid) & free
    owners = np.full(free.shape, NOBODY, np.int32)
    # What lies between two doors is reached from nowhere else than the way at the doors.
    for at_doors in (False, True):
        new, left = np.full_like(owners, NOBODY), free & ~doors & (owners == NOBODY)
        for row, area in enumerate(semantic_map.areas):
            for i, j in grid.cells_of(_seeds(semantic_map, area, grid.frame, at_doors)):
                if left[i, j] and new[i, j] == NOBODY:
                    new[i, j] = row
        _spread(new, left, round(reach / grid.cell))
        owners = np.where(owners == NOBODY, new, owners)
    _spread(owners, free & (doors | (owners != NOBODY)), round(DOOR_HALF_WIDTH / grid.cell))
    return owners


def surface_of(mask: NDArray[np.bool_], grid: Grid) -> tuple[Polygon, ...]:
    """Return the polygons of some cells, m."""
    return tuple(
        tuple(
            tuple(
                (round(grid.x + x * grid.cell, 6), round(grid.y + y * grid.cell, 6))
                for x, y in ring
            )
            for ring in polygon
        )
        for polygon in outlines(mask)
    )


def _seeds(
    semantic_map: SemanticMap, area: Area, frame: str, at_doors: bool
) -> NDArray[np.float64]:
    """Return where an area was seen for sure, or all of its way, m."""
    if area.frame != frame:
        return np.empty((0, 2))
    nodes = [(n.x, n.y) for n in semantic_map.nodes if n.area == area.id and not n.gateway]
    way = np.array(area.trajectory).reshape(-1, 2)
    if not at_doors:
        way = _away_from_doors(semantic_map, way)
    return np.concatenate([way, np.array(nodes).reshape(-1, 2)])


def _away_from_doors(semantic_map: SemanticMap, way: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the positions that are not at a door: there the way is handed over late or early."""
    for node in semantic_map.nodes:
        if node.gateway:
            way = way[np.hypot(way[:, 0] - node.x, way[:, 1] - node.y) > DOOR_APRON]
    return way


def _doors(semantic_map: SemanticMap, grid: Grid) -> NDArray[np.bool_]:
    """Return the cells on the lines between the posts of doors, without a gap."""
    mask = np.zeros(grid.states.shape, dtype=bool)
    along = np.arange(-DOOR_HALF_WIDTH, DOOR_HALF_WIDTH, grid.cell / 4)
    for node in semantic_map.nodes:
        if node.gateway:
            x = node.x - np.sin(node.heading) * along
            y = node.y + np.cos(node.heading) * along
            rows, columns = grid.cells_of(np.column_stack([x, y])).T
            mask[rows, columns] = True
    thick = mask.copy()  # no step to a corner passes it
    thick[:, 1:] |= mask[:, :-1]
    return thick


def _spread(owners: Owners, free: NDArray[np.bool_], steps: int) -> None:
    """Let areas grow through free space, in place."""
    idle = 0
    for step in range(steps):
        new = _arriving(owners, corners=step % 2 == 1)
        grown = free & (owners == NOBODY) & (new != NOBODY)
        owners[grown] = new[grown]
        idle = 0 if grown.any() else idle + 1
        if idle == 2:  # neither to the sides nor to the corners
            return


def _arriving(owners: Owners, corners: bool) -> Owners:
    """Return the first area among the neighbours of each cell, NOBODY where there is none."""
    height, width = owners.shape
    padded = np.pad(owners, 1, constant_values=NOBODY)
    padded = np.where(padded == NOBODY, np.iinfo(np.int32).max, padded)
    sides = [(0, 1), (2, 1), (1, 0), (1, 2)]
    around = [*sides, (0, 0), (0, 2), (2, 0), (2, 2)] if corners else sides
    first = np.minimum.reduce([padded[i : i + height, j : j + width] for i, j in around])
    return np.where(first == np.iinfo(np.int32).max, NOBODY, first).astype(np.int32)
