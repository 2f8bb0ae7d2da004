"""What those who look on are told, and how often."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Protocol

from placecue import contracts
from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.free_space import FreeSpace, Grid
from placecue.guard import call
from placecue.observation import Observation
from placecue.semantic_map import SemanticMap
from placecue.surfaces import with_surfaces

#: The map takes no more than this share of the time, however large it is.
SHARE = 0.05


@dataclass(frozen=True, slots=True)
class Moment:
    """One step of a run.

    Parameters
    ----------
    observation : Observation
        What was seen.
    belief : Belief or None
        What is said of it; None where nothing could be said.
    area : AreaUpdate or None
        The area that the robot is in, as last told of.
    """

    observation: Observation
    belief: Belief | None
    area: AreaUpdate | None


class Onlooker(Protocol):
    """Told of every moment, and of the map from time to time."""

    def moment(self, moment: Moment) -> None:
        """Take in a moment."""

    def map(self, stamp: int, semantic_map: SemanticMap, grid: Grid | None) -> None:
        """Take in the map as of a time, ns, with the free space that it lies in."""

    def end(self) -> None:
        """Take note that there is nothing more to come."""


class OnlookersTold:
    """Tells onlookers of each step, and of the map every so many seconds; a listener.

    A large map is told of less often, so that its making holds up the robot by no more than a
    twentieth of the time.

    Parameters
    ----------
    onlookers : sequence of Onlooker
        Who is told.
    accumulator : Accumulator
        Has the map.
    space : FreeSpace
        A listener that is told before this one.
    every : float
        How often the map is told of, s.
    clock : callable
        Gives the time, s.
    """

    def __init__(
        self,
        onlookers: Sequence[Onlooker],
        accumulator: Accumulator,
        space: FreeSpace,
        every: float = 1.0,
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self.onlookers = onlookers
        self.accumulator = accumulator
        self.space = space
        self.every = every
        self.clock = clock
        self._area: AreaUpdate | None = None
        self._stamp = 0
        self._due = clock()

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Tell of one step."""
        self._stamp = observation.stamp
        self._area = self._area if update is None else update
        moment = Moment(observation, belief, self._area)
        for onlooker in self.onlookers:
            onlooker.moment(moment)
        begun = self.clock()
        if self.onlookers and begun >= self._due:
            self.map()
            took = self.clock() - begun
            self._due = begun + max(self.every, took / SHARE)

    def map(self) -> tuple[SemanticMap, Grid | None]:
        """Tell of the map as it is now, and return it with the free space."""
        grid = self.space.grid()
        found: SemanticMap = call(self.accumulator, "semantic_map", check=contracts.semantic_map)
        shared = with_surfaces(found, grid)
        for onlooker in self.onlookers:
            onlooker.map(self._stamp, shared, grid)
        return shared, grid

    def end(self) -> tuple[SemanticMap, Grid | None]:
        """Tell of the last map, and that it is the last; return it with the free space."""
        last = self.map()
        for onlooker in self.onlookers:
            onlooker.end()
        return last
