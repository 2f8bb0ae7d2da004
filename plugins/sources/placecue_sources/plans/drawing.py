"""Draws a floor into a labelled plan, askew as buildings are."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue_sources.clutter import cluttered
from placecue_sources.plan import WALL, Plan
from placecue_sources.plans.doors import Opening, openings_of
from placecue_sources.plans.furniture import furniture_of
from placecue_sources.plans.layout import Space, spaces_of
from placecue_sources.plans.rectangle import Rectangle
from placecue_sources.plans.style import STYLES, Style, drawn
from placecue_sources.raycast import OccupancyGrid

CLASSES = ("corridor", "doorway", "room")
_WALL = 255
_SHIFT = 8

Points = NDArray[np.float64]


def drawn_plan(name: str, style: str, resolution: float, rng: np.random.Generator) -> Plan:
    """Draw a floor.

    Parameters
    ----------
    name : str
        What to call it.
    style : str
        One of ``STYLES``.
    resolution : float
        Side of a cell, m.
    rng : Generator
        Decides everything.
    """
    return _Drawing(STYLES[style], resolution, rng).plan(name)


class _Drawing:
    def __init__(self, style: Style, resolution: float, rng: np.random.Generator) -> None:
        self.rng = rng
        self.resolution = resolution
        self.wall = drawn(style.wall, rng)
        self.spaces = spaces_of(style, rng)
        self.openings = openings_of(self.spaces, style, rng)
        # How far a doorway reaches out of the wall is a matter of who draws it.
        self.reach = float(rng.uniform(0.05, 0.4))
        self.furnished = 0.0 if rng.random() < 0.35 else float(rng.uniform(0.1, 1.0))
        self.leaves = bool(rng.random() < 0.4)
        self.askew = _askew(self.spaces, rng)

    def plan(self, name: str) -> Plan:
        self._begin()
        for space in self.spaces:
            self._fill(space.place.inset(self.wall / 2), space.label)
        self._furnish()
        for opening in self.openings:
            self._open(opening)
        labels = np.where(self.canvas == _WALL, WALL, self.canvas.astype(np.int16))
        plan = Plan.of(name, labels.astype(np.int16), CLASSES, self.resolution)
        return self._glazed(self._roughened(self._cluttered(plan)))

    def _begin(self) -> None:
        """Lay an empty canvas that holds the floor."""
        points = np.concatenate([self.askew(_fine(s.place)) for s in self.spaces])
        self.corner = points.min(axis=0)
        columns, rows = np.ceil((points.max(axis=0) - self.corner) / self.resolution) + 1
        self.canvas = np.full((int(rows), int(columns)), _WALL, dtype=np.uint8)

    def _fill(self, place: Rectangle, label: str | None) -> None:
        """Give a rectangle a label, or make a wall of it."""
        if place.area <= 0:
            return
        cells = (self.askew(_fine(place)) - self.corner) / self.resolution - 0.5
        pixels = np.round(cells * (1 << _SHIFT)).astype(np.int32)
        value = _WALL if label is None else CLASSES.index(label)
        cv2.fillPoly(self.canvas, [pixels], value, lineType=cv2.LINE_8, shift=_SHIFT)

    def _furnish(self) -> None:
        for space in self.spaces:
            room = space.place.inset(self.wall / 2)
            # Rooms of one building are not equally full.
            amount = self.furnished * float(self.rng.uniform(0.3, 1.2))
            for piece in furniture_of(space, room, amount, self.rng):
                self._fill(piece, None)

    def _open(self, opening: Opening) -> None:
        """Open a wall, with free space before and behind, and the leaf of a door."""
        wall, half = opening.wall, self.wall / 2
        start, end = opening.start, opening.end
        if opening.label != "doorway":
            if wall.start + half < end - half:
                inner = max(start, wall.start + half), min(end, wall.end - half)
                self._fill(wall.across(*inner, half + 0.05, half + 0.05), opening.label)
            return
        sides = [(opening.before, 0.9, 0.0), (opening.behind, 0.0, 0.9)]
        for space, before, behind in sides:
            free = wall.across(start, end, before, behind)
            self._fill(free.within(space.place.inset(half)), space.label)
        reach = half + self.reach
        self._fill(wall.across(start, end, reach, reach), "doorway")
        if self.leaves and self.rng.random() < 0.8:
            self._leaf(opening)

    def _leaf(self, opening: Opening) -> None:
        """Draw a door that stands open at a right angle, in the room."""
        half, width = self.wall / 2, opening.end - opening.start
        at = opening.start if self.rng.random() < 0.5 else opening.end - 0.05
        into = opening.behind.label == "room"
        before, behind = (-half, half + width) if into else (half + width, -half)
        self._fill(opening.wall.across(at, at + 0.05, before, behind), None)

    def _cluttered(self, plan: Plan) -> Plan:
        if not self.furnished or self.rng.random() < 0.4:
            return plan
        density = {
            "room": float(self.rng.uniform(0, 0.5)),
            "corridor": float(self.rng.uniform(0, 0.04)),
        }
        return cluttered(plan, density, (0.05, 0.8), self.rng)

    def _roughened(self, plan: Plan) -> Plan:
        """Return the plan with walls that are uneven, as a mapping robot sees them."""
        if self.rng.random() < 0.5:
            return plan
        walls = (plan.labels == WALL).astype(np.uint8)
        grown = cv2.dilate(walls, np.ones((3, 3), dtype=np.uint8))
        share = float(self.rng.uniform(0.02, 0.25))
        labels = plan.labels.copy()
        labels[(grown > walls) & (self.rng.random(walls.shape) < share)] = WALL
        return _with_labels(plan, labels)

    def _glazed(self, plan: Plan) -> Plan:
        """Return the plan with panes in its walls, which beams pass through."""
        if self.rng.random() < 0.6:
            return plan
        panes = np.zeros(plan.labels.shape, dtype=np.uint8)
        for space in self.spaces:
            for pane in self._panes(space):
                cells = (self.askew(_fine(pane)) - self.corner) / self.resolution + 0.5
                pixels = np.round(cells * (1 << _SHIFT)).astype(np.int32)
                cv2.fillPoly(panes, [pixels], 1, lineType=cv2.LINE_8, shift=_SHIFT)
        occupied = (plan.labels == WALL) & (panes == 0)
        grid = OccupancyGrid(occupied.astype(np.uint8), plan.grid.resolution, plan.grid.origin)
        return Plan(plan.name, grid, plan.labels, plan.classes)

    def _panes(self, space: Space) -> Iterator[Rectangle]:
        """Yield panes in one wall of a room, now and then."""
        place, deep = space.place, self.wall + 0.2
        if self.rng.random() > 0.3 or min(place.width, place.height) < 1.5:
            return
        start, end = np.sort(self.rng.uniform(0.1, 0.9, 2)).tolist()
        side = int(self.rng.integers(4))
        if side < 2:
            y = place.y0 if side == 0 else place.y1
            x0, x1 = place.x0 + start * place.width, place.x0 + end * place.width
            yield Rectangle(x0, y - deep, x1, y + deep)
        else:
            x = place.x0 if side == 2 else place.x1
            y0, y1 = place.y0 + start * place.height, place.y0 + end * place.height
            yield Rectangle(x - deep, y0, x + deep, y1)


def _with_labels(plan: Plan, labels: NDArray[np.int16]) -> Plan:
    occupied = (labels == WALL).astype(np.uint8)
    grid = OccupancyGrid(occupied, plan.grid.resolution, plan.grid.origin)
    return Plan(plan.name, grid, labels, plan.classes)


def _fine(place: Rectangle) -> Points:
    """Return the outline with a point every half metre, so that it can bend, m, shape (n, 2)."""
    corners = place.corners()
    sides = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.hypot(*(end - start)) / 0.5)))
        sides.append(start + (end - start) * np.arange(count)[:, None] / count)
    return np.concatenate(sides)


def _askew(spaces: list[Space], rng: np.random.Generator) -> Callable[[Points], Points]:
    """Return what turns, shears and bends a floor, or leaves it as it is."""
    turn = float(rng.uniform(0, np.pi / 2)) if rng.random() < 0.6 else 0.0
    shear = float(rng.normal(0, 0.15)) if rng.random() < 0.3 else 0.0
    length = max(space.place.x1 for space in spaces)
    bend = float(rng.uniform(-0.08, 0.08)) * length if rng.random() < 0.25 else 0.0
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, s], [-s, c]])

    def askew(points: Points) -> Points:
        x, y = points.T
        bent = y + shear * x + bend * np.sin(np.pi * x / length)
        return np.asarray(np.column_stack([x, bent]) @ turned)

    return askew
