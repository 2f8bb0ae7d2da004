"""Where movable things stand in one run."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from placecue_sources.office.plan import Furniture, Plan, Points


def arrange(
    plan: Plan, rng: np.random.Generator, clear: float, tries: int = 12
) -> tuple[Furniture, ...]:
    """Return the furniture of a plan, the movable pieces displaced and turned at random.

    Parameters
    ----------
    plan : Plan
    rng : Generator
    clear : float
        Distance that every moved piece keeps from the tour, m.
    tries : int
        Places tried for a piece before it stays where it is drawn.
    """
    return tuple(
        _moved(item, plan, rng, clear, tries) if item.moves else item for item in plan.furniture
    )


def _moved(
    item: Furniture, plan: Plan, rng: np.random.Generator, clear: float, tries: int
) -> Furniture:
    centre = item.outline.mean(axis=0)
    room = plan.room_at(centre[None])[0]
    for _ in range(tries):
        angle = min(4 * item.moves, np.pi) * rng.uniform(-0.5, 0.5)
        moved = _turned(item.outline - centre, angle) + centre + item.moves * rng.uniform(-1, 1, 2)
        if (plan.room_at(moved) == room).all() and _from_tour(plan, moved) > clear:
            return replace(item, outline=moved)
    return item


def _turned(outline: Points, angle: float) -> Points:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(outline @ np.array([[c, s], [-s, c]]))


def _from_tour(plan: Plan, outline: Points) -> float:
    """Return the smallest distance of a corner from the straight lines of the tour, m."""
    nearest = np.inf
    for a, b in pairwise(plan.tour):
        along = b - a
        part = np.clip((outline - a) @ along / max(float(along @ along), 1e-12), 0, 1)
        away = np.linalg.norm(outline - a - part[:, None] * along, axis=1)
        nearest = min(nearest, float(away.min()))
    return nearest
