"""Small things that stand about: bins, boxes, bags, crates."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from placecue_office.floor import Floor
from placecue_office.plan import Furniture, turned

#: First keys of the clutter's pictures.
_KEYS = 30_000

_COLOURS = ("#8a5a34", "#b08a58", "#3f5a78", "#70302c", "#4c6a4a", "#2e2e34", "#c8c4b8", "#c09030")
_MATERIALS = ("plain", "wood", "fabric", "drawers", "machine", "cupboard", "slats")


@dataclass(frozen=True, slots=True)
class Clutter:
    """How small things are put about.

    Parameters
    ----------
    sizes : (float, float)
        Shortest and longest side, m; lengths between are drawn on a log scale.
    heights : (float, float)
        Lowest and highest, m.
    tries : int
        Places tried before a thing is left out.
    """

    sizes: tuple[float, float] = (0.12, 0.5)
    heights: tuple[float, float] = (0.35, 1.1)
    tries: int = 40

    def scattered(
        self, floor: Floor, count: int, rng: np.random.Generator, first: int = 0
    ) -> list[Furniture]:
        """Return things put on free places of a floor, which then knows of them.

        Parameters
        ----------
        floor : Floor
        count : int
            How many; fewer where there is no room.
        rng : Generator
        first : int
            Number of the first; decides its pictures.
        """
        drawn = [self._drawn(rng, first + number) for number in range(count)]
        placed = [self.placed(item, floor, rng) for item in drawn]
        return [item for item in placed if item is not None]

    def placed(self, item: Furniture, floor: Floor, rng: np.random.Generator) -> Furniture | None:
        """Put a thing somewhere else; None where there is no room for it."""
        free = floor.free()
        shape = item.outline - item.outline.mean(axis=0)
        for _ in range(self.tries if len(free) else 0):
            outline = turned(shape, rng.uniform(0, np.pi)) + free[rng.integers(len(free))]
            if floor.fits(outline):
                moved = replace(item, outline=outline)
                floor.put(moved)
                return moved
        return None

    def _drawn(self, rng: np.random.Generator, number: int) -> Furniture:
        shortest, longest = np.log(self.sizes).tolist()
        sides = np.exp(rng.uniform(shortest, longest, 2))
        outline = 0.5 * sides * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        colour = str(rng.choice(_COLOURS))
        material = f"{rng.choice(_MATERIALS)} {colour}"
        top = float(rng.uniform(*self.heights))
        plain = f"plain {colour}"
        return Furniture("box", outline, 0.0, top, material, plain, plain, key=_KEYS + number)
