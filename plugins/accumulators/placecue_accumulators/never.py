"""No boundary at all: one area, until the map says otherwise."""

from __future__ import annotations

from placecue.accumulator import Boundary
from placecue.observation import Observation, Pose2D


class Never(Boundary):
    """No area ever ends."""

    def update(self, observation: Observation) -> Pose2D | None:
        """Return None."""
        return None

    def reset(self) -> None:
        """Do nothing."""
