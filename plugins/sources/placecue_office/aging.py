"""What half a year changes: furniture shifted and exchanged, other pictures on the walls."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from placecue_office.floor import Floor
from placecue_office.plan import Furniture, Panel, Plan, Points

#: Pictures of one half-year have keys this far above those of the one before.
_HALF_YEAR = 100_000


@dataclass(frozen=True, slots=True)
class Aging:
    """How much changes in half a year.

    Parameters
    ----------
    shifted : float
        Part of the floor-standing furniture that is shifted.
    shift : (float, float)
        Least and greatest distance, m.
    exchanged : float
        Part of all furniture that comes in another colour and with other things in it.
    posters : float
        Part of posters and notice boards that are other ones.
    tries : int
        Shifts tried before a piece stays.
    """

    shifted: float = 0.65
    shift: tuple[float, float] = (0.3, 0.75)
    exchanged: float = 0.7
    posters: float = 0.9
    tries: int = 40

    def later(self, plan: Plan, floor: Floor, rng: np.random.Generator) -> Plan:
        """Return the plan half a year later; the floor then knows of what was shifted."""
        plan = self._rearranged(plan, floor, rng)
        return replace(
            plan,
            panels=tuple(self._hung(panel, rng) for panel in plan.panels),
            furniture=tuple(self._exchanged(item, rng) for item in plan.furniture),
        )

    def _rearranged(self, plan: Plan, floor: Floor, rng: np.random.Generator) -> Plan:
        standing = [item for item in plan.furniture if item.bottom == 0 and not item.moves]
        wanted = round(self.shifted * len(standing))
        for number in rng.permutation(len(standing)):
            item = standing[number]
            step = self._step(item, floor, rng) if wanted else None
            if step is not None:
                plan = _shifted(plan, item, step, floor)
                wanted -= 1
        return plan

    def _step(self, item: Furniture, floor: Floor, rng: np.random.Generator) -> Points | None:
        """Return a shift that leaves a piece of furniture in its room and touching nothing."""
        floor.take(item)
        centre = item.outline.mean(axis=0)
        shape = 0.94 * (item.outline - centre) + centre  # walls may be touched
        for _ in range(self.tries):
            angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(*self.shift)
            step = far * np.array([np.cos(angle), np.sin(angle)])
            if floor.fits(shape + step):
                floor.put(item)
                return step
        floor.put(item)
        return None

    def _hung(self, panel: Panel, rng: np.random.Generator) -> Panel:
        name, _, colour = panel.material.partition(" #")
        fresh = rng.random() < self.posters
        drawn = _other_colour(colour, rng)
        if panel.window or not fresh or name not in ("poster", "noticeboard", "whiteboard"):
            return panel
        return replace(panel, material=f"{name} #{drawn}", key=panel.key + _HALF_YEAR)

    def _exchanged(self, item: Furniture, rng: np.random.Generator) -> Furniture:
        chance, shades = rng.random(), rng.integers(2**31)
        if chance >= self.exchanged:
            return item
        looks = (
            _recoloured(each, np.random.default_rng(shades))
            for each in (item.material, item.cover, item.ends)
        )
        material, cover, ends = looks
        key = item.key + _HALF_YEAR
        return replace(item, material=material, cover=cover, ends=ends, key=key)


def _shifted(plan: Plan, item: Furniture, step: Points, floor: Floor) -> Plan:
    """Move a piece of furniture, what stands on it, and what is fixed to its front."""
    low, high = item.outline.min(axis=0) - 0.03, item.outline.max(axis=0) + 0.03

    def goes_along(points: Points, bottom: float, limit: float) -> bool:
        middle = points.mean(axis=0)
        return bool(bottom < limit and (low <= middle).all() and (middle <= high).all())

    furniture = []
    for each in plan.furniture:
        rides = each.bottom > 0 and goes_along(each.outline, each.bottom, item.top + 0.1)
        if each is item or rides:
            floor.take(each)
            each = replace(each, outline=each.outline + step)
            floor.put(each)
        furniture.append(each)
    panels = tuple(
        replace(panel, line=panel.line + step)
        if not panel.window and goes_along(panel.line, panel.bottom, item.top)
        else panel
        for panel in plan.panels
    )
    return replace(plan, furniture=tuple(furniture), panels=panels)


def _recoloured(material: str, rng: np.random.Generator) -> str:
    name, _, colour = material.partition(" #")
    return f"{name} #{_other_colour(colour, rng)}" if colour else material


def _other_colour(colour: str, rng: np.random.Generator) -> str:
    old = np.array(list(bytes.fromhex(colour or "c8c8c8")), dtype=float)
    new = old * rng.uniform(0.5, 1.3) + rng.uniform(-25, 25, 3)
    return bytes(np.clip(new, 20, 245).astype(np.uint8).tolist()).hex()
