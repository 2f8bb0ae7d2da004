"""From surfaces to light: textures looked up, lit, and developed by the sensor."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from placecue_office.arrays import CEILING, FLOOR, Eye, Geometry, Ground, Skin
from placecue_office.sun import shading, sunlit

#: How much of each colour is the grey of all three: a sensor's filters let others through.
MIXED = 0.25


@njit(cache=True)
def texel(
    texels: NDArray[np.uint8],
    start: int,
    width: int,
    height: int,
    u: float,
    v: float,
    channel: NDArray[np.float64],
) -> None:
    """Look a texture up between its pixels; ``u`` runs across, ``v`` up, both repeat at 1.

    The result goes into ``channel`` (3,): linear light in 0 to 1, the square of the stored value.
    """
    across, down = (u - np.floor(u)) * width - 0.5, (1.0 - v + np.floor(v)) * height - 0.5
    left, top = int(np.floor(across)), int(np.floor(down))
    right_part, lower_part = across - left, down - top
    near, far = left & (width - 1), (left + 1) & (width - 1)
    upper_row, lower_row = (
        (top & (height - 1)) * width + start,
        ((top + 1) & (height - 1)) * width + start,
    )
    for k in range(3):
        upper = (
            texels[upper_row + near, k] * (1 - right_part) + texels[upper_row + far, k] * right_part
        )
        lower = (
            texels[lower_row + near, k] * (1 - right_part) + texels[lower_row + far, k] * right_part
        )
        value = (upper * (1 - lower_part) + lower * lower_part) / 255.0
        channel[k] = value * value


@njit(cache=True)
def lit(
    light: NDArray[np.float32],
    u: float,
    v: float,
    dimmed: float,
    sun: NDArray[np.float64],
    share: float,
    channel: NDArray[np.float64],
) -> None:
    """Multiply ``channel`` (3,) by the light between cells; u, v count cells from the corner.

    ``dimmed`` is what part of that light arrives, ``share`` what part of the sunlight.
    """
    u, v = (
        min(max(u - 0.5, 0.0), light.shape[1] - 1.001),
        min(max(v - 0.5, 0.0), light.shape[0] - 1.001),
    )
    i, j = int(v), int(u)
    p, q = v - i, u - j
    for k in range(3):
        low = light[i, j, k] * (1 - q) + light[i, j + 1, k] * q
        high = light[i + 1, j, k] * (1 - q) + light[i + 1, j + 1, k] * q
        channel[k] *= (low * (1 - p) + high * p) * dimmed + share * sun[k]


@njit(cache=True)
def _level(pixel: float, across: float, up: float, last: int) -> int:
    """Return the size at which a texture's pixels are about as large as ``pixel`` metres.

    ``across`` and ``up`` are texture pixels a metre at full size.
    """
    texels = pixel * np.sqrt(across * up)
    level = 0
    while texels > 1.4 and level < last:
        texels *= 0.5
        level += 1
    return level


@njit(cache=True)
def _on_face(
    face: NDArray[np.float64], px: float, py: float, dx: float, dy: float
) -> tuple[float, float, float, float]:
    """Return how far along a face (px, py) is, how squarely it is seen, and its normal."""
    ex, ey = face[2] - face[0], face[3] - face[1]
    length = np.sqrt(ex * ex + ey * ey)
    ex, ey = ex / length, ey / length
    along = (px - face[0]) * ex + (py - face[1]) * ey
    facing = dx * ey - dy * ex
    if facing > 0.0:  # seen from behind: from its other side a picture is read the right way round
        return length - along, facing, -ey, ex
    return along, -facing, ey, -ex


@njit(cache=True)
def _resolve(number: int, geometry: Geometry, skin: Skin, ground: Ground, i: int, j: int) -> int:
    """Return the surface: floor (-1) and ceiling (-2) are those of the room at cell (i, j)."""
    if number >= 0:
        return number
    rooms = (len(skin.textures) - len(geometry.faces) - len(geometry.caps)) // 2
    first = len(skin.textures) - (2 if number == FLOOR else 1) * rooms
    return first + int(ground.rooms[i, j])


@njit(cache=True)
def _clamp(value: float, count: int) -> int:
    return min(max(int(value), 0), count - 1)


@njit(cache=True)
def _corner(height: float, ceiling: float) -> float:
    """Return what part of the light gets to an upright face, less near floor and ceiling."""
    away = max(min(height, ceiling - height), 0.0)
    return 0.55 + 0.45 * away / (away + 0.1)


@njit(cache=True)
def shade(
    depth: NDArray[np.float32],
    surface: NDArray[np.int32],
    geometry: Geometry,
    skin: Skin,
    ground: Ground,
    eye: Eye,
) -> NDArray[np.float32]:
    """Return the light that reaches each pixel, shape (height, width, 3), linear.

    Parameters
    ----------
    depth, surface
        As :func:`~placecue_office.trace.trace` gives them.
    geometry, skin, ground, eye
        The world and where it is seen from.
    """
    columns, rows = depth.shape
    image = np.empty((rows, columns, 3), dtype=np.float32)
    channel = np.empty(3)
    toward = ground.sun.toward
    blocks = shading(geometry, ground)
    for column in range(columns):
        aside = (0.5 * columns - column - 0.5) / eye.focal
        dx, dy = eye.cos - eye.sin * aside, eye.sin + eye.cos * aside
        for row in range(rows):
            reach, number = depth[column, row], surface[column, row]
            down = (row + 0.5 - 0.5 * rows) / eye.focal
            px, py, pixel = eye.x + reach * dx, eye.y + reach * dy, reach / eye.focal
            x, y = px, py
            if 0 <= number < len(geometry.faces):
                u, square, nx, ny = _on_face(geometry.faces[number], x, y, dx, dy)
                height = eye.z - reach * down
                v = height - geometry.spans[number, 0]
                x, y = px + 0.15 * nx, py + 0.15 * ny  # the light in front of the face
                px, py = px + 0.01 * nx, py + 0.01 * ny
                dimmed = (0.72 + 0.28 * abs(nx)) * _corner(height, geometry.ceiling)
                facing = (nx * toward[0] + ny * toward[1]) * toward[3]
            else:
                u, v, square, dimmed = x, y, abs(down), 1.0
                facing = toward[4] if down > 0.0 and number != CEILING else 0.0
            gx, gy = (x - ground.x) / ground.cell, (y - ground.y) / ground.cell
            i, j = _clamp(gy, ground.rooms.shape[0]), _clamp(gx, ground.rooms.shape[1])
            if number == FLOOR:
                dimmed = ground.contact[i, j]
            at = _resolve(number, geometry, skin, ground, i, j)
            _look_up(skin, at, u, v, pixel / np.sqrt(max(square, 0.03)), channel)
            if skin.glows[at] == 0.0:
                if facing > 0.0 and len(ground.sun.windows) > 0:
                    height = eye.z - reach * down
                    room = ground.rooms[i, j]
                    if not sunlit(geometry, ground.sun, blocks, room, px, py, height):
                        facing = 0.0
                share = max(facing, 0.0) if len(ground.sun.windows) > 0 else 0.0
                lit(ground.light, gx, gy, dimmed, ground.sun.colour, share, channel)
            for k in range(3):
                own = 1.0 if skin.glows[at] == 0.0 else ground.shine[int(skin.glows[at] < 0.0), k]
                image[row, column, k] = channel[k] * own
    return image


@njit(cache=True)
def _look_up(
    skin: Skin, at: int, u: float, v: float, pixel: float, channel: NDArray[np.float64]
) -> None:
    """Put the colour of surface ``at``, u and v metres along it, into ``channel``."""
    k, across, up = skin.textures[at], skin.scales[at, 0], skin.scales[at, 1]
    last = skin.offsets.shape[1] - 1
    level = _level(pixel, across * skin.widths[k, 0], up * skin.heights[k, 0], last)
    start, width, height = skin.offsets[k, level], skin.widths[k, level], skin.heights[k, level]
    texel(skin.texels, start, width, height, u * across, v * up, channel)


@njit(cache=True)
def _mix(state: np.uint64) -> np.uint64:
    """Return well mixed bits of a counter (splitmix64, Steele, Lea, Flood, OOPSLA 2014)."""
    state += np.uint64(0x9E3779B97F4A7C15)
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return state ^ (state >> np.uint64(31))


@njit(cache=True)
def develop(
    image: NDArray[np.float32], gain: float, noise: float, key: np.uint64
) -> NDArray[np.uint8]:
    """Turn linear light into an 8 bit image with sensor noise.

    Parameters
    ----------
    image : ndarray, shape (height, width, 3)
        Linear light.
    gain : float
        Exposure.
    noise : float
        Standard deviation at gain 1, grey levels; it grows with the root of the gain.
    key : uint64
        Decides the noise of this image.

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        RGB, gamma 2.
    """
    rows, columns, _ = image.shape
    out = np.empty((rows, columns, 3), dtype=np.uint8)
    # Two bytes summed have a triangular distribution of standard deviation 104.5.
    sigma = noise * np.sqrt(gain) / 104.5
    for row in range(rows):
        for column in range(columns):
            bits = _mix(key + np.uint64(row * columns + column))
            light = image[row, column]
            grey = MIXED * (light[0] + light[1] + light[2]) / 3
            for k in range(3):
                wobble = int(bits & np.uint64(255)) + int((bits >> np.uint64(8)) & np.uint64(255))
                bits >>= np.uint64(16)
                exposed = ((1.0 - MIXED) * light[k] + grey) * gain
                soft = exposed / (1.0 + 0.35 * exposed) * 1.35
                value = 255.0 * np.sqrt(soft) + sigma * (wobble - 255)
                out[row, column, k] = np.uint8(min(max(value + 0.5, 0.0), 255.0))
    return out
