"""Observations put in order of time, with bounded memory."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator
from typing import Generic, Protocol, TypeVar


class Stamped(Protocol):
    """Anything with a time, such as an Observation."""

    @property
    def stamp(self) -> int:
        """The time, ns."""


T = TypeVar("T", bound=Stamped)


class InOrder(Generic[T]):
    """Sorts a stream that is nearly in order of time.

    Parameters
    ----------
    observations : iterable of Observation, or of anything else with a stamp
        The stream.
    window : int
        How many observations are held back at most. One that comes later than that is left out.

    Attributes
    ----------
    late : int
        How many were left out in the last iteration.
    """

    def __init__(self, observations: Iterable[T], window: int) -> None:
        self.observations = observations
        self.window = window
        self.late = 0

    def __iter__(self) -> Iterator[T]:
        self.late = 0
        heap: list[tuple[int, int, T]] = []
        emitted: int | None = None
        for number, observation in enumerate(self.observations):
            if emitted is not None and observation.stamp < emitted:
                self.late += 1
                continue
            heapq.heappush(heap, (observation.stamp, number, observation))
            if len(heap) > self.window:
                emitted, _, first = heapq.heappop(heap)
                yield first
        while heap:
            yield heapq.heappop(heap)[2]
