"""The navigation graph: places that the robot has been at, and which follow one another."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from math import ceil, floor, hypot


@dataclass(frozen=True, slots=True)
class Place:
    """A node of the graph: a position in m, and whether it is a gateway."""

    x: float
    y: float
    gateway: bool = False


@dataclass(frozen=True, slots=True)
class Step:
    """A change of the current node.

    Parameters
    ----------
    node : int
        The node that is current now.
    before : int or None
        The one that was; None at the first.
    new : bool
        Whether the node was made by this step.
    """

    node: int
    before: int | None
    new: bool


class Neighbourhood:
    """Finds the nearest of many points within a distance, by cells of a grid.

    Parameters
    ----------
    cell : float
        Side of a cell, m.
    """

    def __init__(self, cell: float) -> None:
        self.cell = cell
        self._cells: defaultdict[tuple[int, int], list[tuple[float, float, int]]]
        self._cells = defaultdict(list)

    def add(self, x: float, y: float, number: int) -> None:
        """Remember a point under a number."""
        self._cells[self._cell_of(x, y)].append((x, y, number))

    def nearest(self, x: float, y: float, within: float) -> int | None:
        """Return the number of the nearest point no farther than ``within`` m, or None."""
        column, row = self._cell_of(x, y)
        reach = ceil(within / self.cell)
        best, found = within, None
        for i in range(column - reach, column + reach + 1):
            for j in range(row - reach, row + reach + 1):
                for px, py, number in self._cells.get((i, j), ()):
                    distance = hypot(px - x, py - y)
                    if distance < best or (distance == best and found is None):
                        best, found = distance, number
        return found

    def _cell_of(self, x: float, y: float) -> tuple[int, int]:
        return floor(x / self.cell), floor(y / self.cell)


class NavigationGraph:
    """Nodes along the robot's way, joined where the robot went from one to the other.

    Parameters
    ----------
    spacing : float
        A node is made where the robot is farther than this from every node, m.
    gateway_spacing : float
        A gateway no farther than this from another is ignored, m.

    Attributes
    ----------
    places : list of Place
        The nodes, by number.
    edges : set of (int, int)
        Pairs of node numbers, the smaller first.
    current : int or None
        The node that the robot is at.

    References
    ----------
    Zender, Martinez Mozos, Jensfelt, Kruijff, Burgard, Conceptual spatial representations for
    indoor mobile robots, RAS 56(6), 2008.
    """

    def __init__(self, spacing: float = 1.0, gateway_spacing: float = 2.0) -> None:
        self.spacing = spacing
        self.gateway_spacing = gateway_spacing
        self.places: list[Place] = []
        self.edges: set[tuple[int, int]] = set()
        self.current: int | None = None
        self._near = Neighbourhood(spacing)
        self._gateways = Neighbourhood(spacing)

    def visit(self, x: float, y: float) -> Step | None:
        """Tell the graph where the robot is, m.

        Returns
        -------
        Step or None
            The step to the nearest node within ``spacing``, or to a new one where there is none;
            None where the robot is still at the current node.
        """
        nearest = self._near.nearest(x, y, self.spacing)
        if nearest is None:
            return self._go(self._make(Place(x, y)), new=True)
        return None if nearest == self.current else self._go(nearest, new=False)

    def pass_gateway(self, x: float, y: float) -> Step | None:
        """Tell the graph that the robot passes a door at (x, y), m.

        Returns
        -------
        Step or None
            The step to a new gateway; None where a gateway nearby makes this one ignored.
        """
        if self._gateways.nearest(x, y, self.gateway_spacing) is not None:
            return None
        return self._go(self._make(Place(x, y, gateway=True)), new=True)

    def _make(self, place: Place) -> int:
        number = len(self.places)
        self.places.append(place)
        self._near.add(place.x, place.y, number)
        if place.gateway:
            self._gateways.add(place.x, place.y, number)
        return number

    def _go(self, node: int, new: bool) -> Step:
        before, self.current = self.current, node
        if before is not None:
            self.edges.add((min(before, node), max(before, node)))
        return Step(node, before, new)
