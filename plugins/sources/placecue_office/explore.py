"""A robot that explores: it goes to the nearest edge of what it knows, until there is none.

B. Yamauchi: A frontier-based approach for autonomous exploration. CIRA 1997.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import csgraph

from placecue_office.plan import Points
from placecue_office.route import Planner
from placecue_office.trace import cast

#: All eight neighbours of a cell.
_AROUND = np.ones((3, 3), dtype=bool)


class Explorer:
    """Finds its way through a building that it does not know.

    Parameters
    ----------
    planner : Planner
        Cells of the building; the robot uses those that it has seen.
    faces : ndarray, shape (k, 4)
        What the laser meets.
    reach : float
        Farthest that the laser adds to the map, m.
    beams : int
        Directions that it looks in, all around: the robot turns where it stops.
    step : float
        Way between two looks, m.
    smallest : int
        Frontiers of fewer cells are left alone.
    """

    def __init__(
        self,
        planner: Planner,
        faces: NDArray[np.float64],
        reach: float = 2.0,
        beams: int = 360,
        step: float = 0.4,
        smallest: int = 4,
    ) -> None:
        self.planner = planner
        self.faces = faces
        self.reach = reach
        self.beams = beams
        self.step = step
        self.smallest = smallest
        self.known = np.zeros(planner.raster.shape, dtype=bool)

    def explore(self, start: Points) -> Points:
        """Return the way driven from ``start`` (2,), m, shape (n, 2).

        The map is complete at the end: ``known`` says which cells have been seen.
        """
        driven = [int(self.planner.snap(start[None], self.planner.radius)[0])]
        self._look(driven[-1])
        while (leg := self._to_frontier(driven[-1])) is not None:
            hop = max(1, round(self.step / self.planner.raster.cell))
            for cell in (*leg[hop:-1:hop], leg[-1]):
                self._look(cell)
            driven += leg[1:]
        return self.planner.smoothed(np.array(driven))

    def _look(self, cell: int) -> None:
        x, y = self.planner.centres[cell].tolist()
        raster = self.planner.raster
        bearings = np.linspace(-np.pi, np.pi, self.beams, endpoint=False)
        lengths = np.minimum(cast(self.faces, x, y, bearings), self.reach)
        away = self.planner.centres - [x, y]
        far = np.hypot(*away.T)
        near = np.flatnonzero(far <= self.reach + raster.cell)
        beam = np.arctan2(away[near, 1], away[near, 0]) + np.pi
        number = np.round(beam * (self.beams / (2 * np.pi))).astype(int) % self.beams
        seen = near[far[near] <= lengths[number] + 0.5 * raster.cell]
        self.known.flat[seen] = True
        self.known.flat[cell] = True

    def _to_frontier(self, cell: int) -> list[int] | None:
        """Return the cells on the way to the nearest frontier, None where there is none left."""
        passable = self.known & (self.planner.room > self.planner.radius).reshape(self.known.shape)
        edge = passable & ndimage.binary_dilation(~self.known, _AROUND)
        groups, count = ndimage.label(edge, _AROUND)
        sizes = ndimage.sum_labels(edge, groups, np.arange(1, count + 1))
        wanted = np.isin(groups, 1 + np.flatnonzero(sizes >= self.smallest)).ravel()
        cells = np.flatnonzero(passable)
        if cell not in cells or not wanted.any():
            return None
        graph = self.planner.graph[cells][:, cells]
        origin = int(np.searchsorted(cells, cell))
        far, before = csgraph.dijkstra(
            graph, directed=False, indices=origin, return_predecessors=True
        )
        far[~wanted[cells] | (far == 0)] = np.inf
        if not np.isfinite(far).any():
            return None
        way = [int(far.argmin())]
        while way[-1] != origin:
            way.append(int(before[way[-1]]))
        return [int(cells[each]) for each in way[::-1]]
