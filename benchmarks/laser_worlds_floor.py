"""The floor of IDOL2 with things put about: what benchmarks/laser_worlds.py casts its beams in.

Walls, drawn furniture and the recorded poses are those of ``PLACECUE_DATA/idol2``. METHODS section
7 says what is added: about 15 small things of 0.12 to 0.5 m, of which three in ten are put
elsewhere in each recording; before runs 3 and 4 half of them are put elsewhere, 14 % of the
furniture is shifted by 0.2 to 0.35 m, and two boxes come. Nothing stands where a robot has been.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue_sources.raycast import OccupancyGrid

Mask: TypeAlias = NDArray[np.bool_]

#: Insides of the rooms, between their walls, m: x0, y0, x1, y1.
ROOMS = {
    "BO": (0.08, 21.05, 4.75, 23.35),
    "EO": (0.08, 14.55, 4.75, 18.35),
    "KT": (7.80, 12.25, 12.40, 17.55),
    "PA": (5.35, 3.45, 8.82, 8.60),
    "CR": (5.35, 8.75, 7.22, 30.95),
}
#: How near nothing is put to a recorded position, m.
CLEAR = 0.3
#: Small things: how many, and their shortest and longest side, m.
THINGS, SIZES = 15, (0.12, 0.5)
#: Part of them that is put elsewhere from recording to recording, and in half a year.
MOVED, MOVED_LATER = 0.3, 0.5
#: Boxes that come in half a year, with their sides, m.
BOXES, BOX = 2, (0.35, 0.7)
#: Part of the furniture that is shifted in half a year, and how far, m.
SHIFTED, SHIFT = 0.14, (0.2, 0.35)
#: Shifts tried before a piece stays.
TRIES = 200
#: Smallest piece of furniture, m².
LEAST = 0.04


@dataclass(frozen=True)
class Floor:
    """The floor as it is drawn.

    Parameters
    ----------
    solid : ndarray of bool, shape (rows, columns)
        Walls, furniture, and rooms that nobody entered; row 0 is the top.
    way : ndarray of bool
        Where a recorded robot has been, and what is near it.
    scale : float
        Pixels a metre.
    origin : tuple of float
        Column of x = 0, row of y = 0.
    """

    solid: Mask
    way: Mask
    scale: float
    origin: tuple[float, float]

    @classmethod
    def read(cls, folder: Path, positions: NDArray[np.float64]) -> Floor:
        """Read ``grid.png`` and ``grid.json`` of IDOL2; positions in m, shape (n, 2)."""
        told = json.loads((folder / "grid.json").read_text())
        drawn = cv2.imread(str(folder / "grid.png"), cv2.IMREAD_GRAYSCALE)
        floor = cls(drawn == 0, drawn < 0, told["px_per_m"], (told["u0"], told["v0"]))
        away = np.ones(drawn.shape, np.uint8)
        columns, rows = floor.pixels(positions).astype(int).T
        away[rows, columns] = 0
        far = cv2.distanceTransform(away, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        return cls(floor.solid, far < CLEAR * floor.scale, floor.scale, floor.origin)

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return columns and rows of positions in m, shape (n, 2)."""
        left, base = self.origin
        return np.column_stack([self.scale * points[:, 0] + left, base - self.scale * points[:, 1]])

    def grid(self, solid: Mask) -> OccupancyGrid:
        """Return what stops beams as a grid in metres."""
        left, base = self.origin
        corner = (-left / self.scale, (base - solid.shape[0]) / self.scale)
        return OccupancyGrid.from_image(solid.astype(np.uint8), 1 / self.scale, corner)

    def room(self, name: str) -> Mask:
        """Return the inside of a room."""
        x0, y0, x1, y1 = ROOMS[name]
        (left, bottom), (right, top) = (
            self.pixels(np.array([[x0, y0], [x1, y1]])).round().astype(int)
        )
        inside = np.zeros_like(self.solid)
        inside[top:bottom, left:right] = True
        return inside

    def furniture(self) -> list[tuple[str, Mask]]:
        """Return the drawn pieces, each with its room."""
        return [(name, piece) for name in ROOMS for piece in self._pieces(name)]

    def _pieces(self, name: str) -> Iterator[Mask]:
        count, parts = cv2.connectedComponents((self.solid & self.room(name)).astype(np.uint8))
        for number in range(1, count):
            if (parts == number).sum() >= LEAST * self.scale**2:
                yield parts == number


