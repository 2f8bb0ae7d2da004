"""Textures that repeat over a surface: paint, carpet, tiles, wood.

Each function draws a square texture from a generator and a colour, shape (n, n, 3), floats in
0 to 255; row 0 is the top.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from placecue_office.noise import Shade, fractal_noise, value_noise
from placecue_office.walls import TALL, WIDE, brick, concrete, half_tiled, paint, woodchip

Draw = Callable[[np.random.Generator, Shade, int], Shade]


@dataclass(frozen=True, slots=True)
class Surface:
    """How a repeating texture is drawn and how large it is.

    Parameters
    ----------
    draw : callable
        Draws it.
    metres : float
        Width of one repeat, m.
    tall : float or None
        Height of one repeat, m; None makes it square.
    finer : int
        Times more pixels across than other surfaces have, a power of two.
    """

    draw: Draw
    metres: float
    tall: float | None = None
    finer: int = 1


def _shaded(colour: Shade, brightness: Shade) -> Shade:
    return np.clip(colour * brightness[..., None], 0, 255)


def _grain(rng: np.random.Generator, n: int) -> Shade:
    return rng.standard_normal((n, n))


def plain(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw plastic or metal with a few scratches."""
    return _shaded(colour, 1 + 0.04 * fractal_noise(rng, n, n, 2, 5) + 0.015 * _grain(rng, n))


def linoleum(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw marbled linoleum: clouds, speckles, scuff marks along both directions."""
    clouds = 0.10 * fractal_noise(rng, n, n, 4, 5) + 0.05 * _grain(rng, n)
    scuffs = 0.06 * (value_noise(rng, n, n, (4, 128)) > 0.93)
    speckles = 0.25 * (rng.random((n, n)) > 0.985)
    return _shaded(colour, 1 + clouds - scuffs - speckles)


def carpet(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw loop-pile carpet: strong fine grain, worn patches, a woven grid."""
    rows, columns = np.mgrid[0:n, 0:n]
    weave = 0.05 * (((rows // 4 + columns // 4) % 2) - 0.5)
    worn = 0.10 * fractal_noise(rng, n, n, 3, 4)
    return _shaded(colour, 1 + worn + weave + 0.14 * _grain(rng, n))


def _tiling(rng: np.random.Generator, colour: Shade, n: int, count: int, grout: float) -> Shade:
    cell = n // count
    shades = 1 + 0.07 * rng.standard_normal((count, count))
    brightness: Shade = np.kron(shades, np.ones((cell, cell))).astype(np.float64)
    brightness += 0.05 * fractal_noise(rng, n, n, 8, 4) + 0.02 * _grain(rng, n)
    image = _shaded(colour, brightness)
    joint = np.arange(n) % cell < max(2, n // 170)
    image[joint[:, None] | joint[None, :]] = grout
    return image


def tiles(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw floor tiles of 0.32 m, dark joints."""
    return _tiling(rng, colour, n, 8, 70.0)


def wall_tiles(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw small glazed wall tiles with white joints; every tenth is coloured."""
    image = _tiling(rng, colour, n, 8, 225.0)
    cell = n // 8
    for row, column in rng.integers(0, 8, (6, 2)):
        at = np.s_[row * cell + 3 : (row + 1) * cell, column * cell + 3 : (column + 1) * cell]
        image[at] *= np.array([0.45, 0.6, 0.9])
    return image


def wood(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw veneer: long fibres and a few broad rings, along the horizontal."""
    rings = value_noise(rng, n, n, (6, 2)) * 9 + 0.6 * fractal_noise(rng, n, n, 4, 3)
    saw = np.abs(rings % 1.0 - 0.5)
    fibres = value_noise(rng, n, n, (n // 2, 4)) - 0.5
    return _shaded(colour, 0.9 + 0.25 * saw + 0.14 * fibres + 0.02 * _grain(rng, n))


def fabric(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw woven cloth."""
    rows, columns = np.mgrid[0:n, 0:n]
    threads = 0.08 * (((rows + columns) % 6 < 3) - 0.5)
    return _shaded(colour, 1 + threads + 0.08 * _grain(rng, n) + 0.08 * fractal_noise(rng, n, n))


def stone(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw a granite worktop: coarse specks of two kinds."""
    specks = 0.45 * (rng.random((n, n)) > 0.9) - 0.35 * (rng.random((n, n)) > 0.85)
    return _shaded(colour, 1 + specks + 0.08 * fractal_noise(rng, n, n, 8, 4))


def leaves(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw foliage: patches of light and dark."""
    patches = fractal_noise(rng, n, n, 12, 4)
    return _shaded(colour, np.clip(0.75 + 1.5 * patches, 0.1, 1.7) + 0.08 * _grain(rng, n))


def slats(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw upright wooden slats with dark gaps, 8 a repeat."""
    image = wood(rng, colour, n).transpose(1, 0, 2).copy()
    step = n // 8
    image[:, np.arange(n) % step > 0.78 * step] *= 0.25
    return image


def ceiling(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw acoustic ceiling panels of 0.6 m with pin holes."""
    image = _shaded(colour, 1 + 0.02 * _grain(rng, n) - 0.22 * (rng.random((n, n)) > 0.95))
    joint = np.arange(n) % (n // 2) < 3
    image[joint[:, None] | joint[None, :]] *= 0.72
    return image


SURFACES: dict[str, Surface] = {
    **{
        draw.__name__: Surface(draw, WIDE, TALL, finer=2)
        for draw in (paint, woodchip, brick, half_tiled, concrete)
    },
    "plain": Surface(plain, 1.5),
    "linoleum": Surface(linoleum, 1.6),
    "carpet": Surface(carpet, 1.3),
    "tiles": Surface(tiles, 2.56),
    "wall_tiles": Surface(wall_tiles, 1.2),
    "wood": Surface(wood, 1.4),
    "fabric": Surface(fabric, 0.8),
    "stone": Surface(stone, 0.9),
    "leaves": Surface(leaves, 0.9),
    "slats": Surface(slats, 0.96),
    "ceiling": Surface(ceiling, 1.2),
}
