"""A way through the rooms of a plan that keeps clear of everything."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from placecue.errors import DataError
from placecue_office.blocks import Block
from placecue_office.plan import Plan, Points
from placecue_office.raster import Raster

#: Right, up, and the two diagonals; the opposite ways are the same edges.
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))


@dataclass(frozen=True, slots=True)
class Clearance:
    """How far it is to the nearest obstacle, everywhere.

    Parameters
    ----------
    raster : Raster
        The cells.
    metres : ndarray of float64, shape raster.shape
        Distance from the middle of each cell, less one cell, m; 0 in obstacles and outside rooms.
    """

    raster: Raster
    metres: NDArray[np.float64]

    @classmethod
    def around(
        cls, plan: Plan, blocks: list[Block], robot_height: float, cell: float = 0.0125
    ) -> Clearance:
        """Measure it around the blocks that a robot of ``robot_height`` metres would bump into."""
        raster = Raster.over(plan, cell)
        free = raster.fill(room.outline for room in plan.rooms)
        free &= ~raster.fill(
            block.outline for block in blocks if block.solid and block.bottom < robot_height
        )
        metres = cv2.distanceTransform(free.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        # Points and obstacles are known to half a cell each: what is told is never too much.
        return cls(raster, np.maximum(metres.astype(float) - 1.0, 0.0) * cell)

    def at(self, points: Points) -> NDArray[np.float64]:
        """Return the clearance at each point (n, 2), m, shape (n,)."""
        rows, columns = self.raster.cells_of(points).T
        return np.asarray(self.metres[rows, columns])


class Planner:
    """Finds ways that are short, clear, and a little different each time.

    Parameters
    ----------
    plan : Plan
    clearance : Clearance
        Where obstacles are.
    radius : float
        Radius of the robot, m.
    rng : Generator
        Makes one way differ from another.
    cell : float
        Width of the cells that the way is searched on, m.
    wander : float
        How much dearer ground may be by chance, as a part of its cost.
    """

    def __init__(
        self,
        plan: Plan,
        clearance: Clearance,
        radius: float,
        rng: np.random.Generator,
        cell: float = 0.1,
        wander: float = 0.8,
    ) -> None:
        self.radius = radius
        self.clearance = clearance
        self.raster = Raster.over(plan, cell)
        self.centres = self.raster.centres()
        self.room = clearance.at(self.centres)
        chance = ndimage.gaussian_filter(rng.standard_normal(self.raster.shape), 6.0)
        dearer = 1 + wander * (chance - chance.min()) / np.ptp(chance)
        crowding = 1 + (0.5 / np.maximum(self.room, 0.05)) ** 2
        self.graph = self._graph(dearer.ravel() * crowding)

    def _graph(self, cost: NDArray[np.float64]) -> sparse.csr_array:
        numbers = np.arange(cost.size).reshape(self.raster.shape)
        rows, columns = self.raster.shape
        starts, ends, weights = [], [], []
        for down, right in _STEPS:
            left = max(0, -right)
            a = numbers[: rows - down, left : columns - max(0, right)].ravel()
            b = numbers[down:, left + right : columns - max(0, right) + right].ravel()
            open_both = (self.room[a] > self.radius) & (self.room[b] > self.radius)
            a, b = a[open_both], b[open_both]
            starts.append(a)
            ends.append(b)
            weights.append(np.hypot(down, right) * 0.5 * (cost[a] + cost[b]))
        edges = np.concatenate(weights), (np.concatenate(starts), np.concatenate(ends))
        return sparse.csr_array(edges, shape=(cost.size, cost.size))

    def snap(self, points: Points, room: float) -> NDArray[np.int64]:
        """Return the nearest cells to points (n, 2) that keep ``room`` metres clear, shape (n,).

        Raises
        ------
        DataError
            If there is no such cell.
        """
        roomy = np.flatnonzero(self.room >= room)
        if roomy.size == 0:
            raise DataError(f"no place in the rooms is {room:.2f} m clear of everything")
        away = points[:, None] - self.centres[roomy][None]
        return np.asarray(roomy[np.einsum("ijk,ijk->ij", away, away).argmin(axis=1)])

    def path(self, stops: NDArray[np.int64]) -> Points:
        """Return a smooth way through cells in order, points about 5 cm apart, shape (n, 2).

        Raises
        ------
        DataError
            If a stop cannot be reached, or all are one.
        """
        legs = [self._leg(a, b) for a, b in pairwise(stops) if a != b]
        if not legs:
            raise DataError("the tour does not go anywhere: it needs two places apart or more")
        return self.smoothed(np.concatenate([legs[0][:1], *(leg[1:] for leg in legs)]))

    @cached_property
    def reachable(self) -> NDArray[np.int64]:
        """The cells of the largest part of the building that hangs together."""
        _, parts = csgraph.connected_components(self.graph, directed=False)
        sizes = np.bincount(parts, weights=self.room > self.radius)
        return np.flatnonzero((parts == sizes.argmax()) & (self.room > self.radius))

    def smoothed(self, cells: NDArray[np.int64]) -> Points:
        """Return a smooth way through neighbouring cells, points about 5 cm apart, (n, 2)."""
        rough = resample(self.centres[cells], 0.05)
        for width in (9.0, 6.0, 4.0, 2.0):  # in points of 5 cm
            smooth = np.asarray(ndimage.gaussian_filter1d(rough, width, axis=0, mode="nearest"))
            if self.clearance.at(smooth).min() > self.radius:
                return resample(smooth, 0.05)
        return rough

    def _leg(self, start: int, end: int) -> NDArray[np.int64]:
        _, before = csgraph.dijkstra(
            self.graph, directed=False, indices=start, return_predecessors=True
        )
        cells = [end]
        while cells[-1] != start:
            previous = before[cells[-1]]
            if previous < 0:
                a, b = self.centres[[start, end]].round(2).tolist()
                raise DataError(
                    f"no way from {a} to {b} m keeps {self.radius:g} m clear of everything"
                )
            cells.append(previous)
        return np.array(cells[::-1])


def resample(path: Points, step: float) -> Points:
    """Return points every ``step`` metres along a path (n, 2), the ends included."""
    travelled = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    at = np.linspace(0, travelled[-1], max(2, round(travelled[-1] / step) + 1))
    return np.column_stack([np.interp(at, travelled, path[:, axis]) for axis in (0, 1)])


def plan_route(
    plan: Plan,
    clearance: Clearance,
    radius: float,
    rng: np.random.Generator,
    stray: float = 0.2,
    margin: float = 0.005,
) -> Points:
    """Return a way through the places of the plan's tour, shape (n, 2).

    Parameters
    ----------
    plan : Plan
    clearance : Clearance
        Where obstacles are.
    radius : float
        Radius of the robot, m.
    rng : Generator
        Moves each place and the way between.
    stray : float
        Standard deviation of the places, m.
    margin : float
        Distance that the way keeps from obstacles beyond the radius, m.
    """
    planner = Planner(plan, clearance, radius + margin, rng)
    places = plan.tour + stray * np.clip(rng.standard_normal(plan.tour.shape), -2, 2)
    return planner.path(planner.snap(places, radius + 0.08))
