"""Walls, a whole storey tall: paper, brick or tiles, and cable ducts, sockets, notes, scuffs.

A robot often looks at a wall and little else. What is on it differs from room to room: its surface
is the plan's, the rest is drawn from the world and the room's colour.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from placecue_office.noise import Shade, fractal_noise, jitter, value_noise

#: Size of one repeat, m; below the ceiling it goes on.
WIDE, TALL = 5.4, 2.7


class _Wall:
    """A wall that is drawn on in metres; y counts from the floor."""

    def __init__(self, image: Shade) -> None:
        self.image = image

    def at(self, x: float, y: float, wide: float, tall: float) -> tuple[slice, slice]:
        """Return the pixels of a box of which x and y are the left and the lower edge."""
        rows, columns = self.image.shape[:2]
        top, foot = (int((TALL - each) * rows / TALL) for each in (y + tall, y))
        left, right = (int(each * columns / WIDE) for each in (x, x + wide))
        return slice(max(top, 0), max(foot, top + 1)), slice(left, max(right, left + 1))

    def fill(self, x: float, y: float, wide: float, tall: float, colour: Shade | float) -> None:
        """Paint a box."""
        self.image[self.at(x, y, wide, tall)] = colour

    def dim(self, x: float, y: float, wide: float, tall: float, share: float | Shade) -> None:
        """Make a box darker, or lighter."""
        self.image[self.at(x, y, wide, tall)] *= share

    def raised(self, x: float, y: float, wide: float, tall: float, colour: Shade) -> None:
        """Paint a box that stands out: light above, a shadow below."""
        self.dim(x, y - 0.025, wide, 0.025, 0.75)
        self.fill(x, y, wide, tall, colour)
        self.fill(x, y + tall - 0.012, wide, 0.012, np.minimum(1.12 * colour, 255))


def paint(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw a papered and painted wall."""
    return _used(rng, _papered(rng, n)[..., None] * colour)


