"""Poses all over the free space of a plan, independent of one another."""

from __future__ import annotations

import logging

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.observation import Pose2D
from placecue_sources.plan import WALL, Plan

log = logging.getLogger(__name__)


class RandomPoses:
    """Draws poses uniformly from cells that are far enough from walls.

    Parameters
    ----------
    plan : Plan
        Where to be.
    clearance : float
        Least distance to a wall, m.
    by_class : bool
        Draw from the classes in turn, equally often, not from the whole area at once.

    Raises
    ------
    DataError
        If no cell is far enough from the walls.
    """

    def __init__(self, plan: Plan, clearance: float, by_class: bool) -> None:
        self.plan = plan
        cells = np.flatnonzero((plan.clearance() >= clearance) & (plan.labels >= 0))
        if not cells.size:
            raise DataError(
                f"no place in the plan {plan.name} is {clearance:g} m away from every wall; "
                "give a smaller clearance, or check the resolution"
            )
        _warn_of_narrow(plan, cells, clearance)
        self.pools = self._by_class(cells) if by_class else [cells]

    def _by_class(self, cells: NDArray[np.intp]) -> list[NDArray[np.intp]]:
        labels = self.plan.labels.ravel()[cells]
        return [cells[labels == label] for label in np.unique(labels)]

    def pose(self, index: int, rng: np.random.Generator) -> Pose2D:
        """Return the pose number ``index``: anywhere in a cell, looking anywhere."""
        pool = self.pools[index % len(self.pools)]
        cell = pool[rng.integers(pool.size)]
        row, column = np.unravel_index(cell, self.plan.labels.shape)
        x, y = self.plan.grid.centres(row, column)
        dx, dy, turn = rng.uniform(-0.5, 0.5, 3)
        side = self.plan.grid.resolution
        return Pose2D(float(x + dx * side), float(y + dy * side), 2 * np.pi * float(turn), "map")


def _warn_of_narrow(plan: Plan, cells: NDArray[np.intp], clearance: float) -> None:
    """Warn of classes that are in the plan, but nowhere far enough from the walls."""
    lost = np.setdiff1d(plan.labels, np.append(np.unique(plan.labels.ravel()[cells]), WALL))
    if lost.size:
        names = ", ".join(plan.classes[label] for label in lost)
        log.warning(
            f"plan {plan.name}: nowhere in {names} is {clearance:g} m away from every wall, so no "
            "scan is taken there; a smaller clearance opens more"
        )
