"""A cue."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue import Cue, Observation, Part, check_whole


class Sectors(Cue):
    """Mean range of each of a number of sectors, m."""

    requires: ClassVar[tuple[Part, ...]] = ("scan",)

    def __init__(self, count: int = 6) -> None:
        self.count = count

    def extract(self, observation: Observation) -> NDArray[np.float64]:
        """Return the means, shape (count,)."""
        check_whole("count", self.count, least=1)
        assert observation.scan is not None
        parts = np.array_split(observation.scan.filled(), self.count)
        return np.array([part.mean() for part in parts])
