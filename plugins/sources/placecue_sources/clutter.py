"""Things that stand around: what a drawn floor plan lacks and a real scan is full of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices
from placecue_sources.plan import WALL, Plan
from placecue_sources.raycast import OccupancyGrid


def cluttered(
    plan: Plan, density: Mapping[str, float], sizes: Sequence[float], rng: np.random.Generator
) -> Plan:
    """Return a plan with random boxes in it, each turned at random.

    A box stands on free space of its class only: what would reach into another class or beyond
    a wall is cut off, so doors stay open.

    Parameters
    ----------
    plan : Plan
        The plan; it stays as it is.
    density : mapping of str to float
        For each class that is to be cluttered, the number of boxes per square metre.
    sizes : sequence of two floats
        Shortest and longest side of a box, m; lengths in between are drawn on a log scale, so
        that legs of tables and chairs are as frequent as cupboards.
    rng : Generator
        Where the boxes come from.

    Raises
    ------
    UsageError
        If a class is not one of the plan's.
    """
    labels = plan.labels.copy()
    for name, per_square_metre in density.items():
        if name not in plan.classes:
            raise UsageError(f"clutter is for the class {name!r}; {choices(name, plan.classes)}")
        ours = plan.labels == plan.classes.index(name)
        count = round(per_square_metre * ours.sum() * plan.grid.resolution**2)
        labels[ours & _boxes(ours, count, np.asarray(sizes) / plan.grid.resolution, rng)] = WALL
    grid = OccupancyGrid((labels == WALL).astype(np.uint8), plan.grid.resolution, plan.grid.origin)
    return Plan(plan.name, grid, labels, plan.classes)


def _boxes(
    where: NDArray[np.bool_], count: int, sizes: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Return the cells under boxes whose centres are drawn from cells; lengths in cells."""
    mask = np.zeros(where.shape, dtype=np.uint8)
    cells = np.argwhere(where)
    if not len(cells):
        return mask.astype(np.bool_)
    shortest, longest = np.log(sizes).tolist()
    for row, column in cells[rng.integers(len(cells), size=count)]:
        sides = np.exp(rng.uniform(shortest, longest, size=2))
        box = ((float(column), float(row)), tuple(sides.tolist()), float(rng.uniform(0, 90)))
        cv2.fillConvexPoly(mask, np.round(cv2.boxPoints(box)).astype(np.int32), 1)
    return mask.astype(np.bool_)
