"""How soon beliefs follow what they are of, and how many a second."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from time import monotonic

import numpy as np

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import Observation

#: Over so many of the last observations latency and rate are told.
LAST = 1000


class Pace:
    """Measures latency and rate over the last thousand observations; a listener.

    Parameters
    ----------
    arrived : callable
        Gives when the present observation arrived, s on the clock.
    clock : callable
        Gives the time, s.

    Attributes
    ----------
    count : int
        Observations so far.
    """

    def __init__(
        self, arrived: Callable[[], float], clock: Callable[[], float] = monotonic
    ) -> None:
        self.arrived = arrived
        self.clock = clock
        self.count = 0
        self._latencies: deque[float] = deque(maxlen=LAST)
        self._times: deque[float] = deque(maxlen=LAST)

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take the time."""
        now = self.clock()
        self.count += 1
        self._latencies.append(now - self.arrived())
        self._times.append(now)

    @property
    def latency(self) -> tuple[float, float]:
        """Median and 99th percentile of the time from arrival to belief, ms; NaN before any."""
        if not self._latencies:
            return float("nan"), float("nan")
        median, late = np.percentile(np.array(self._latencies) * 1e3, [50, 99])
        return float(median), float(late)

    @property
    def rate(self) -> float:
        """Observations a second; 0 before there are two."""
        if len(self._times) < 2:
            return 0.0
        return (len(self._times) - 1) / max(self._times[-1] - self._times[0], 1e-9)
