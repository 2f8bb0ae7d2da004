"""Sunlight that falls through windows."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from placecue_office.arrays import Geometry, Ground, Sun
from placecue_office.plan import Plan
from placecue_office.trace import crossing

#: Blocks nearer than this to a point do not shade it: it lies on them, m.
_OWN = 0.03


def shining(
    plan: Plan, bearing: float, elevation: float, colour: tuple[float, float, float]
) -> Sun:
    """Return the sun and the windows that it shines through.

    Parameters
    ----------
    plan : Plan
    bearing : float
        Direction of the sun in the plan, rad.
    elevation : float
        Its height above the horizon, rad; below it the sun does not shine.
    colour : (float, float, float)
        Light on a surface that faces it, red, green, blue.
    """
    toward = np.array([np.cos(bearing), np.sin(bearing)])
    windows = [
        (*panel.line.ravel(), panel.bottom, panel.top, float(room))
        for panel in plan.panels
        if panel.window and elevation > 0
        for room, outward in [_faces(plan, panel.line)]
        if outward @ toward > 0.05
    ]
    return Sun(
        np.array(windows, dtype=np.float64).reshape(-1, 7),
        np.array([*toward, np.tan(max(elevation, 0.0)), np.cos(elevation), np.sin(elevation)]),
        np.array(colour, dtype=np.float64),
    )


def _faces(plan: Plan, line: NDArray[np.float64]) -> tuple[int, NDArray[np.float64]]:
    """Return the room behind a window, and the direction out of it."""
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    outward, middle = np.array([along[1], -along[0]]), line.mean(axis=0)
    room = int(plan.room_at((middle - 0.3 * outward)[None])[0])
    if room < 0:
        outward = -outward
        room = int(plan.room_at((middle - 0.3 * outward)[None])[0])
    return room, outward


@njit(cache=True)
def shading(geometry: Geometry, ground: Ground) -> NDArray[np.int64]:
    """Return the blocks lower than the ceiling that stand in the rooms which the sun gets into."""
    rows, columns = ground.rooms.shape
    chosen = np.empty(len(geometry.caps), dtype=np.int64)
    count = 0
    for block in range(len(geometry.caps)):
        first, last = geometry.starts[block], geometry.starts[block + 1]
        if last - first < 3 or geometry.spans[first, 1] >= geometry.ceiling:
            continue
        x, y = 0.0, 0.0
        for k in range(first, last):
            x, y = x + geometry.faces[k, 0], y + geometry.faces[k, 1]
        j = int((x / (last - first) - ground.x) / ground.cell)
        i = int((y / (last - first) - ground.y) / ground.cell)
        if not (0 <= i < rows and 0 <= j < columns):
            continue
        for k in range(len(ground.sun.windows)):
            if int(ground.sun.windows[k, 6]) == ground.rooms[i, j]:
                chosen[count] = block
                count += 1
                break
    return chosen[:count]


@njit(cache=True)
def sunlit(
    geometry: Geometry,
    sun: Sun,
    blocks: NDArray[np.int64],
    room: int,
    x: float,
    y: float,
    z: float,
) -> bool:
    """Tell whether the sun reaches a point of a room through one of the room's windows."""
    dx, dy, rise = sun.toward[0], sun.toward[1], sun.toward[2]
    for k in range(len(sun.windows)):
        if int(sun.windows[k, 6]) != room:
            continue
        reach = crossing(sun.windows[k, :4], x, y, dx, dy)
        if reach == np.inf:
            continue
        height = z + reach * rise
        if sun.windows[k, 4] < height < sun.windows[k, 5]:
            return not _shaded(geometry, blocks, x, y, z, dx, dy, rise, reach)
    return False


@njit(cache=True)
def _shaded(
    geometry: Geometry,
    blocks: NDArray[np.int64],
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    rise: float,
    window: float,
) -> bool:
    """Tell whether a (convex) block stands between a point and the window, ``window`` m away."""
    for block in blocks:
        first, last = geometry.starts[block], geometry.starts[block + 1]
        enters, leaves, crossed = np.inf, 0.0, 0
        for k in range(first, last):
            reach = crossing(geometry.faces[k], x, y, dx, dy)
            if reach < np.inf:
                crossed += 1
                enters, leaves = min(enters, reach), max(leaves, reach)
        if crossed == 0 or enters > window - 0.3:
            continue
        if crossed == 1:
            enters = 0.0
        low, high = z + max(enters, _OWN) * rise, z + leaves * rise
        bottom, top = geometry.spans[first, 0], geometry.spans[first, 1]
        if leaves > _OWN and low < top and high > bottom:
            return True
    return False
