"""The way that a robot took, thinned to as many points as a picture can show."""

from __future__ import annotations

from placecue.observation import Observation

Point = tuple[float, float, str]


class Trail:
    """Keeps every n-th position; n doubles whenever there are too many.

    Parameters
    ----------
    most : int
        How many positions to keep at most.

    Attributes
    ----------
    points : list of (x, y, label)
        Positions, m, with their labels; the empty text where there is none.
    """

    def __init__(self, most: int = 20_000) -> None:
        self.most = most
        self.points: list[Point] = []
        self._every = 1
        self._seen = 0

    def add(self, observation: Observation) -> None:
        """Take in the next observation."""
        pose = observation.pose
        if pose is None:
            return
        if self._seen % self._every == 0:
            self.points.append((pose.x, pose.y, observation.label or ""))
        self._seen += 1
        if len(self.points) > self.most:
            del self.points[1::2]
            self._every *= 2
