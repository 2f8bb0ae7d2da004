"""Where movable things stand in one recording."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from placecue_office.clutter import Clutter
from placecue_office.floor import Floor
from placecue_office.plan import Furniture, inside, turned

#: Pictures that change from recording to recording have keys this far above.
_RECORDING = 10_000_000

#: How far papers and the like are moved on a table, m.
_PAPERS = 0.12


def arrange(
    furniture: tuple[Furniture, ...], floor: Floor, rng: np.random.Generator, tries: int = 12
) -> tuple[Furniture, ...]:
    """Return furniture with the movable pieces displaced and turned at random.

    Chairs and boxes move about their places, papers on their tables, and screens show something
    else. What stands in the way and finds no other place is taken away.

    Parameters
    ----------
    furniture : tuple of Furniture
    floor : Floor
        Where the way is and where rooms are.
    rng : Generator
    tries : int
        Places tried for a piece before it stays where it is drawn.
    """
    shown = int(rng.integers(1, 1000)) * _RECORDING
    arranged = []
    for item in furniture:
        if item.moves:
            moved = _moved(item, floor, rng, tries)
            arranged += [] if moved is None else [moved]
        elif item.material == "screen":
            arranged.append(replace(item, key=item.key + shown))
        else:
            arranged.append(_on_its_table(item, furniture, rng))
    return tuple(arranged)


def _moved(item: Furniture, floor: Floor, rng: np.random.Generator, tries: int) -> Furniture | None:
    centre = item.outline.mean(axis=0)
    row, column = floor.raster.cells_of(centre[None])[0]
    for number in range(tries):
        reach = item.moves * (1 + number / tries)
        angle = min(4 * item.moves, np.pi) * rng.uniform(-0.5, 0.5)
        outline = turned(item.outline - centre, angle) + centre + reach * rng.uniform(-1, 1, 2)
        cells = floor.raster.fill([outline])
        same_room = (floor.rooms[cells] == floor.rooms[row, column]).all()
        if same_room and not floor.in_the_way(outline):
            return replace(item, outline=outline)
    return None if floor.in_the_way(item.outline) else item


def _on_its_table(
    item: Furniture, furniture: tuple[Furniture, ...], rng: np.random.Generator
) -> Furniture:
    step = rng.uniform(-_PAPERS, _PAPERS, 2)
    small = np.ptp(item.outline, axis=0).max() < 0.45
    if item.bottom < 0.5 or not small or item.top - item.bottom > 0.3:
        return item
    moved = item.outline + step
    under = any(
        table.bottom < 0.5
        and abs(table.top - item.bottom) < 0.05
        and inside(table.outline, moved).all()
        for table in furniture
    )
    return replace(item, outline=moved) if under else item


def rescattered(
    items: list[Furniture], share: float, clutter: Clutter, floor: Floor, rng: np.random.Generator
) -> list[Furniture]:
    """Return clutter of which a part was put elsewhere, as is all that stands in the way.

    Parameters
    ----------
    items : list of Furniture
        As they stood before, known to the floor.
    share : float
        Part that is put elsewhere.
    clutter : Clutter
    floor : Floor
    rng : Generator
    """
    chosen = rng.permutation(len(items)) < round(share * len(items))
    stays = []
    for item, moves in zip(items, chosen, strict=True):
        if not moves and not floor.in_the_way(item.outline):
            stays.append(item)
            continue
        floor.take(item)
        placed = clutter.placed(item, floor, rng)
        stays += [] if placed is None else [placed]
    return stays
