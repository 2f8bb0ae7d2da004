"""Draws the building of the tuning half: offices and two kitchens along a corridor, as no other.

    python benchmarks/labelling_building.py FILE.geojson

A plan for the office simulator. Sizes, colours and where things stand are drawn from a seed; what
stands in an office or a kitchen is what stands in any.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

Feature = dict[str, Any]

#: Length and width of the corridor, how thick walls are, and how wide doors, m.
LENGTH, WIDTH, THICK, DOOR = 27.0, 1.9, 0.12, 0.9
#: What lies along each side of the corridor, from left to right: class, width and depth, m.
BELOW = [
    ("office", 3.2, 4.6),
    ("office", 4.4, 4.6),
    ("kitchen", 4.2, 3.8),
    ("office", 3.6, 5.2),
    ("office", 5.0, 4.2),
    ("office", 3.4, 5.0),
    ("office", 3.2, 4.4),
]
ABOVE = [
    ("office", 5.2, 3.6),
    ("office", 3.8, 4.8),
    ("office", 3.4, 5.4),
    ("kitchen", 5.6, 4.4),
    ("office", 4.6, 4.0),
    ("office", 4.4, 5.0),
]
WALLS = ("paint", "woodchip", "concrete")
CEILING = "ceiling #d8d8d4"
BLACK, DARK = "plain #2b2b2e", "plain #404248"
FLOORS = {"office": ("carpet", "linoleum", "wood"), "kitchen": ("tiles", "linoleum")}


def plan(seed: int = 0) -> dict[str, Any]:
    """Return the plan."""
    rng = np.random.default_rng(seed)
    features = _corridor(rng)
    stops: list[tuple[float, list[list[float]]]] = []
    for rooms, edge, out in ((BELOW, 0.0, -1.0), (ABOVE, WIDTH, 1.0)):
        x = 0.0
        for label, width, depth in rooms:
            room = _Room(rng, label, x, edge, out, width, depth)
            features += room.features()
            stops.append((room.door, room.stops()))
            x += width
    tour = [[1.0, WIDTH / 2]]
    for door, inside in sorted(stops):
        tour += [[door, WIDTH / 2], *inside, [door, WIDTH / 2]]
    tour.append([LENGTH - 1.0, WIDTH / 2])
    features.append(_feature("tour", "LineString", tour))
    return {"type": "FeatureCollection", "name": "third_floor", "height": 2.8, "features": features}


def _colour(rng: np.random.Generator, low: int, high: int) -> str:
    grey = int(rng.integers(low, high))
    tints = np.clip(grey + rng.integers(-18, 19, 3), 0, 255)
    return "#" + "".join(f"{each:02x}" for each in tints.tolist())


def _feature(kind: str, shape: str, coordinates: Any, **about: Any) -> Feature:
    geometry = {"type": shape, "coordinates": coordinates}
    return {"type": "Feature", "properties": {"kind": kind, **about}, "geometry": geometry}


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> list[list[list[float]]]:
    (x0, x1), (y0, y1) = sorted((x0, x1)), sorted((y0, y1))
    return [[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]]


def _wall(*points: Sequence[float]) -> Feature:
    return _feature("wall", "LineString", [list(each) for each in points], thickness=THICK)


def _corridor(rng: np.random.Generator) -> list[Feature]:
    about = {
        "floor": f"linoleum {_colour(rng, 90, 150)}",
        "wall": f"paint {_colour(rng, 190, 225)}",
        "ceiling": CEILING,
    }
    outline = _rectangle(0, 0, LENGTH, WIDTH)
    found = [
        _feature("room", "Polygon", outline, label="corridor", **about),
        _wall((0, 0), (0, WIDTH)),
        _wall((LENGTH, 0), (LENGTH, WIDTH)),
    ]
    for x in np.arange(1.5, LENGTH, 3.0):
        found.append(_feature("lamp", "Point", [float(x), WIDTH / 2], size=[1.2, 0.3]))
    for x, y in ((5.9, 0.07), (14.2, 0.07), (21.5, WIDTH - 0.07), (9.7, WIDTH - 0.07)):
        line = [[x, y], [x + 0.8, y]] if y > 1 else [[x + 0.8, y], [x, y]]
        kind = f"poster {_colour(rng, 130, 220)}" if x > 9 else "noticeboard #a0764c"
        found.append(_feature("panel", "LineString", line, z=[1.0, 1.9], material=kind))
    return found


class _Room:
    """A room beside the corridor, in coordinates of its own.

    Parameters
    ----------
    rng : Generator
    label : str
    x : float
        Where it begins along the corridor, m.
    edge, out : float
        y of the corridor's wall, m, and in which direction the room lies.
    width, depth : float
        Its size, m.
    """

    def __init__(
        self,
        rng: np.random.Generator,
        label: str,
        x: float,
        edge: float,
        out: float,
        width: float,
        depth: float,
    ) -> None:
        self.rng = rng
        self.label = label
        self.x, self.edge, self.out = x, edge, out
        self.width, self.depth = width, depth
        self.mirrored = bool(rng.random() < 0.5)
        self.door = self._at(0.75, 0.0)[0]

    def _at(self, along: float, away: float) -> list[float]:
        """Return a position so far from the side of the door and from the corridor, m."""
        x = self.x + (self.width - along if self.mirrored else along)
        return [round(x, 3), round(self.edge + self.out * away, 3)]

    def _box(
        self,
        along: float,
        away: float,
        width: float,
        depth: float,
        z: Sequence[float],
        material: str,
        cover: str,
        kind: str = "box",
    ) -> Feature:
        a, b = self._at(along, away), self._at(along + width, away + depth)
        about = {"type": kind, "z": list(z), "material": material, "cover": cover}
        return _feature("furniture", "Polygon", _rectangle(*a, *b), **about)

    def _chair(self, along: float, away: float) -> Feature:
        heading = float(self.rng.uniform(-3, 3))
        about = {"type": "chair", "size": 0.45, "heading": heading, "z": [0, 0.88], "moves": 0.15}
        seat = f"fabric {_colour(self.rng, 50, 150)}"
        return _feature("furniture", "Point", self._at(along, away), material=seat, **about)

    def features(self) -> list[Feature]:
        """Return the room, its walls, door and window, and what stands in it."""
        far = self._at(0, self.depth)[1]
        left, right, door = self.x, self.x + self.width, self.door
        about = {
            "floor": f"{self.rng.choice(FLOORS[self.label])} {_colour(self.rng, 80, 170)}",
            "wall": f"{self.rng.choice(WALLS)} {_colour(self.rng, 185, 230)}",
            "ceiling": CEILING,
        }
        half = DOOR / 2
        frame = {"thickness": THICK, "frame": "plain #6a6e70", "material": "door #9c8a70"}
        opening = [[door - half, self.edge], [door + half, self.edge]]
        outline = _rectangle(left, self.edge, right, far)
        found = [
            _feature("room", "Polygon", outline, label=self.label, **about),
            _wall((left, self.edge), (door - half, self.edge)),
            _wall((door + half, self.edge), (right, self.edge)),
            _feature("door", "LineString", opening, open=True, **frame),
            _wall((left, self.edge), (left, far), (right, far), (right, self.edge)),
            _feature("lamp", "Point", self._at(self.width / 2, self.depth / 2), size=[1.2, 0.3]),
            self._window(far),
        ]
        return [*found, *(self._kitchen() if self.label == "kitchen" else self._office())]

    def _window(self, far: float) -> Feature:
        y = far - self.out * (THICK / 2 + 0.01)
        line = [[self.x + 0.7, y], [self.x + self.width - 0.7, y]]
        line = line if self.out > 0 else line[::-1]
        return _feature("window", "LineString", line, z=[0.9, 2.2], material="window #d8e2ea")

    def _office(self) -> list[Feature]:
        rng, deep, wide = self.rng, self.depth, self.width
        wood, metal = f"wood {_colour(rng, 110, 190)}", f"plain {_colour(rng, 90, 130)}"
        found = [
            self._box(0.15, deep - 0.95, 1.5, 0.8, (0, 0.73), metal, wood, "table"),
            self._box(0.5, deep - 0.6, 0.45, 0.2, (0.73, 1.15), "screen", BLACK),
            self._chair(0.9, deep - 1.35),
            self._box(wide - 0.42, 1.2, 0.35, 1.2, (0, 1.9), f"bookshelf {wood[5:]}", wood),
            self._box(wide - 0.55, 0.12, 0.45, 0.6, (0, 1.1), f"drawers {metal[6:]}", metal),
        ]
        if wide > 4:
            found += [
                self._box(wide - 1.65, deep - 0.95, 1.5, 0.8, (0, 0.73), metal, wood, "table"),
                self._box(
                    wide - 1.2, deep - 0.6, 0.45, 0.2, (0.73, 1.15), "screen", "plain #2b2b2e"
                ),
                self._chair(wide - 0.9, deep - 1.35),
            ]
        if rng.random() < 0.5:
            leaves = f"leaves {_colour(rng, 70, 110)}"
            found.append(self._box(wide - 0.4, 2.6, 0.32, 0.32, (0, 1.2), leaves, leaves, "plant"))
        return found

    def _kitchen(self) -> list[Feature]:
        rng, deep, wide = self.rng, self.depth, self.width
        front, top = f"cupboard {_colour(rng, 170, 225)}", f"stone {_colour(rng, 90, 150)}"
        table, legs = f"wood {_colour(rng, 150, 210)}", "plain #b0b0b0"
        middle = (wide + 0.6) / 2
        found = [
            self._box(wide - 0.68, 0.8, 0.6, deep - 1.6, (0, 0.9), front, top),
            self._box(wide - 0.42, 0.8, 0.34, deep - 2.0, (1.45, 2.15), front, front),
            self._box(wide - 0.68, deep - 0.78, 0.6, 0.6, (0, 1.75), "fridge #e2e4e6", front),
            self._box(wide - 0.62, 1.0, 0.45, 0.4, (0.9, 1.2), "oven #505258", DARK),
            self._box(wide - 0.5, 1.7, 0.25, 0.25, (0.9, 1.25), "machine #2c2c30", BLACK),
            self._box(middle - 1.1, deep - 1.45, 1.2, 0.75, (0, 0.73), legs, table, "table"),
        ]
        for along, away in ((-0.8, -1.75), (-0.3, -1.75), (-0.8, -0.45), (-0.3, -0.45)):
            found.append(self._chair(middle + along, deep + away))
        return found

    def stops(self) -> list[list[float]]:
        """Return where the robot goes within the room."""
        middle = self._at(self.width / 2, self.depth / 2)
        return [self._at(0.75, 0.9), middle, self._at(0.9, self.depth - 1.9), self._at(0.75, 0.9)]


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(plan()), encoding="utf-8")
