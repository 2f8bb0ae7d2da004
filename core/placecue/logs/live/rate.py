"""How many messages a second are let through."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic


class Rate:
    """Lets so many a second through, and as many at once.

    Parameters
    ----------
    most : int
        How many.
    clock : callable
        Gives the time, s.
    """

    def __init__(self, most: int, clock: Callable[[], float] = monotonic) -> None:
        self.most = most
        self.clock = clock
        self._left = float(most)
        self._last = clock()

    def allows(self) -> bool:
        """Tell whether one more is let through now."""
        now = self.clock()
        self._left = min(self._left + (now - self._last) * self.most, float(self.most))
        self._last = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
