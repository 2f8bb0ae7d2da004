"""Tileable value noise and random colours, what the textures are made from."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Shade = NDArray[np.float64]


def value_noise(rng: np.random.Generator, rows: int, columns: int, cells: tuple[int, int]) -> Shade:
    """Return smooth noise in [0, 1] that repeats without a seam, shape (rows, columns).

    Parameters
    ----------
    rng : Generator
    rows, columns : int
        Size, pixels.
    cells : (int, int)
        Number of lattice cells down and across; one value is drawn at each lattice point.
    """
    lattice = rng.random(cells)
    top, bottom, down = _lattice_steps(rows, cells[0])
    left, right, across = _lattice_steps(columns, cells[1])
    rows_of_lattice = lattice[:, left] * (1 - across) + lattice[:, right] * across
    upper, lower = rows_of_lattice[top], rows_of_lattice[bottom]
    return np.asarray(upper * (1 - down[:, None]) + lower * down[:, None])


def _lattice_steps(pixels: int, cells: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Shade]:
    at = np.arange(pixels) * cells / pixels
    low = np.floor(at).astype(np.int64)
    part = at - low
    return low, (low + 1) % cells, part * part * (3 - 2 * part)


def fractal_noise(
    rng: np.random.Generator, rows: int, columns: int, coarsest: int = 4, octaves: int = 5
) -> Shade:
    """Return value noise summed over octaves, about zero mean and within [-1, 1].

    Each octave has twice the frequency and 0.6 times the amplitude of the one before.
    """
    total = np.zeros((rows, columns))
    weights = 0.6 ** np.arange(octaves)
    for octave, weight in enumerate(weights):
        cells = min(coarsest << octave, rows), min(coarsest << octave, columns)
        total += weight * (2 * value_noise(rng, rows, columns, cells) - 1)
    return np.asarray(total / weights.sum())


def jitter(rng: np.random.Generator, colour: Shade, spread: float) -> Shade:
    """Return a colour (3,) near ``colour``: another brightness, a little another hue."""
    moved = colour * (1 + spread * rng.uniform(-1, 1)) + 60 * spread * rng.uniform(-1, 1, 3)
    return np.clip(moved, 0, 255)


def vivid(rng: np.random.Generator) -> Shade:
    """Return a random saturated colour (3,), such as a book's back has."""
    hue = rng.random() * 6
    ramp = np.clip(np.abs((hue + np.array([0.0, 4.0, 2.0])) % 6 - 3) - 1, 0, 1)
    saturation, value = rng.uniform(0.25, 0.9), rng.uniform(60, 225)
    return np.asarray(value * (1 - saturation * (1 - ramp)))
