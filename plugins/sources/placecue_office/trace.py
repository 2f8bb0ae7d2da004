"""Casting rays through the plan: the nearest surface of every pixel, the length of every beam."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from placecue_office.arrays import CEILING, FLOOR, Eye, Geometry

#: Nearer than this nothing is drawn, m.
NEAR = 0.02


@njit(cache=True)
def crossing(face: NDArray[np.float64], x: float, y: float, dx: float, dy: float) -> float:
    """Return how many times (dx, dy) it takes from (x, y) to a face; inf if it never gets there."""
    ex, ey = face[2] - face[0], face[3] - face[1]
    across = dx * ey - dy * ex
    if across == 0.0:
        return np.inf
    ax, ay = face[0] - x, face[1] - y
    along = (ax * dy - ay * dx) / across
    reach = (ax * ey - ay * ex) / across
    if along < 0.0 or along > 1.0 or reach <= 0.0:
        return np.inf
    return float(reach)


@njit(cache=True)
def cast(
    faces: NDArray[np.float64], x: float, y: float, bearings: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distance from (x, y) to the first of ``faces`` along each bearing.

    Parameters
    ----------
    faces : ndarray, shape (k, 4)
        x0, y0, x1, y1 in m.
    x, y : float
        Where the rays start, m.
    bearings : ndarray, shape (n,)
        Directions in the frame of the plan, rad.

    Returns
    -------
    ndarray, shape (n,)
        Distances, m; infinite where nothing is hit.
    """
    lengths = np.full(len(bearings), np.inf)
    for i in range(len(bearings)):
        dx, dy = np.cos(bearings[i]), np.sin(bearings[i])
        for k in range(len(faces)):
            lengths[i] = min(lengths[i], crossing(faces[k], x, y, dx, dy))
    return lengths


@njit(cache=True)
def _paint(
    depth: NDArray[np.float32],
    surface: NDArray[np.int32],
    top: float,
    foot: float,
    reach: float,
    slope: float,
    number: int,
) -> None:
    """Write a face at depth ``reach``, or a cap whose depth is ``slope`` / rows off the horizon.

    ``top`` and ``foot`` are where it begins and ends in the column, pixels from the top edge.
    """
    first, last = max(int(np.ceil(top - 0.5)), 0), min(int(np.ceil(foot - 0.5)), len(depth))
    for row in range(first, last):
        at = reach if slope == 0.0 else slope / (row + 0.5 - 0.5 * len(depth))
        if at < depth[row]:
            depth[row] = at
            surface[row] = number


@njit(cache=True)
def _paint_caps(
    depth: NDArray[np.float32],
    surface: NDArray[np.int32],
    cap: NDArray[np.float64],
    near: float,
    far: float,
    eye: Eye,
    number: int,
) -> None:
    """Draw the top, if it lies below the eye, and the bottom, if it lies above."""
    middle = 0.5 * len(depth)
    over, under = eye.focal * (eye.z - cap[1]), eye.focal * (eye.z - cap[0])
    if over > 0.0:
        _paint(depth, surface, middle + over / far, middle + over / near, 0.0, over, number)
    if under < 0.0:
        _paint(depth, surface, middle + under / near, middle + under / far, 0.0, under, number)


@njit(cache=True)
def _background(
    depth: NDArray[np.float32], surface: NDArray[np.int32], eye: Eye, ceiling: float
) -> None:
    """Fill a column with floor below the horizon and ceiling above it.

    The middle one of an odd number of rows is on the horizon, which no floor or ceiling reaches:
    it has the ceiling that its upper half sees.
    """
    for row in range(len(depth)):
        below = row + 0.5 - 0.5 * len(depth)
        below = -0.25 if below == 0.0 else below
        surface[row] = FLOOR if below > 0.0 else CEILING
        depth[row] = eye.focal * (eye.z - (0.0 if below > 0.0 else ceiling)) / below


