"""A cue of one's own: how far a robot can see all around."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue import Component, Cue, Observation, UsageError, hookimpl


class Openness(Cue):
    """How far the laser sees, as shares of its beams within rings around the robot.

    Parameters
    ----------
    rings : int
        How many rings there are.
    farthest : float
        Where the last one begins, m.
    """

    requires: ClassVar = ("scan",)
    version: ClassVar = "1"  # change it when the features change: kept ones are made anew

    def __init__(self, rings: int = 16, farthest: float = 10.0) -> None:
        self.rings = rings
        self.farthest = farthest

    def check_parameters(self) -> None:
        """Raise UsageError where the parameters cannot be what they are."""
        if self.rings < 2 or not self.farthest > 0:
            raise UsageError(f"openness takes rings >= 2 and farthest > 0, got {self.rings} and "
                             f"{self.farthest}")  # fmt: skip

    def extract(self, observation: Observation) -> NDArray[np.float64]:
        """Return the share of beams that end in each ring, shape (rings,)."""
        assert observation.scan is not None  # as the cue requires one
        lengths = observation.scan.filled()  # m, in the order of scan.angles
        ring = np.minimum(lengths / self.farthest, 1.0) * (self.rings - 1)
        return np.bincount(ring.astype(int), minlength=self.rings) / lengths.size


@hookimpl
def placecue_components() -> Sequence[Component]:
    """Return what this package brings."""
    where = "placecue_openness:Openness"
    return [Component("cue", "openness", where, "how far the laser sees", ("scan",))]
