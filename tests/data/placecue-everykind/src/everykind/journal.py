"""An accumulator, and a boundary that it takes."""

from __future__ import annotations

from collections import Counter
from math import hypot

from placecue import (
    UNKNOWN,
    Accumulator,
    Area,
    AreaUpdate,
    Belief,
    Boundary,
    Observation,
    Pose2D,
    SemanticMap,
    UsageError,
    check_number,
)


class Metres(Boundary):
    """An area ends after so many metres in a straight line."""

    def __init__(self, length: float = 30.0) -> None:
        self.length = length

    def update(self, observation: Observation) -> Pose2D | None:
        """Return the pose where the robot is too far from where the area began."""
        check_number("length", self.length, above=0.0)
        pose = observation.pose
        if pose is None:
            return None
        began = getattr(self, "began_", None) or pose
        crossed = hypot(pose.x - began.x, pose.y - began.y) > self.length
        self.began_: Pose2D | None = pose if crossed else began
        return pose if crossed else None

    def reset(self) -> None:
        """Forget where the area began."""
        self.began_ = None


class Journal(Accumulator):
    """Areas one after the other, each labelled by most of its beliefs."""

    def __init__(self, boundary: Boundary | None = None) -> None:
        self.boundary = boundary

    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Count a belief."""
        if self.boundary is None:
            raise UsageError("journal needs a boundary, such as boundary={plugin: metres}")
        if not hasattr(self, "areas_"):
            self.reset()
        if self.boundary.update(observation) is not None:
            self.areas_.append(Counter())
        if belief is None:
            return None
        self.areas_[-1][belief.label] += 1
        label, share = self._label(self.areas_[-1])
        return AreaUpdate(len(self.areas_) - 1, label, share)

    def semantic_map(self) -> SemanticMap:
        """Return the areas so far."""
        areas = [Area(number, *self._label(each)) for number, each in enumerate(self.areas_)]
        classes = sorted({label for each in self.areas_ for label in each})
        return SemanticMap(tuple(areas), nodes=(), edges=(), classes=tuple(classes))

    def reset(self) -> None:
        """Forget everything."""
        self.areas_: list[Counter[str]] = [Counter()]
        if self.boundary is not None:
            self.boundary.reset()

    @staticmethod
    def _label(counts: Counter[str]) -> tuple[str, float]:
        if not counts:
            return UNKNOWN, 0.0
        [(label, most)] = counts.most_common(1)
        return label, most / counts.total()