@dataclass(frozen=True)
class Thing:
    """A box that stands about.

    Parameters
    ----------
    sides : tuple of float
        m.
    place : ndarray of bool, shape (rows, columns)
        What it covers.
    """

    sides: tuple[float, float]
    place: Mask


class World:
    """What stands about on the floor, recording by recording.

    Parameters
    ----------
    floor : Floor
    seed : int
        Decides everything.
    """

    def __init__(self, floor: Floor, seed: int) -> None:
        self.floor = floor
        self.seed = seed
        self.rooms = {name: floor.room(name) for name in ROOMS}
        rng = np.random.default_rng([seed, 0])
        first = self._with(THINGS, SIZES, [], floor.solid, rng)
        rng = np.random.default_rng([seed, 1])
        shifted = self._shifted(rng)
        kept = self._elsewhere(first, shifted, MOVED_LATER, rng)
        self._times = (floor.solid, first), (shifted, self._with(BOXES, BOX, kept, shifted, rng))

    def recorded(self, light: int, run: int) -> OccupancyGrid:
        """Return what stops beams in a recording: light 0 to 2, run 1 to 4."""
        solid, things = self._times[run > 2]
        rng = np.random.default_rng([self.seed, 2, light, run])
        return self.floor.grid(_union(solid, self._elsewhere(things, solid, MOVED, rng)))

    def _with(
        self,
        count: int,
        sizes: tuple[float, float],
        things: list[Thing],
        solid: Mask,
        rng: np.random.Generator,
    ) -> list[Thing]:
        """Return things and so many new ones, their sides even on a log scale."""
        for width, depth in np.exp(rng.uniform(*np.log(sizes), (count, 2))).tolist():
            things = [*things, self._put((width, depth), things, solid, rng)]
        return things

    def _elsewhere(
        self, things: list[Thing], solid: Mask, part: float, rng: np.random.Generator
    ) -> list[Thing]:
        """Return the things, that part of them put elsewhere."""
        moved = list(things)
        for number in rng.permutation(len(things))[: round(part * len(things))]:
            others = moved[:number] + moved[number + 1 :]
            moved[number] = self._put(moved[number].sides, others, solid, rng)
        return moved

    def _put(
        self,
        sides: tuple[float, float],
        things: list[Thing],
        solid: Mask,
        rng: np.random.Generator,
    ) -> Thing:
        """Return a box somewhere on free floor, turned at random, wholly in one room."""
        taken = _union(solid, things) | self.floor.way
        free = np.argwhere(np.any(list(self.rooms.values()), axis=0) & ~taken)
        size = (sides[0] * self.floor.scale, sides[1] * self.floor.scale)
        while True:
            row, column = free[rng.integers(len(free))].tolist()
            place = _filled(((column, row), size, float(rng.uniform(0, 90))), taken.shape)
            within = any(not (place & ~room).any() for room in self.rooms.values())
            if within and not (place & taken).any():
                return Thing(sides, place)

    def _shifted(self, rng: np.random.Generator) -> Mask:
        """Return what is solid after half a year: some pieces of furniture stand elsewhere."""
        solid, pieces = self.floor.solid, self.floor.furniture()
        wanted = round(SHIFTED * len(pieces))
        for number in rng.permutation(len(pieces)):
            room, piece = pieces[number]
            others = solid & ~piece
            moved = self._step(piece, others, self.rooms[room], rng) if wanted else None
            if moved is not None:
                solid = others | moved
                wanted -= 1
        return solid

    def _step(self, piece: Mask, others: Mask, room: Mask, rng: np.random.Generator) -> Mask | None:
        """Return a piece of furniture shifted within its room, where it touches nothing."""
        for _ in range(TRIES):
            angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(*SHIFT) * self.floor.scale
            across, down = round(far * np.cos(angle)), round(far * np.sin(angle))
            moved = np.roll(piece, (down, across), axis=(0, 1))
            if not (moved & (others | self.floor.way | ~room)).any():
                return moved
        return None


def _filled(
    box: tuple[tuple[float, float], tuple[float, float], float], shape: tuple[int, ...]
) -> Mask:
    """Return the cells that a box (centre, sides, degrees) covers; lengths in cells."""
    filled = np.zeros(shape, np.uint8)
    cv2.fillConvexPoly(filled, np.round(cv2.boxPoints(box)).astype(np.int32), 1)
    return filled.astype(np.bool_)


def _union(solid: Mask, things: list[Thing]) -> Mask:
    return np.asarray(np.any([solid, *(thing.place for thing in things)], axis=0))