def woodchip(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw a wall with woodchip paper, whose chips stand out."""
    chips = np.maximum(value_noise(rng, n, n, (n // 3, n // 3)) - 0.6, 0)
    relief = chips - np.roll(chips, 2, axis=0)
    return _used(rng, (_papered(rng, n) + 1.1 * relief)[..., None] * colour)


def brick(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw a painted wall of bricks, 0.24 by 0.075 m."""
    rows, columns = np.mgrid[0:n, 0:n] * np.array([TALL / 0.075, WIDE / 0.24])[:, None, None] / n
    columns = (columns + 0.5 * (np.floor(rows) % 2)) % (WIDE / 0.24)
    shades = 1 + 0.05 * rng.standard_normal((64, 64))
    brightness = shades[rows.astype(int) % 64, columns.astype(int) % 64]
    brightness *= np.where((rows % 1 > 0.87) | (columns % 1 > 0.95), 0.72, 1.0)
    brightness *= np.where((rows % 1 < 0.1) & (columns % 1 < 0.95), 1.1, 1.0)
    return _used(rng, (brightness * _papered(rng, n))[..., None] * colour)


def half_tiled(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw a wall with tiles of 0.15 m up to 1.5 m, painted above."""
    image = _papered(rng, n)[..., None] * colour
    rows, columns = np.mgrid[0:n, 0:n] * np.array([TALL, WIDE])[:, None, None] / (0.15 * n)
    shades = 1 + 0.04 * rng.standard_normal((36, 36))
    glazed = shades[rows.astype(int), columns.astype(int)]
    glazed = glazed * np.where((rows % 1 > 0.93) | (columns % 1 > 0.95), 0.7, 1.0)
    tiled = np.arange(n) > n * (1 - 1.5 / TALL)
    image[tiled] = (glazed[..., None] * jitter(rng, np.array([215.0, 216, 210]), 0.1))[tiled]
    return _used(rng, image)


def concrete(rng: np.random.Generator, colour: Shade, n: int) -> Shade:
    """Draw painted concrete that shows the boards it was cast between, and the holes of ties."""
    boards = np.arange(n) * 14 // n
    grain = 0.12 * (value_noise(rng, n, n, (n // 4, 8)) - 0.5)
    brightness = (1 + 0.05 * rng.standard_normal(14))[boards][:, None] + grain
    brightness[np.flatnonzero(np.diff(boards))] -= 0.2
    for row, column in product((0.2, 0.5, 0.8), np.arange(0.1, 1.0, 0.15)):
        at = np.s_[int(row * n) : int(row * n) + 6, int(column * n) : int(column * n) + 3]
        brightness[at] -= 0.45
    return _used(rng, (brightness * _papered(rng, n))[..., None] * colour)


def _used(rng: np.random.Generator, image: Shade) -> Shade:
    """Draw what hangs, runs and is left on a wall."""
    wall = _Wall(image)
    _scuffed(rng, wall)
    _piped(rng, wall)
    _wired(rng, wall)
    _noted(rng, wall)
    _skirted(rng, wall)
    return np.clip(wall.image, 0, 255)


def _papered(rng: np.random.Generator, n: int) -> Shade:
    """Return how bright paint is with stains, joints every 1.35 m, and the grain of the paper."""
    stains = 0.05 * fractal_noise(rng, n, n, 3, 4) + 0.02 * fractal_noise(rng, n, n, 64, 2)
    boards = np.repeat(1 + 0.012 * rng.standard_normal(4), n // 4)
    boards[:: n // 4] -= 0.06
    height = np.linspace(TALL, 0, n)
    worn = np.where(height < 0.5, 0.88 + 0.24 * height, 1.0)
    return np.asarray((1 + stains + 0.012 * rng.standard_normal((n, n))) * boards * worn[:, None])


def _scuffed(rng: np.random.Generator, wall: _Wall, count: int = 50) -> None:
    for x, y, share in zip(
        rng.uniform(0, WIDE, count),
        rng.gamma(2.0, 0.25, count),
        rng.uniform(0.55, 0.95, count),
        strict=True,
    ):
        wall.dim(x, min(y, 2.2), rng.uniform(0.01, 0.25), rng.uniform(0.006, 0.03), share)
    for x, y in rng.uniform((0, 0.9), (WIDE, 2.1), (25, 2)):  # holes and old tape
        wall.dim(x, y, 0.03, 0.02, rng.choice([0.6, 0.85, 1.08]))


def _piped(rng: np.random.Generator, wall: _Wall) -> None:
    """Draw upright pipes, and one along the ceiling."""
    for x in rng.uniform(0, WIDE - 0.1, int(rng.integers(0, 4))):
        width = float(rng.uniform(0.02, 0.06))
        colour = jitter(rng, wall.image.mean(axis=(0, 1)), 0.2)
        wall.dim(x + width, 0, 0.03, TALL, 0.8)
        for part, share in ((0.0, 0.85), (0.3, 1.1), (0.65, 0.7)):
            wall.fill(x + part * width, 0, (1 - part) * width, TALL, share * colour)
    if rng.random() < 0.5:
        wall.raised(0, rng.uniform(2.25, 2.6), WIDE, rng.uniform(0.03, 0.1), np.full(3, 175.0))


def _wired(rng: np.random.Generator, wall: _Wall) -> None:
    """Draw a cable duct with sockets on it, and switches."""
    height = float(rng.choice([rng.uniform(0.18, 0.35), rng.uniform(0.75, 1.2)]))
    white = jitter(rng, np.array([222.0, 220, 212]), 0.12)
    if rng.random() < 0.7:
        wall.raised(0, height, WIDE, rng.uniform(0.06, 0.13), jitter(rng, white, 0.15))
    for x in np.arange(rng.uniform(0.1, 0.6), WIDE - 0.3, rng.uniform(0.7, 1.6)):
        for number in range(int(rng.integers(1, 4))):
            wall.raised(x + 0.085 * number, height + 0.01, 0.075, 0.075, white)
            wall.fill(x + 0.085 * number + 0.02, height + 0.03, 0.035, 0.03, 70.0)
    for x in rng.uniform(0.1, WIDE - 0.3, 3):
        wall.raised(x, 1.08, 0.08, 0.08, white)
        wall.fill(x + 0.03, 1.1, 0.02, 0.04, 150.0)


def _noted(rng: np.random.Generator, wall: _Wall) -> None:
    """Hang up notes with lines of text, a row of hooks, and boxes such as thermostats."""
    for x in rng.uniform(0, WIDE - 0.4, int(rng.integers(3, 8))):
        y, tall = float(rng.uniform(1.15, 1.75)), float(rng.choice([0.15, 0.21, 0.3, 0.42]))
        paper = jitter(rng, np.array([226.0, 222, 205]), 0.2)
        wall.dim(x + 0.01, y - 0.01, 0.72 * tall, tall, 0.85)
        wall.fill(x, y, 0.72 * tall, tall, paper)
        for line in np.arange(y + 0.02, y + 0.9 * tall, 0.022):
            wall.dim(x + 0.02, line, rng.uniform(0.3, 0.62) * tall, 0.01, 0.5)
    for x in rng.uniform(0, WIDE - 0.3, int(rng.integers(1, 4))):
        wide, tall = rng.uniform(0.08, 0.28, 2)
        wall.raised(x, rng.uniform(1.2, 2.1), wide, tall, jitter(rng, np.full(3, 150.0), 0.6))
    if rng.random() < 0.5:
        left = float(rng.uniform(0, WIDE - 1.0))
        for x in np.arange(left, left + 0.9, 0.14):
            wall.fill(x, 1.6, 0.025, 0.08, 45.0)


def _skirted(rng: np.random.Generator, wall: _Wall) -> None:
    tall, share = float(rng.uniform(0.06, 0.12)), float(rng.uniform(0.3, 0.6))
    wall.dim(0, 0, WIDE, tall, share)
    wall.dim(0, tall, WIDE, 0.012, 0.7)
