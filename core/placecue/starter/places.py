"""Which places the starter tells apart: all that it knows, or those that a building has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices

CORRIDOR, DOORWAY, ROOM = "corridor", "doorway", "room"
#: What the laser decides; all else is a kind of room.
BY_LASER = (CORRIDOR, DOORWAY)
#: How others call them.
SYNONYMS: Mapping[str, str] = {"hallway": CORRIDOR, "hall": CORRIDOR, "door": DOORWAY}
#: How to get what tells kinds of rooms.
INSTALL = "pip install 'placecue[deep]'"


@dataclass(frozen=True, slots=True)
class Places:
    """The places that a belief may name.

    Parameters
    ----------
    classes : tuple of str
        All of them, sorted. ``room`` is a room of whatever kind: what the laser alone can say
        where there are several kinds.
    """

    classes: tuple[str, ...]

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of rooms."""
        return tuple(name for name in self.classes if name not in (*BY_LASER, ROOM))

    @property
    def room(self) -> str | None:
        """What the laser calls a room; None where there is none."""
        if ROOM in self.classes:
            return ROOM
        return self.kinds[0] if self.kinds else None

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the columns of some classes."""
        return [self.classes.index(name) for name in names if name in self.classes]

    def shares(self, classes: Sequence[str]) -> NDArray[np.float64]:
        """Return which place each class of a model is, shape (classes, places), 0 or 1."""
        shares = np.zeros((len(classes), len(self.classes)))
        for row, name in enumerate(classes):
            place = self.room if name == ROOM else name
            if place in self.classes:
                shares[row, self.classes.index(place)] = 1
        return shares

    def truth(self, label: str | None) -> str | None:
        """Return what a label of a log is called here: a kind that is none of ours is a room."""
        if label is None or label in self.classes:
            return label
        named = SYNONYMS.get(label, label)
        if named in BY_LASER or self.kinds:
            return named
        return self.room


def chosen(wanted: Any, kinds: Sequence[str], sees_objects: bool) -> Places:
    """Return the places that a building has.

    Parameters
    ----------
    wanted : sequence of str or None
        What ``places=`` says; None for all.
    kinds : sequence of str
        The kinds of rooms that have a name in the table of objects; none where it is not there.
    sees_objects : bool
        Whether objects are looked at. If not, kinds of rooms cannot be told apart, and all are a
        ``room``, or the one kind there is.

    Raises
    ------
    UsageError
        If a place is not known, or fewer than two are left to tell apart.
    """
    if wanted is None:
        return Places(tuple(sorted({*BY_LASER, ROOM, *(kinds if sees_objects else ())})))
    if isinstance(wanted, str) or not isinstance(wanted, Sequence):
        raise UsageError(f"places={wanted!r} is no list: give places=[{ROOM},{CORRIDOR}]")
    names = [str(name) for name in wanted]
    for name in names:
        _check_known(name, kinds)
    rooms = {name for name in names if name not in BY_LASER}
    classes = {name for name in names if name in BY_LASER}
    if len(rooms) > 1:
        # Told apart by objects, where they are seen; else, and in between, a room.
        classes |= {ROOM, *(rooms if sees_objects else ())}
    else:
        classes |= rooms
    if len(classes) < 2:
        alone = "" if sees_objects else f"; the laser alone tells {CORRIDOR}, {DOORWAY} and {ROOM}"
        raise UsageError(
            f"places=[{','.join(names)}] leaves nothing to tell apart{alone}: name two or more"
        )
    return Places(tuple(sorted(classes)))


def _check_known(name: str, kinds: Sequence[str]) -> None:
    known = tuple(dict.fromkeys((*BY_LASER, ROOM, *kinds)))
    if name not in known:
        more = "" if kinds else f", and kinds of rooms take placecue[deep] ({INSTALL})"
        raise UsageError(f"places: nobody knows '{name}'; {choices(name, known)}{more}")
