"""Automatic exposure that follows the light with a lag."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray


class Exposure:
    """Exposures of a sequence, each from what was metered then and shortly before.

    Parameters
    ----------
    times : ndarray, shape (n,)
        When images are taken, s.
    lag : float
        Time after which what was metered counts for 1/e, s; 0 forgets at once.
    memory : int
        How many images back it remembers.
    """

    def __init__(self, times: NDArray[np.float64], lag: float, memory: int = 8) -> None:
        self.times = times
        self.lag = lag
        self.memory = memory
        self._metered: dict[int, float] = {}

    def at(self, index: int, meter: Callable[[int], float]) -> float:
        """Return the exposure of an image, whichever were asked for before.

        Parameters
        ----------
        index : int
            Number of the image.
        meter : callable
            Gives the exposure that suits an image, by its number.
        """
        first = max(index - self.memory + 1, 0) if self.lag else index
        age = self.times[index] - self.times[first : index + 1]
        weights = np.exp(-age / max(self.lag, 1e-9))
        gains = [np.log(self._suiting(each, meter)) for each in range(first, index + 1)]
        return float(np.exp(weights @ gains / weights.sum()))

    def _suiting(self, index: int, meter: Callable[[int], float]) -> float:
        if index not in self._metered:
            self._metered[index] = meter(index)
        return self._metered[index]
