"""What stands in rooms and corridors, as a laser near the ground sees it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from placecue_sources.plans.layout import Space
from placecue_sources.plans.rectangle import Rectangle

#: Side of the leg of a table or chair, m.
_LEG = 0.06


def furniture_of(
    space: Space, room: Rectangle, amount: float, rng: np.random.Generator
) -> Iterator[Rectangle]:
    """Yield the footprints of things in a space.

    Parameters
    ----------
    space : Space
        The space.
    room : Rectangle
        Where its walls end.
    amount : float
        From 0, nothing, to 1, full.
    rng : Generator
        Where they come from.
    """
    if amount <= 0 or min(room.width, room.height) < 0.8:
        return
    if space.label == "corridor":
        yield from _along_walls(room, 0.12 * amount, (0.2, 0.45), (0.3, 1.5), rng)
        return
    yield from _along_walls(room, 0.7 * amount, (0.3, 0.9), (0.4, 2.2), rng)
    for _ in range(rng.poisson(amount * room.area / 9)):
        yield from _table(room, rng)
    if room.area > 60:
        for _ in range(rng.poisson(amount * room.area / 25)):
            yield _partition(room, rng)


def _along_walls(
    room: Rectangle,
    share: float,
    depths: tuple[float, float],
    lengths: tuple[float, float],
    rng: np.random.Generator,
) -> Iterator[Rectangle]:
    """Yield cupboards, shelves, beds against a share of the walls."""
    left = share * 2 * (room.width + room.height) * float(rng.uniform(0.5, 1))
    while left > 0:
        length, depth = float(rng.uniform(*lengths)), float(rng.uniform(*depths))
        left -= length
        side, along = int(rng.integers(4)), float(rng.random())
        if side < 2:
            x = room.x0 + max(room.width - length, 0) * along
            y = room.y0 if side == 0 else room.y1 - depth
            piece = Rectangle(x, y, x + length, y + depth)
        else:
            y = room.y0 + max(room.height - length, 0) * along
            x = room.x0 if side == 2 else room.x1 - depth
            piece = Rectangle(x, y, x + depth, y + length)
        yield piece.within(room)


def _anywhere(room: Rectangle, width: float, height: float, rng: np.random.Generator) -> Rectangle:
    x = room.x0 + max(room.width - width, 0) * float(rng.random())
    y = room.y0 + max(room.height - height, 0) * float(rng.random())
    return Rectangle(x, y, x + width, y + height).within(room)


def _table(room: Rectangle, rng: np.random.Generator) -> Iterator[Rectangle]:
    """Yield the legs of a table and its chairs, or a solid piece."""
    width, height = rng.uniform(0.6, 1.8, 2).tolist()
    table = _anywhere(room, width, height, rng)
    if rng.random() < 0.4:
        yield table
        return
    yield from _legs(table)
    for _ in range(rng.integers(0, 4)):
        chair = _anywhere(table.inset(-0.5).within(room), 0.45, 0.45, rng)
        yield from _legs(chair)


def _legs(piece: Rectangle) -> Iterator[Rectangle]:
    for x in (piece.x0, piece.x1 - _LEG):
        for y in (piece.y0, piece.y1 - _LEG):
            yield Rectangle(x, y, x + _LEG, y + _LEG)


def _partition(room: Rectangle, rng: np.random.Generator) -> Rectangle:
    """Return a screen between desks of an open plan."""
    length = float(rng.uniform(1.2, 4.0))
    sides = (length, 0.08) if rng.random() < 0.5 else (0.08, length)
    return _anywhere(room, *sides, rng)
