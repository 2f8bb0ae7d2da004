"""Where a robot can drive in a plan: a graph of points, and shortest paths over it."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label as connected
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from placecue.errors import DataError
from placecue_sources.plan import Plan

log = logging.getLogger(__name__)

NEIGHBOURS = ((0, 1), (1, 0), (1, 1), (1, -1))


@dataclass(frozen=True, slots=True)
class Search:
    """Shortest paths from one point to all others.

    Parameters
    ----------
    start : int
        The point.
    before : ndarray of int32, shape (n,)
        The point before each on the path to it.
    length_to_place : ndarray of float64, shape (places,)
        Length of the path to the nearest point of each place, m.
    """

    start: int
    before: NDArray[np.int32]
    length_to_place: NDArray[np.float64]

    def path(self, goal: int) -> NDArray[np.intp]:
        """Return the points from the start to a goal, both included."""
        points = [goal]
        while points[-1] != self.start:
            points.append(int(self.before[points[-1]]))
        return np.array(points[::-1])


class Roads:
    """Points on a square lattice, each joined to its eight neighbours, all reachable.

    Parameters
    ----------
    plan : Plan
        The floor.
    free : ndarray of float64, shape (rows, cols)
        Distance of each cell of the plan to the nearest wall, m.
    clearance : float
        Least distance of a point to a wall, m. Near walls a path costs up to twice its length.
    spacing : float
        Distance between neighbouring points, m.

    Attributes
    ----------
    points : ndarray of float64, shape (n, 2)
        Positions, m.
    place : ndarray of int64, shape (n,)
        Number of the place that each point is in: a connected piece of one class.
    places : int
        Number of places.

    Raises
    ------
    DataError
        If there are not two points that are joined.
    """

    def __init__(
        self, plan: Plan, free: NDArray[np.float64], clearance: float, spacing: float
    ) -> None:
        stride = max(1, round(spacing / plan.grid.resolution))
        lattice = np.ix_(*(np.arange(stride // 2, size, stride) for size in plan.labels.shape))
        labels, room = plan.labels[lattice], free[lattice]
        drivable = (labels >= 0) & (room >= clearance)
        graph = _graph(drivable, room, clearance, stride * plan.grid.resolution)
        kept = _largest_piece(graph)
        if kept.size < 2:
            raise DataError(
                f"a robot cannot drive in the plan {plan.name} at {clearance:g} m from every wall; "
                "give a smaller clearance, or check the resolution"
            )
        place = _places(drivable, labels)
        _warn_of_unreached(plan.name, place, kept, clearance)
        rows, columns = (index[kept] for index in np.nonzero(drivable))
        centres = plan.grid.centres(lattice[0].ravel()[rows], lattice[1].ravel()[columns])
        self.graph = graph[kept][:, kept]
        self.points = np.column_stack(centres)
        self.place = np.unique(place[kept], return_inverse=True)[1]
        self.places = int(self.place.max()) + 1

    @property
    def size(self) -> int:
        """The number of points."""
        return len(self.points)

    def search(self, start: int) -> Search:
        """Return the shortest paths from a point to all others."""
        lengths, before = dijkstra(self.graph, indices=start, return_predecessors=True)
        to_place = np.full(self.places, np.inf)
        np.minimum.at(to_place, self.place, lengths)
        return Search(start, before, to_place)


def _graph(
    drivable: NDArray[np.bool_], room: NDArray[np.float64], clearance: float, spacing: float
) -> csr_array:
    """Return the symmetric graph of the drivable points, numbered in the order of the cells."""
    number = np.full(np.array(drivable.shape) + 2, -1)
    number[1:-1, 1:-1][drivable] = np.arange(drivable.sum())
    here = np.argwhere(drivable) + 1
    cost = 1 + clearance / np.maximum(room[drivable], spacing / 2)
    starts, ends, weights = [], [], []
    for shift in NEIGHBOURS:
        end = number[tuple((here + shift).T)]
        start = np.flatnonzero(end >= 0)
        end = end[start]
        starts.append(start)
        ends.append(end)
        weights.append(spacing * np.hypot(*shift) * (cost[start] + cost[end]) / 2)
    arrays = (np.concatenate(part) for part in (starts, ends, weights))
    start, end, weight = arrays
    half = coo_array((weight, (start, end)), shape=(len(here), len(here)))
    return csr_array(half + half.T)


def _largest_piece(graph: csr_array) -> NDArray[np.intp]:
    """Return the points of the largest connected piece."""
    if not graph.shape[0]:
        return np.empty(0, dtype=np.intp)
    pieces = connected_components(graph, directed=False)[1]
    return np.flatnonzero(pieces == np.bincount(pieces).argmax())


def _places(drivable: NDArray[np.bool_], labels: NDArray[np.int16]) -> NDArray[np.int64]:
    """Return the number of the place of each drivable point: connected cells of one class."""
    number = np.zeros(drivable.shape, dtype=np.int64)
    for name in np.unique(labels[drivable]):
        pieces, _ = connected(drivable & (labels == name), structure=np.ones((3, 3)))
        number += np.where(pieces > 0, pieces + number.max(), 0)
    return number[drivable]


def _warn_of_unreached(
    name: str, place: NDArray[np.int64], kept: NDArray[np.intp], clearance: float
) -> None:
    count, reached = np.unique(place).size, np.unique(place[kept]).size
    if reached < count:
        log.warning(
            f"plan {name}: a robot that stays {clearance:g} m from walls gets into {reached} of "
            f"{count} places; a smaller clearance opens more"
        )
