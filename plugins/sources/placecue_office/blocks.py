"""What plan items look like in space: prisms with a material on each side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from placecue.errors import DataError, choices
from placecue_office.plan import Furniture, Panel, Plan, Points, Wall


@dataclass(frozen=True, slots=True)
class Block:
    """A vertical prism.

    Parameters
    ----------
    outline : ndarray, shape (k, 2)
        Footprint, counter-clockwise, m; a panel is a single edge (k = 2).
    bottom, top : float
        Height range, m.
    sides : tuple of (str or None)
        Material of each edge's face; None takes that of the room that it faces.
    cover : str or None
        Material of top and bottom; None where they are never seen.
    glow : float
        How bright it shines by itself, in units of the daylight; 0 does not.
    solid : bool
        Whether a robot would bump into it.
    key : int
        Decides how pictures on it are drawn.
    """

    outline: Points
    bottom: float
    top: float
    sides: tuple[str | None, ...]
    cover: str | None = None
    glow: float = 0.0
    solid: bool = True
    key: int = 0

    @property
    def closed(self) -> bool:
        """Whether the footprint has an inside."""
        return len(self.outline) > 2


def blocks_of(plan: Plan, furniture: tuple[Furniture, ...]) -> list[Block]:
    """Return every block of a plan, with the furniture where it stands in this run."""
    blocks = [_wall(wall, key) for key, wall in enumerate(plan.walls)]
    blocks += [_panel(panel) for panel in plan.panels]
    blocks += [_lamp(lamp, plan.height) for lamp in plan.lamps]
    for item in furniture:
        blocks += furniture_blocks(item)
    return blocks


def _wall(wall: Wall, key: int) -> Block:
    start, end = wall.line
    along = (end - start) / np.linalg.norm(end - start)
    side = 0.5 * wall.thickness * np.array([-along[1], along[0]])
    outline = np.array([start - side, end - side, end + side, start + side])
    cover = wall.material or "plain #d8d5cc"
    return Block(outline, wall.bottom, wall.top, (wall.material,) * 4, cover, key=key)


def _panel(panel: Panel) -> Block:
    glow = 1.0 if panel.window else 0.0
    sides = (panel.material,)
    return Block(panel.line, panel.bottom, panel.top, sides, None, glow, False, panel.key)


def _lamp(lamp: Points, ceiling: float) -> Block:
    x, y, length, width = lamp
    half = 0.5 * np.array([length, width])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half + [x, y]
    return Block(corners, ceiling - 0.07, ceiling, ("lamp",) * 4, "lamp", glow=-1.0, solid=False)


def furniture_blocks(item: Furniture) -> list[Block]:
    """Return the blocks that a piece of furniture is made of.

    Raises
    ------
    DataError
        If its type is unknown.
    """
    if item.type not in _TYPES:
        raise DataError(f"furniture of type '{item.type}': {choices(item.type, _TYPES)}")
    return [replace(block, key=item.key) for block in _TYPES[item.type](item)]


def _box(item: Furniture) -> Iterator[Block]:
    edges = np.roll(item.outline, -1, axis=0) - item.outline
    lengths = np.linalg.norm(edges, axis=1)
    long = lengths > 0.75 * lengths.max()
    sides = tuple(item.material if each else item.ends for each in long)
    yield Block(item.outline, item.bottom, item.top, sides, item.cover)


def _table(item: Furniture) -> Iterator[Block]:
    """Yield a slab and a leg at each corner; many-sided tables stand on one foot."""
    slab, leg, inset = 0.04, 0.06, 0.92
    count = len(item.outline)
    under = item.top - slab
    yield Block(item.outline, under, item.top, (item.ends,) * count, item.cover)
    centre = item.outline.mean(axis=0)
    round_table = count >= 8 and np.ptp(np.linalg.norm(item.outline - centre, axis=1)) < 0.05
    feet = centre[None] if round_table else centre + inset * (item.outline - centre)
    width = 3 * leg if round_table else leg
    for foot in feet:
        yield Block(_square(foot, width), item.bottom, under, (item.material,) * 4)


def _chair(item: Furniture) -> Iterator[Block]:
    """Yield foot, seat and back; the first edge of the outline is the front."""
    a, b, c, d = item.outline
    centre = item.outline.mean(axis=0)
    yield Block(_square(centre, 0.3), 0.0, 0.07, (item.ends,) * 4, item.ends)
    yield Block(_square(centre, 0.08), 0.07, 0.42, (item.ends,) * 4)
    yield Block(item.outline, 0.42, 0.5, (item.material,) * 4, item.cover)
    rear = np.array([c + 0.12 * (b - c), c, d, d + 0.12 * (a - d)])
    yield Block(rear, 0.5, item.top, (item.material,) * 4, item.cover)


def _plant(item: Furniture) -> Iterator[Block]:
    """Yield a pot and three tiers of leaves, the middle one as wide as the outline."""
    centre, count = item.outline.mean(axis=0), len(item.outline)
    pot = centre + 0.55 * (item.outline - centre)
    yield Block(pot, item.bottom, item.bottom + 0.3, (item.ends,) * count, item.ends)
    tiers = np.linspace(item.bottom + 0.3, item.top, 4)
    for width, low, high in zip((0.7, 1.0, 0.65), tiers, tiers[1:], strict=False):
        leaves = centre + width * (item.outline - centre)
        yield Block(leaves, low, high, (item.material,) * count, item.material)


def _square(centre: Points, width: float) -> Points:
    return centre + 0.5 * width * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


_TYPES = {"box": _box, "table": _table, "chair": _chair, "plant": _plant}
