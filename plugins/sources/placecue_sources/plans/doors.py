"""Doors and openings between the spaces of a floor."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from placecue_sources.plans.layout import Space
from placecue_sources.plans.rectangle import Border, border
from placecue_sources.plans.style import Style, drawn

#: What stays of a wall on both sides of a door, m.
_JAMB = 0.15


@dataclass(frozen=True, slots=True)
class Opening:
    """A gap in the wall between two spaces.

    Parameters
    ----------
    wall : Border
        The wall.
    start, end : float
        Where the gap begins and ends along the wall, m.
    label : str
        What it is: ``doorway``, or the label of both spaces where they are one.
    before, behind : Space
        The space on the west or south of it, and on the east or north.
    """

    wall: Border
    start: float
    end: float
    label: str
    before: Space
    behind: Space


def openings_of(spaces: list[Space], style: Style, rng: np.random.Generator) -> list[Opening]:
    """Return openings such that every space has one, if it has a neighbour."""
    shared = _borders(spaces, 0.7 + 2 * _JAMB)
    width = drawn(style.door, rng)
    found: list[Opening] = []
    for before, behind, wall in shared:
        labels = {before.label, behind.label}
        if labels == {"corridor"}:
            found.append(_junction(before, behind, wall, rng))
        elif labels == {"room"} and rng.random() < style.joined:
            found.append(_joined(before, behind, wall, rng))
    reached = {id(space) for opening in found for space in (opening.before, opening.behind)}
    for space in spaces:
        if space.label == "room":
            found += _doors(space, shared, width, id(space) in reached, rng)
    return found


def _borders(spaces: list[Space], least: float) -> list[tuple[Space, Space, Border]]:
    found = []
    for first, second in combinations(spaces, 2):
        for before, behind in ((first, second), (second, first)):
            wall = border(before.place, behind.place)
            if wall is not None and wall.length > least:
                found.append((before, behind, wall))
                break
    return found


def _junction(before: Space, behind: Space, wall: Border, rng: np.random.Generator) -> Opening:
    """Return the opening between two corridors: all of it, or a fire door now and then."""
    if rng.random() < 0.15:
        width = min(float(rng.uniform(0.9, 2.0)), wall.length - 2 * _JAMB)
        start = (wall.start + wall.end - width) / 2
        return Opening(wall, start, start + width, "doorway", before, behind)
    return Opening(wall, wall.start, wall.end, "corridor", before, behind)


def _joined(before: Space, behind: Space, wall: Border, rng: np.random.Generator) -> Opening:
    """Return the opening that makes one room of two."""
    width = wall.length * float(rng.uniform(0.4, 1.0))
    start = wall.start + (wall.length - width) * float(rng.random())
    return Opening(wall, start, start + width, "room", before, behind)


def _doors(
    room: Space,
    shared: list[tuple[Space, Space, Border]],
    width: float,
    reached: bool,
    rng: np.random.Generator,
) -> list[Opening]:
    """Return the doors of a room: into a corridor, or another room if it is at none."""
    ours = [each for each in shared if room is each[0] or room is each[1]]
    fitting = [each for each in ours if "corridor" in (each[0].label, each[1].label)]
    if not fitting and not reached:
        fitting = ours
    if not fitting:
        return []
    chosen = [fitting[int(rng.integers(len(fitting)))]]
    if chosen[0][2].length > 6 and rng.random() < 0.5:
        chosen.append(fitting[int(rng.integers(len(fitting)))])
    others = [each for each in ours if each not in fitting]
    if others and rng.random() < 0.1:
        chosen.append(others[int(rng.integers(len(others)))])
    return [_door(*each, width, rng) for each in chosen]


def _door(
    before: Space, behind: Space, wall: Border, width: float, rng: np.random.Generator
) -> Opening:
    double = 1.7 if rng.random() < 0.08 else 1.0
    width = min(width * double * float(rng.uniform(0.9, 1.1)), wall.length - 2 * _JAMB)
    room = wall.length - width - 2 * _JAMB
    # Beside a corner, or anywhere.
    along = float(rng.choice([0.0, 1.0, rng.random()], p=[0.25, 0.25, 0.5]))
    start = wall.start + _JAMB + room * along
    return Opening(wall, start, start + width, "doorway", before, behind)
