"""What a map is worth: how much of the way, of nodes, areas and free space is labelled rightly."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.free_space import Grid
from placecue.observation import Observation
from placecue.semantic_map import UNKNOWN, Area, SemanticMap
from placecue.surfaces import NOBODY, shared_out

#: Positions are counted once a bin of this side, m.
BIN = 0.2
#: An area is large that has more observations than this.
LARGE = 10
#: Shorter stays in a place are none, s.
SHORTEST_STAY = 2.0

Truth = dict[int, Counter[str]]
#: Names the true class at a position, m; None where it is not known.
TruthAt = Callable[[float, float], str | None]


@dataclass(frozen=True, slots=True)
class Distribution:
    """What a map says of one area or node, and what it is.

    Parameters
    ----------
    probabilities : mapping of str to float
        Of each class.
    truth : str
        The class of most of its positions.
    """

    probabilities: Mapping[str, float]
    truth: str


@dataclass(frozen=True, slots=True)
class AreaScores:
    """Shares of a labelled log that a map has right.

    Parameters
    ----------
    single : float
        Of single beliefs.
    way, unknown : float
        Of the positions, one a bin, that are right and that are unknown.
    nodes : float
        Of the nodes.
    areas, right : int
        How many areas there are, and how many are labelled as most of their positions are.
    large, large_right : int
        The same of areas with more than ten observations.
    free : float or None
        Of the free cells whose class is known; None without free space.
    delay : float or None
        From coming into a place until its label is right, s, the median over stays; a stay in
        which it never is counts as long as it lasts. None without a stay.
    never : float
        Of the stays, those in which the label never is right.
    """

    single: float
    way: float
    unknown: float
    nodes: float
    areas: int
    right: int
    large: int
    large_right: int
    free: float | None
    delay: float | None
    never: float


@dataclass(slots=True)
class _Stay:
    """A stay in one place."""

    label: str
    start: int
    end: int
    right: int | None = None

    @property
    def delay(self) -> float:
        """Until the label was right, s."""
        return ((self.end if self.right is None else self.right) - self.start) / 1e9


class AreaTally:
    """Remembers what is true along a labelled log; a listener.

    Memory grows with the ground covered.

    Parameters
    ----------
    ignored : collection of str
        True labels that are passed over.
    """

    def __init__(self, ignored: Sequence[str] = ()) -> None:
        self.ignored = frozenset(ignored)
        self.counts: Counter[tuple[int, int, str]] = Counter()
        self.stays: list[_Stay] = []
        self.beliefs = self.right = 0
        self._now = UNKNOWN

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take in an observation, its belief and what the accumulator made of it."""
        if update is not None and not update.finished:
            self._now = update.label
        label, pose = observation.label, observation.pose
        if label is None or label in self.ignored:
            return
        if belief is not None:
            self.beliefs += 1
            self.right += belief.label == label
        if pose is not None and np.isfinite([pose.x, pose.y]).all():
            self.counts[round(pose.x / BIN), round(pose.y / BIN), label] += 1
            self._stay(label, observation.stamp)

    def _stay(self, label: str, stamp: int) -> None:
        if not self.stays or self.stays[-1].label != label:
            self.stays.append(_Stay(label, stamp, stamp))
        stay = self.stays[-1]
        stay.end = stamp
        if stay.right is None and self._now == label:
            stay.right = stamp

    # ------------------------------------------------------------------ what came of it

    def scores(
        self, semantic_map: SemanticMap, grid: Grid | None = None, truth_at: TruthAt | None = None
    ) -> AreaScores:
        """Return what a map of the log is worth.

        Parameters
        ----------
        semantic_map : SemanticMap
            What the accumulator made of the log.
        grid : Grid, optional
            Free space, for its share.
        truth_at : callable, optional
            The true class of a cell. By default that of the labelled position from which it is
            reached first through free space.
        """
        of_area, of_node = self.truth(semantic_map)
        labels = {area.id: area.label for area in semantic_map.areas}
        home = {node.id: labels[node.area] for node in semantic_map.nodes}
        bins = sum(each.total() for each in of_area.values())
        good = [labels[number] == _most(found) for number, found in of_area.items()]
        seen = self._observations(semantic_map)
        large = [n for n in of_area if seen[n] > LARGE]
        stays = [s for s in self.stays if (s.end - s.start) / 1e9 >= SHORTEST_STAY]
        return AreaScores(
            single=_share(self.right, self.beliefs),
            way=_share(sum(n[labels[a]] for a, n in of_area.items()), bins),
            unknown=_share(
                sum(n.total() for a, n in of_area.items() if labels[a] == UNKNOWN), bins
            ),
            nodes=_share(sum(home[i] == _most(n) for i, n in of_node.items()), len(of_node)),
            areas=len(good),
            right=sum(good),
            large=len(large),
            large_right=sum(labels[n] == _most(of_area[n]) for n in large),
            free=None if grid is None else self._free(semantic_map, grid, truth_at),
            delay=median(stay.delay for stay in stays) if stays else None,
            never=_share(sum(stay.right is None for stay in stays), len(stays)),
        )

    def truth(self, semantic_map: SemanticMap) -> tuple[Truth, Truth]:
        """Return how many positions of each class each area, and each node, has."""
        of_area: defaultdict[int, Counter[str]] = defaultdict(Counter)
        of_node: defaultdict[int, Counter[str]] = defaultdict(Counter)
        for (_, _, label), area, node in self._nearest(semantic_map):
            of_area[area][label] += 1
            of_node[node][label] += 1
        return dict(of_area), dict(of_node)

    def distributions(
        self, semantic_map: SemanticMap
    ) -> tuple[list[Distribution], list[Distribution]]:
        """Return what the map says of areas and of nodes, where it says anything, and the truth."""
        of_area, of_node = self.truth(semantic_map)
        areas = {each.id: each.probabilities for each in semantic_map.areas}
        nodes = {each.id: each.probabilities for each in semantic_map.nodes}
        return (
            [Distribution(areas[i], _most(n)) for i, n in of_area.items() if areas[i]],
            [Distribution(nodes[i], _most(n)) for i, n in of_node.items() if nodes[i]],
        )

    def _positions(self) -> NDArray[np.float64]:
        return np.array([(i * BIN, j * BIN) for i, j, _ in self.counts]).reshape(-1, 2)

    def _nearest(self, semantic_map: SemanticMap) -> list[tuple[tuple[int, int, str], int, int]]:
        """Return each position with the area whose way is nearest to it, and the nearest node."""
        ways = [(x, y, a.id) for a in semantic_map.areas for x, y in a.trajectory]
        nodes = [(n.x, n.y, n.id) for n in semantic_map.nodes if not n.gateway]
        if not ways or not nodes or not self.counts:
            return []  # a map in time has no places
        positions = self._positions()
        owners = _owners(ways, positions), _owners(nodes, positions)
        return list(zip(self.counts, *owners, strict=True))

    def _observations(self, semantic_map: SemanticMap) -> Counter[int]:
        found: Counter[int] = Counter()
        for key, area, _ in self._nearest(semantic_map):
            found[area] += self.counts[key]
        return found

    def _free(self, semantic_map: SemanticMap, grid: Grid, truth_at: TruthAt | None) -> float:
        owners = shared_out(semantic_map, grid, 10.0)
        labels = np.array([*(area.label for area in semantic_map.areas), ""])
        told = labels[owners]  # NOBODY is the last
        owned = owners != NOBODY
        if truth_at is None:
            truth = self._true_cells(semantic_map, grid)
        else:
            truth = _named(grid, owned, truth_at)
        known = (truth != "") & owned & ~np.isin(truth, list(self.ignored))
        return _share(int((told[known] == truth[known]).sum()), int(known.sum()))

    def _true_cells(self, semantic_map: SemanticMap, grid: Grid) -> NDArray[np.str_]:
        """Return the class of each cell, shared out as areas are; empty where there is none."""
        positions, names = self._positions(), sorted({label for *_, label in self.counts})
        of = np.array([label for *_, label in self.counts])
        areas = tuple(
            Area(row, name, 1.0, trajectory=tuple(map(tuple, positions[of == name].tolist())))
            for row, name in enumerate(names)
        )
        framed = tuple(replace(area, frame=grid.frame) for area in areas)
        doors = tuple(replace(n, area=0) for n in semantic_map.nodes if n.gateway)
        owners = shared_out(SemanticMap(framed, doors, (), tuple(names)), grid, 10.0)
        return np.array([*names, ""])[owners]


def _named(grid: Grid, cells: NDArray[np.bool_], truth_at: TruthAt) -> NDArray[np.str_]:
    """Return the class of some cells, empty elsewhere and where there is none."""
    rows, columns = np.nonzero(cells)
    xs, ys = grid.x + (columns + 0.5) * grid.cell, grid.y + (rows + 0.5) * grid.cell
    names = [truth_at(x, y) or "" for x, y in zip(xs.tolist(), ys.tolist(), strict=True)]
    found = np.full(cells.shape, "", dtype=f"U{max(map(len, names), default=1) or 1}")
    found[rows, columns] = names
    return found


def _owners(
    points: Sequence[tuple[float, float, int]], positions: NDArray[np.float64]
) -> list[int]:
    at = np.array([(x, y) for x, y, _ in points])
    rows = KDTree(at).query(positions)[1]
    return [points[row][2] for row in rows]


def _most(found: Counter[str]) -> str:
    return found.most_common(1)[0][0]


def _share(some: float, of: float) -> float:
    return some / of if of else 0.0
