"""What kinds of buildings are drawn, and between which limits each is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Limits = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Style:
    """Limits of a kind of building; lengths in m, drawn on a log scale.

    Parameters
    ----------
    length : tuple of float
        Longer side of a floor.
    aspect : tuple of float
        Shorter over longer side.
    corridor : tuple of float
        Width of corridors.
    room : tuple of float
        Width of rooms, along the corridor.
    depth : tuple of float
        Depth of rooms; a block that is deeper has a corridor of its own.
    wall : tuple of float
        Thickness of walls.
    door : tuple of float
        Width of doors.
    hall, ring, open_plan, back : float
        How likely it is that a corridor is a hall (up to twice as wide), that the corridor of a
        large floor goes round a core, that a block is one large room, that a room has another
        behind it.
    joined : float
        How likely it is that two neighbouring rooms are one, with an L for a shape perhaps.
    """

    length: Limits
    aspect: Limits
    corridor: Limits
    room: Limits
    depth: Limits
    wall: Limits
    door: Limits
    hall: float
    ring: float
    open_plan: float
    back: float
    joined: float


STYLES: Mapping[str, Style] = {
    "office": Style(
        length=(18, 60),
        aspect=(0.3, 1.0),
        corridor=(1.3, 3.2),
        room=(2.2, 9.0),
        depth=(3.5, 9.0),
        wall=(0.1, 0.35),
        door=(0.75, 1.3),
        hall=0.15,
        ring=0.25,
        open_plan=0.12,
        back=0.1,
        joined=0.1,
    ),
    "home": Style(
        length=(8, 18),
        aspect=(0.5, 1.0),
        corridor=(0.95, 1.8),
        room=(2.0, 5.5),
        depth=(2.2, 5.5),
        wall=(0.08, 0.3),
        door=(0.7, 1.1),
        hall=0.1,
        ring=0.0,
        open_plan=0.1,
        back=0.15,
        joined=0.2,
    ),
}


def drawn(limits: Limits, rng: np.random.Generator) -> float:
    """Return a length between limits, all ratios equally likely."""
    low, high = np.log(limits)
    return float(np.exp(rng.uniform(low, high)))
