"""Textures that fill one face: book shelves, doors, posters, screens, machines, windows.

Each function draws one of ``h`` by ``w`` pixels from a generator and a colour, shape (h, w, 3),
floats in 0 to 255; row 0 is the top. No two faces get the same draw.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from placecue_office.noise import Shade, fractal_noise, jitter, vivid

Picture = Callable[[np.random.Generator, Shade, int, int], Shade]


def _base(rng: np.random.Generator, colour: Shade, h: int, w: int, rough: float = 0.05) -> Shade:
    grain = rough * fractal_noise(rng, h, w) + 0.015 * rng.standard_normal((h, w))
    return np.clip(colour * (1 + grain)[..., None], 0, 255)


def _fill(image: Shade, box: tuple[float, float, float, float], colour: Shade | float) -> None:
    """Fill a box given as top, left, bottom, right in parts of the image."""
    image[_box(image, box)] = colour


def _box(image: Shade, box: tuple[float, float, float, float]) -> tuple[slice, slice]:
    top, left, bottom, right = box
    return _span(top, bottom, image.shape[0]), _span(left, right, image.shape[1])


def _span(low: float, high: float, pixels: int) -> slice:
    start = min(int(low * pixels), pixels - 1)
    return slice(start, max(int(high * pixels), start + 1))


def _cover(
    rng: np.random.Generator,
    image: Shade,
    box: tuple[float, float, float, float],
    colour: Shade,
    rough: float,
) -> None:
    """Fill a box with an uneven colour."""
    at = _box(image, box)
    h, w = image[at].shape[:2]
    image[at] = _base(rng, colour, h, w, rough)


def _steps(rng: np.random.Generator, low: float, high: float) -> Iterator[tuple[float, float]]:
    """Yield intervals that fill 0 to 1, each between ``low`` and ``high`` long."""
    start = 0.0
    while start < 1.0:
        end = min(start + rng.uniform(low, high), 1.0)
        yield start, end
        start = end


def _lines(
    rng: np.random.Generator, image: Shade, box: tuple[float, float, float, float], ink: float
) -> None:
    """Write lines of words into a box."""
    top, left, bottom, right = box
    pitch = max(0.02, 4 / image.shape[0])
    for row in np.arange(top, bottom - pitch, pitch):
        for start, end in _steps(rng, 0.06, 0.3):
            if rng.random() < 0.75:
                span = left + (right - left) * start, left + (right - left) * (end - 0.03)
                image[_box(image, (row, span[0], row + pitch / 2, span[1]))] *= ink


def bookshelf(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw shelves of books and binders of many colours, with some gaps."""
    image = _base(rng, colour, h, w)
    shelves = max(2, round(h / 56))
    for shelf in range(shelves):
        top, bottom = (shelf + 0.1) / shelves, (shelf + 0.96) / shelves
        _fill(image, (top, 0.02, bottom, 0.98), 28.0)
        for left, right in _steps(rng, 4 / w, 12 / w):
            if rng.random() < 0.9:
                _book(rng, image, bottom, (bottom - top) * rng.uniform(0.6, 0.97), (left, right))
    return image


def _book(
    rng: np.random.Generator, image: Shade, foot: float, tall: float, span: tuple[float, float]
) -> None:
    left, right = 0.02 + 0.96 * span[0], 0.02 + 0.96 * span[1] - 0.003
    cover = vivid(rng)
    _fill(image, (foot - tall, left, foot, right), cover)
    _fill(image, (foot - 0.8 * tall, left, foot - rng.uniform(0.5, 0.75) * tall, right), 225.0)
    _fill(image, (foot - 0.2 * tall, left, foot - 0.14 * tall, right), 0.4 * cover)


