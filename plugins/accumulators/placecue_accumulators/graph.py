"""The navigation graph: places that the robot has been at, and which follow one another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import ceil, cos, floor, hypot, inf, sin


@dataclass(frozen=True, slots=True)
class Place:
    """A node of the graph.

    Parameters
    ----------
    x, y : float
        Position, m.
    gateway : bool
        Whether it is a door.
    heading : float
        The direction in which the door is passed, rad.
    """

    x: float
    y: float
    gateway: bool = False
    heading: float = 0.0

    def parts(self, one: Place, other: Place, half_width: float) -> bool:
        """Tell whether this door lies across the line between two nodes.

        Parameters
        ----------
        one, other : Place
            The ends of the line.
        half_width : float
            From the middle of the door to where its wall begins, m.
        """
        (a, u), (b, v) = self._seen(one), self._seen(other)
        return a * b < 0 and abs(u + (v - u) * a / (a - b)) <= half_width

    def depth(self, place: Place) -> float:
        """Return how far a position is behind this door as it was passed, m; negative before it."""
        return self._seen(place)[0]

    def _seen(self, place: Place) -> tuple[float, float]:
        """Return a position along the passage and across it, m."""
        dx, dy = place.x - self.x, place.y - self.y
        c, s = cos(self.heading), sin(self.heading)
        return dx * c + dy * s, dy * c - dx * s


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
        found = min(self.within(x, y, within), key=lambda each: each[0], default=None)
        return None if found is None else found[1]

    def within(self, x: float, y: float, distance: float) -> Iterator[tuple[float, int]]:
        """Yield how far each point is that is no farther than a distance, m, and its number."""
        column, row = self._cell_of(x, y)
        reach = ceil(distance / self.cell)
        for i in range(column - reach, column + reach + 1):
            for j in range(row - reach, row + reach + 1):
                for px, py, number in self._cells.get((i, j), ()):
                    if (far := hypot(px - x, py - y)) <= distance:
                        yield far, number

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

    def pass_gateway(self, x: float, y: float, heading: float = 0.0) -> Step | None:
        """Tell the graph that the robot passes a door at (x, y), m, in a direction, rad.

        Returns
        -------
        Step or None
            The step to a new gateway; None where a gateway nearby makes this one ignored.
        """
        if self._gateways.nearest(x, y, self.gateway_spacing) is not None:
            return None
        return self._go(self._make(Place(x, y, gateway=True, heading=heading)), new=True)

    def look_into(self, gateway: int, x: float, y: float) -> int | None:
        """Tell the graph how far the robot went through a gateway before it turned round, m.

        Returns
        -------
        int or None
            A new node there; None where one is near on that side.
        """
        door, here = self.places[gateway], Place(x, y)
        near = (self.places[number] for _, number in self._near.within(x, y, self.spacing))
        if not all(other.gateway or door.parts(here, other, inf) for other in near):
            return None
        made = self._make(here)
        self.edges.add((gateway, made))
        return made

    def leave(self) -> None:
        """Tell the graph that the robot is somewhere else, and did not drive there."""
        self.current = None

    def begin_part(self) -> None:
        """Tell the graph that positions from now on have nothing to do with those before."""
        self.leave()
        self._near = Neighbourhood(self.spacing)
        self._gateways = Neighbourhood(self.spacing)

    def part_at(self, gateway: int, half_width: float) -> set[tuple[int, int]]:
        """Lead edges that go through a door over its gateway; return those that did not.

        Parameters
        ----------
        gateway : int
            The gateway's number.
        half_width : float
            See :meth:`Place.parts`.
        """
        door, places = self.places[gateway], self.places
        through = {
            (a, b)
            for a, b in self.edges
            if gateway not in (a, b) and door.parts(places[a], places[b], half_width)
        }
        self.edges -= through
        for node in {node for edge in through for node in edge}:
            self.edges.add((min(node, gateway), max(node, gateway)))
        return through

    def pieces(self, nodes: Sequence[int]) -> list[list[int]]:
        """Return which of some nodes hang together without a gateway, the largest piece first."""
        left = {node for node in nodes if not self.places[node].gateway}
        joined = defaultdict(list)
        for a, b in self.edges:
            if a in left and b in left:
                joined[a].append(b)
                joined[b].append(a)
        pieces = []
        while left:
            piece, reached = [], [left.pop()]
            while reached:
                piece.append(node := reached.pop())
                reached += (new := left.intersection(joined[node]))
                left -= new
            pieces.append(sorted(piece))
        return sorted(pieces, key=lambda piece: (-len(piece), piece))

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


def neighbours_of(edges: Iterable[tuple[int, int]]) -> defaultdict[int, list[int]]:
    """Return the neighbours of each node."""
    beside = defaultdict(list)
    for a, b in edges:
        beside[a].append(b)
        beside[b].append(a)
    return beside


def within_reach(edges: Iterable[tuple[int, int]], node: int, reach: int) -> list[int]:
    """Return the nodes that are at most so many edges away from one, itself included, by number."""
    beside = neighbours_of(edges)
    found = outer = {node}
    for _ in range(reach):
        outer = {other for each in outer for other in beside[each]} - found
        found = found | outer
    return sorted(found)


def on_its_side(
    at: tuple[float, float], door: int, beside: Iterable[int], places: Sequence[Place]
) -> int:
    """Return the nearest neighbour of a door on the side of a position (m), or else the door."""
    here = Place(*at)
    same = [node for node in beside if not places[door].parts(here, places[node], inf)]
    rooms = [node for node in same if not places[node].gateway]
    distances = [hypot(places[node].x - here.x, places[node].y - here.y) for node in rooms]
    return rooms[distances.index(min(distances))] if rooms else door
