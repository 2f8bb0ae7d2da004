"""What waits to be labelled: in order, and only the newest where labelling does not keep up."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from time import monotonic
from typing import Generic, TypeVar

T = TypeVar("T")


class Newest(Generic[T]):
    """Hands out what came, oldest first; where the oldest waited too long, the newest alone.

    So a short delay loses nothing, and a lasting one is never longer than the patience.

    Parameters
    ----------
    patience : float or None
        How long anything may wait, s; None: for ever, and nothing is dropped.
    clock : callable
        Gives the time, s.

    Attributes
    ----------
    dropped : int
        How many were dropped.
    """

    def __init__(self, patience: float | None, clock: Callable[[], float] = monotonic) -> None:
        self.patience = patience
        self.clock = clock
        self.dropped = 0
        self._waiting: deque[tuple[float, T]] = deque()

    def __len__(self) -> int:
        return len(self._waiting)

    def add(self, arrived: float, item: T) -> None:
        """Take in what came at a time, s."""
        self._waiting.append((arrived, item))

    def next(self) -> T:
        """Return the next one.

        Raises
        ------
        IndexError
            If nothing waits.
        """
        if self.patience is not None and self.clock() - self._waiting[0][0] > self.patience:
            while len(self._waiting) > 1:
                self._waiting.popleft()
                self.dropped += 1
        return self._waiting.popleft()[1]