def cupboard(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw cupboard doors side by side, with handles."""
    return _fronts(rng, colour, h, w, 1, max(1, round(w / 90)))


def drawers(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw drawers above one another."""
    return _fronts(rng, colour, h, w, max(2, round(h / 45)), 1)


def pigeonholes(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw open boxes for mail, some with paper in them."""
    image = _base(rng, colour, h, w)
    rows, columns = max(3, round(h / 26)), max(3, round(w / 44))
    for row, column in np.ndindex(rows, columns):
        top, left = (row + 0.1) / rows, (column + 0.06) / columns
        bottom, right = (row + 0.95) / rows, (column + 0.94) / columns
        _fill(image, (top, left, bottom, right), 35.0)
        level = bottom - rng.uniform(0, 0.7) * (bottom - top)
        _fill(image, (level, left, bottom, right), jitter(rng, np.array([225.0, 222, 210]), 0.15))
    return image


def _fronts(
    rng: np.random.Generator, colour: Shade, h: int, w: int, rows: int, columns: int
) -> Shade:
    image = np.full((h, w, 3), 30.0)
    for row, column in np.ndindex(rows, columns):
        top, left = row / rows + 3 / h, column / columns + 2 / w
        bottom, right = (row + 1) / rows - 2 / h, (column + 1) / columns - 2 / w
        _cover(rng, image, (top, left, bottom, right), jitter(rng, colour, 0.04), 0.05)
        across = left + 0.35 * (right - left), left + 0.65 * (right - left)
        _fill(image, (top + 7 / h, across[0], top + 10 / h, across[1]), 90.0)
    return image


def door(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a door leaf with grain, kick plate, handle, and sometimes a notice."""
    image = _base(rng, colour, h, w, 0.1)
    image *= 1 + 0.06 * (fractal_noise(rng, 1, w, 1, 1)[..., None])
    _fill(image, (0.9, 0.03, 0.99, 0.97), jitter(rng, np.array([150.0, 150, 152]), 0.05))
    _fill(image, (0.48, 0.06, 0.505, 0.2), 60.0)
    _fill(image, (0.46, 0.06, 0.56, 0.1), 175.0)
    if rng.random() < 0.5:
        _sheet(rng, image, (0.22, 0.35, 0.36, 0.65))
    return image


def _sheet(rng: np.random.Generator, image: Shade, box: tuple[float, float, float, float]) -> None:
    """Pin a sheet of paper: text, or a coloured picture."""
    top, left, bottom, right = box
    _fill(image, box, jitter(rng, np.array([236.0, 234, 226]), 0.06))
    margin = 0.1 * (right - left), 0.1 * (bottom - top)
    inner = top + margin[1], left + margin[0], bottom - margin[1], right - margin[0]
    if rng.random() < 0.4:
        figure = inner[0], inner[1], top + 0.55 * (bottom - top), inner[3]
        _cover(rng, image, figure, vivid(rng), 0.6)
        inner = (top + 0.6 * (bottom - top), *inner[1:])
    _lines(rng, image, inner, 0.45)


def poster(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a conference poster or a print: headline, blocks of text, figures."""
    image = _base(rng, jitter(rng, colour, 0.15), h, w, 0.1)
    _fill(image, (0.03, 0.04, 0.14, 0.96), vivid(rng))
    _lines(rng, image, (0.05, 0.1, 0.13, 0.9), 2.2)
    columns = int(rng.integers(1, 4))
    for column in range(columns):
        left, right = 0.04 + 0.92 * column / columns, 0.02 + 0.92 * (column + 1) / columns
        for top, bottom in _steps(rng, 0.15, 0.4):
            _sheet(rng, image, (0.17 + 0.8 * top, left, 0.15 + 0.8 * bottom, right))
    return np.clip(image, 0, 255)


def noticeboard(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a cork board with many sheets, some over others."""
    image = _base(rng, colour, h, w, 0.15)
    for _ in range(max(6, h * w // 1500)):
        tall, wide = rng.uniform(28, 52) / h, rng.uniform(22, 44) / w
        top, left = rng.uniform(0, max(1 - tall, 0.01)), rng.uniform(0, max(1 - wide, 0.01))
        _sheet(rng, image, (top, left, min(top + tall, 1), min(left + wide, 1)))
    return _framed(image, 70.0)


def _framed(image: Shade, shade: float) -> Shade:
    edge = 3
    image[:edge], image[-edge:], image[:, :edge], image[:, -edge:] = shade, shade, shade, shade
    return image


def whiteboard(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a white board with strokes of four pens."""
    image = _base(rng, np.array([228.0, 231, 233]), h, w, 0.02)
    pens = np.array([[40, 60, 150], [180, 40, 40], [30, 30, 30], [30, 120, 60]])
    for _ in range(14):
        x, y = rng.uniform(0.1, 0.8) * w, rng.uniform(0.1, 0.9) * h
        steps = np.cumsum(rng.normal(0, 1.2, (60, 2)) + rng.normal(0, 0.6, 2), axis=0)
        rows = np.clip(y + steps[:, 0], 4, h - 5).astype(int)
        image[rows, np.clip(x + steps[:, 1], 4, w - 5).astype(int)] = pens[rng.integers(4)]
    return _framed(image, 150.0)


def screen(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a computer screen with windows of text on a coloured desktop."""
    image = _base(rng, vivid(rng), h, w, 0.3)
    for _ in range(int(rng.integers(1, 4))):
        top, left = rng.uniform(0.05, 0.4), rng.uniform(0.05, 0.45)
        _fill(image, (top, left, top + 0.5, left + 0.5), rng.choice([238.0, 245.0, 30.0]))
        _fill(image, (top, left, top + 0.05, left + 0.5), vivid(rng))
        _lines(rng, image, (top + 0.08, left + 0.03, top + 0.48, left + 0.46), 0.4)
    return _framed(image, 25.0)


def machine(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw the front of a printer or copier: paper trays, slots, a panel with keys."""
    image = _base(rng, colour, h, w)
    for tray in range(3):
        top = 0.45 + 0.17 * tray
        _fill(image, (top, 0.04, top + 0.012, 0.96), 50.0)
        _fill(image, (top + 0.05, 0.35, top + 0.08, 0.65), 85.0)
    _fill(image, (0.22, 0.08, 0.36, 0.6), 38.0)
    _fill(image, (0.30, 0.12, 0.36, 0.55), 232.0)
    _fill(image, (0.04, 0.55, 0.16, 0.95), 62.0)
    _fill(image, (0.06, 0.6, 0.13, 0.75), np.array([90.0, 170, 190]))
    for key in range(5):
        _fill(image, (0.07, 0.78 + 0.03 * key, 0.1, 0.8 + 0.03 * key), vivid(rng))
    return image


def oven(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw an oven or microwave: dark glass, a bar, knobs."""
    image = _base(rng, colour, h, w)
    _fill(image, (0.28, 0.08, 0.92, 0.92), 22.0)
    _fill(image, (0.34, 0.14, 0.6, 0.5), 48.0)
    _fill(image, (0.2, 0.1, 0.24, 0.9), 120.0)
    for knob in range(4):
        _fill(image, (0.05, 0.12 + 0.2 * knob, 0.14, 0.2 + 0.2 * knob), 40.0)
    return image


def fridge(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a fridge with two doors, handles and magnets that hold notes."""
    image = _base(rng, colour, h, w, 0.02)
    _fill(image, (0.34, 0, 0.35, 1), 60.0)
    _fill(image, (0.2, 0.06, 0.32, 0.1), 130.0)
    _fill(image, (0.38, 0.06, 0.55, 0.1), 130.0)
    for _ in range(5):
        top, left = rng.uniform(0.05, 0.5), rng.uniform(0.2, 0.75)
        _sheet(rng, image, (top, left, top + 0.08, left + 0.18))
    return image


def window(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a window: sky, houses and trees outside, perhaps a blind, sash bars, frame."""
    ramp = np.linspace(1.0, rng.uniform(0.75, 0.95), h)[:, None, None]
    image = _base(rng, colour, h, w, 0.12) * ramp
    for _ in range(int(rng.integers(0, 4))):
        _house(rng, image)
    _trees(rng, image)
    if rng.random() < 0.6:
        _blind(rng, image, float(rng.uniform(0.1, 0.6)))
    for bar in _sashes(rng, w):
        _fill(image, (0, bar - 4 / w, 1, bar + 4 / w), 150.0)
    _fill(image, (0, 0, 6 / h, 1), 150.0)
    _fill(image, (1 - 8 / h, 0, 1, 1), 150.0)
    _fill(image, (0, 0, 1, 6 / w), 150.0)
    _fill(image, (0, 1 - 6 / w, 1, 1), 150.0)
    return image


def _house(rng: np.random.Generator, image: Shade) -> None:
    """Put a house with rows of windows across the street."""
    top, left = rng.uniform(0.1, 0.6), rng.uniform(-0.2, 0.8)
    wide, floors, axes = rng.uniform(0.2, 0.6), int(rng.integers(2, 6)), int(rng.integers(2, 7))
    front = jitter(rng, np.array([165.0, 140, 122]), 0.35)
    _cover(rng, image, (top, max(left, 0.0), 1.0, min(left + wide, 1.0)), front, 0.1)
    for floor, axis in np.ndindex(floors, axes):
        x, y = left + wide * (axis + 0.25) / axes, top + (1 - top) * (floor + 0.3) / floors
        if 0 <= x <= 1 - 0.5 * wide / axes:
            box = (y, x, y + 0.45 * (1 - top) / floors, x + 0.5 * wide / axes)
            _fill(image, box, jitter(rng, np.array([75.0, 82, 92]), 0.4))


def _trees(rng: np.random.Generator, image: Shade) -> None:
    """Grow trees up to a line of their own in front of all that."""
    h, w = image.shape[:2]
    tall = rng.uniform(0.05, 0.5)
    skyline = (1 - tall * (0.9 + 0.6 * fractal_noise(rng, 1, w, 3, 5)[0])) * h
    below = np.arange(h)[:, None] > skyline[None, :]
    leaves = jitter(rng, np.array([92.0, 104, 82]), 0.25)
    image[below] = _base(rng, leaves, h, w, 0.8)[below]


def _blind(rng: np.random.Generator, image: Shade, down: float) -> None:
    """Let a venetian blind down over the upper part of a window."""
    slats = np.arange(0, down, 8 / image.shape[0])
    shade = jitter(rng, np.array([170.0, 168, 160]), 0.2)
    for top in slats:
        _fill(image, (top, 0.01, top + 6 / image.shape[0], 0.99), shade)


def _sashes(rng: np.random.Generator, w: int) -> list[float]:
    bars = max(2, round(w / rng.uniform(80, 130)))
    return [bar / bars for bar in range(1, bars)]


def radiator(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a radiator: upright ribs between two rails, and a valve."""
    ribs = 0.72 + 0.4 * np.abs(np.linspace(0, max(4, w / 9), w) % 1 - 0.5)
    image = _base(rng, colour, h, w, 0.03) * ribs[None, :, None]
    for top in (0.0, 0.93):
        _cover(rng, image, (top, 0, top + 0.07, 1), 0.95 * colour, 0.03)
    _fill(image, (0.04, 0.94, 0.2, 1.0), 70.0)
    return image


def curtain(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a curtain that hangs in folds."""
    folds = fractal_noise(rng, 1, w, max(4, w // 12), 2)[0]
    sag = fractal_noise(rng, h, w, 2, 3)
    image = _base(rng, colour, h, w, 0.05) * (1 + 0.45 * folds[None, :] + 0.08 * sag)[..., None]
    _fill(image, (0.0, 0.0, 0.03, 1.0), 95.0)
    return np.asarray(np.clip(image, 0, 255))


def lamp(rng: np.random.Generator, colour: Shade, h: int, w: int) -> Shade:
    """Draw a ceiling lamp: an even bright field."""
    return np.full((h, w, 3), 250.0)


PICTURES: dict[str, Picture] = {
    "bookshelf": bookshelf,
    "cupboard": cupboard,
    "drawers": drawers,
    "pigeonholes": pigeonholes,
    "door": door,
    "poster": poster,
    "noticeboard": noticeboard,
    "whiteboard": whiteboard,
    "screen": screen,
    "machine": machine,
    "oven": oven,
    "fridge": fridge,
    "window": window,
    "radiator": radiator,
    "curtain": curtain,
    "lamp": lamp,
}
