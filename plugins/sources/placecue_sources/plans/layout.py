"""Cuts a floor into corridors and rooms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from placecue_sources.plans.rectangle import Rectangle, Side
from placecue_sources.plans.style import Style, drawn

#: How often a block that is too deep is cut by a corridor of its own.
_DEEPEST = 3


@dataclass(frozen=True, slots=True)
class Space:
    """A corridor or room, up to the middle of the walls around it.

    Parameters
    ----------
    place : Rectangle
        Where it is.
    label : str
        ``corridor`` or ``room``.
    """

    place: Rectangle
    label: str


def spaces_of(style: Style, rng: np.random.Generator) -> list[Space]:
    """Return the corridors and rooms of a floor, which fill a rectangle."""
    return _Cutter(style, rng).floor()


class _Cutter:
    def __init__(self, style: Style, rng: np.random.Generator) -> None:
        self.style = style
        self.rng = rng
        self.spaces: list[Space] = []
        # Corridors and rooms of one building resemble one another.
        self.corridor = drawn(style.corridor, rng)
        self.room = drawn(style.room, rng)

    def floor(self) -> list[Space]:
        style = self.style
        length = drawn(style.length, self.rng)
        least = 2 * style.depth[0] + style.corridor[1]
        across = max(least, length * drawn(style.aspect, self.rng))
        floor = Rectangle(0, 0, max(length, across), across)
        if across > least + style.corridor[1] + 4 and self._happens(style.ring):
            self._ring(floor)
        else:
            self._spine(floor)
        return self.spaces

    def _happens(self, chance: float) -> bool:
        return bool(self.rng.random() < chance)

    def _width(self) -> float:
        """Return the width of a corridor, m."""
        wide = self.rng.uniform(1.2, 2.0) if self._happens(self.style.hall) else 1.0
        width = self.corridor * wide * float(self.rng.uniform(0.85, 1.15))
        return float(np.clip(width, self.style.corridor[0], 1.6 * self.style.corridor[1]))

    def _ring(self, floor: Rectangle) -> None:
        """Lay a corridor round a core, and blocks around it."""
        across = min(floor.width, floor.height)
        width = self._width()
        most = min((across - 3) / 2 - width, self.style.depth[1])
        deep = float(self.rng.uniform(min(self.style.depth[0], most), most))
        outer, core = floor.inset(deep), floor.inset(deep + width)
        south, rest = floor.cut(False, outer.y0)
        rest, north = rest.cut(False, outer.y1)
        west, rest = rest.cut(True, outer.x0)
        _, east = rest.cut(True, outer.x1)
        blocks: list[tuple[Rectangle, Side]]
        blocks = [(south, "N"), (north, "S"), (west, "E"), (east, "W")]
        for block, side in blocks:
            self._block(block, side, _DEEPEST)
        low, rest = outer.cut(False, core.y0)
        rest, high = rest.cut(False, core.y1)
        left, rest = rest.cut(True, core.x0)
        _, right = rest.cut(True, core.x1)
        self.spaces += [Space(part, "corridor") for part in (low, high, left, right)]
        if self._happens(0.8):  # else a courtyard
            self._slices(core, "S" if core.width > core.height else "W")

    def _spine(self, floor: Rectangle) -> None:
        """Lay a corridor along the floor, and a block on both sides."""
        along_x = floor.width >= floor.height
        width = self._width()
        low, high = (floor.y0, floor.y1) if along_x else (floor.x0, floor.x1)
        room = max(high - low - width, 0.0)
        at = low + room * float(self.rng.choice([0.0, self.rng.uniform(0.25, 0.75)], p=[0.1, 0.9]))
        first, rest = floor.cut(not along_x, at)
        corridor, second = rest.cut(not along_x, at + width)
        self.spaces.append(Space(self._shortened(corridor, along_x), "corridor"))
        sides: tuple[Side, Side] = ("N", "S") if along_x else ("E", "W")
        for block, side in zip((first, second), sides, strict=True):
            self._block(block, side, 0)

    def _shortened(self, corridor: Rectangle, along_x: bool) -> Rectangle:
        """Return a corridor that ends in a room, if it is to; the room is laid."""
        low, high = (corridor.x0, corridor.x1) if along_x else (corridor.y0, corridor.y1)
        end = self.room if self._happens(0.4) else 0.0
        if end < 1.8 or end > (high - low) / 2:
            return corridor
        shorter, room = corridor.cut(along_x, high - end)
        if min(room.width, room.height) > 1.2:
            self.spaces.append(Space(room, "room"))
        return shorter

    def _block(self, block: Rectangle, side: Side, level: int) -> None:
        """Fill a block with a corridor on one side of it."""
        upright = side in "NS"
        deep, long = (block.height, block.width) if upright else (block.width, block.height)
        if deep < 1.5 or long < 1.5:
            return
        if deep > self.style.depth[1] and level < _DEEPEST:
            self._branch(block, upright, level)
        else:
            self._slices(block, side)

    def _branch(self, block: Rectangle, upright: bool, level: int) -> None:
        """Lay a corridor through a block, away from the one on its side."""
        low, high = (block.x0, block.x1) if upright else (block.y0, block.y1)
        width = self._width()
        at = low + (high - low - width) * float(self.rng.uniform(0.2, 0.8))
        if high - low < width + 4 or at <= low:
            return self._slices(block, "S" if upright else "W")
        first, rest = block.cut(upright, at)
        corridor, second = rest.cut(upright, at + width)
        self.spaces.append(Space(corridor, "corridor"))
        sides: tuple[Side, Side] = ("E", "W") if upright else ("N", "S")
        for part, side in zip((first, second), sides, strict=True):
            self._block(part, side, level + 1)
        return None

    def _slices(self, block: Rectangle, side: Side) -> None:
        """Cut a block into rooms along the corridor."""
        along_x = side in "NS"
        rest, most = block, 25.0
        if self._happens(self.style.open_plan) and max(block.width, block.height) < most:
            self.spaces.append(Space(block, "room"))
            return
        while True:
            left = rest.width if along_x else rest.height
            width = self.room * float(np.exp(self.rng.normal(0, 0.3)))
            width = float(np.clip(width, *self.style.room))
            if left < width + self.style.room[0]:
                self._room(rest, along_x)
                return
            start = rest.x0 if along_x else rest.y0
            room, rest = rest.cut(along_x, start + width)
            self._room(room, along_x)

    def _room(self, room: Rectangle, along_x: bool) -> None:
        deep = room.height if along_x else room.width
        if deep > 4.5 and self._happens(self.style.back):
            start = room.y0 if along_x else room.x0
            parts = room.cut(not along_x, start + deep * float(self.rng.uniform(0.35, 0.65)))
            self.spaces += [Space(part, "room") for part in parts]
        else:
            self.spaces.append(Space(room, "room"))