@njit(cache=True)
def _columns(geometry: Geometry, first: int, last: int, eye: Eye, width: int) -> tuple[int, int]:
    """Return the range of columns that faces ``first`` to ``last`` can be seen in."""
    left, right = np.inf, -np.inf
    for k in range(first, last):
        ax, ay = geometry.faces[k, 0] - eye.x, geometry.faces[k, 1] - eye.y
        bx, by = geometry.faces[k, 2] - eye.x, geometry.faces[k, 3] - eye.y
        a, b = ax * eye.cos + ay * eye.sin, bx * eye.cos + by * eye.sin  # ahead
        p, q = ay * eye.cos - ax * eye.sin, by * eye.cos - bx * eye.sin  # to the left
        if a < NEAR and b < NEAR:
            continue
        if a < NEAR:
            a, p = NEAR, q + (p - q) * (b - NEAR) / (b - a)
        elif b < NEAR:
            b, q = NEAR, p + (q - p) * (a - NEAR) / (a - b)
        left = min(left, -p / a, -q / b)
        right = max(right, -p / a, -q / b)
    if left > right:
        return 0, 0
    edges = 0.5 * width + eye.focal * left - 1.0, 0.5 * width + eye.focal * right + 2.0
    return int(min(max(edges[0], 0.0), width)), int(min(max(edges[1], 0.0), width))


@njit(cache=True)
def _ray(column: int, width: int, eye: Eye) -> tuple[float, float]:
    """Return the direction of a column in the plan, 1 long along the optical axis."""
    aside = (0.5 * width - column - 0.5) / eye.focal
    return eye.cos - eye.sin * aside, eye.sin + eye.cos * aside


@njit(cache=True)
def _limits(geometry: Geometry, eye: Eye, width: int) -> NDArray[np.float64]:
    """Return the reach to the nearest full wall in each column, shape (width,)."""
    limits = np.full(width, np.inf)
    for k in range(len(geometry.faces)):
        if geometry.spans[k, 0] <= 0.0 and geometry.spans[k, 1] >= geometry.ceiling:
            first, last = _columns(geometry, k, k + 1, eye, width)
            for column in range(first, last):
                dx, dy = _ray(column, width, eye)
                reach = crossing(geometry.faces[k], eye.x, eye.y, dx, dy)
                limits[column] = min(limits[column], reach)
    return limits


@njit(cache=True)
def trace(
    geometry: Geometry, eye: Eye, width: int, height: int
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Find the nearest surface of every pixel of an upright pinhole camera.

    Parameters
    ----------
    geometry : Geometry
        The world.
    eye : Eye
        The camera.
    width, height : int
        Size of the image, pixels.

    Returns
    -------
    depth : ndarray of float32, shape (width, height)
        Distance along the optical axis, m.
    surface : ndarray of int32, shape (width, height)
        Number of the surface; ``FLOOR`` and ``CEILING`` where nothing is in between.
    """
    depth = np.empty((width, height), dtype=np.float32)
    surface = np.empty((width, height), dtype=np.int32)
    limits = _limits(geometry, eye, width)
    for column in range(width):
        _background(depth[column], surface[column], eye, geometry.ceiling)
    for block in range(len(geometry.caps)):
        starts = geometry.starts[block], geometry.starts[block + 1]
        first, last = _columns(geometry, starts[0], starts[1], eye, width)
        reach = np.empty(starts[1] - starts[0])
        for column in range(first, last):
            dx, dy = _ray(column, width, eye)
            nearest = np.inf
            for k in range(len(reach)):
                reach[k] = crossing(geometry.faces[starts[0] + k], eye.x, eye.y, dx, dy)
                nearest = min(nearest, reach[k])
            if nearest <= limits[column]:
                _paint_block(depth[column], surface[column], geometry, block, reach, eye)
    return depth, surface


@njit(cache=True)
def _paint_block(
    depth: NDArray[np.float32],
    surface: NDArray[np.int32],
    geometry: Geometry,
    block: int,
    reach: NDArray[np.float64],
    eye: Eye,
) -> None:
    """Draw the faces of one block, and its top or bottom, into one column."""
    middle, crossed = 0.5 * len(depth), 0
    for k in range(len(reach)):
        if reach[k] == np.inf:
            continue
        crossed += 1
        face = geometry.starts[block] + k
        zoom = eye.focal / max(reach[k], NEAR)
        top = middle + zoom * (eye.z - geometry.spans[face, 1])
        foot = middle + zoom * (eye.z - geometry.spans[face, 0])
        _paint(depth, surface, top, foot, reach[k], 0.0, face)
    if crossed > 1 and not np.isnan(geometry.caps[block, 0]):
        ordered = np.sort(reach)
        number = len(geometry.faces) + block
        for k in range(0, crossed - 1, 2):
            near, far = max(ordered[k], NEAR), ordered[k + 1]
            _paint_caps(depth, surface, geometry.caps[block], near, far, eye, number)
