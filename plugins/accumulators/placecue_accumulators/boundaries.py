"""Boundaries that are joined: an area ends where one of them says so."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from placecue import contracts
from placecue.accumulator import Boundary
from placecue.errors import UsageError, described
from placecue.estimator import clone
from placecue.guard import call
from placecue.observation import Observation, Pose2D

Values = NDArray[np.float64]

#: How an accumulator is given its boundaries.
Given = Boundary | Sequence[Boundary] | Mapping[str, Boundary] | None


@dataclass(frozen=True, slots=True)
class Crossing:
    """A boundary that was crossed just now.

    Parameters
    ----------
    pose : Pose2D
        Where.
    gateway : bool
        Whether it is a place of its own.
    """

    pose: Pose2D
    gateway: bool


class Boundaries:
    """Asks each boundary in turn.

    Parameters
    ----------
    boundaries : sequence of Boundary
        They become this object's own.
    """

    def __init__(self, boundaries: Sequence[Boundary]) -> None:
        self.each = tuple(boundaries)

    @classmethod
    def of(cls, given: Given, usual: Sequence[Boundary]) -> Boundaries:
        """Return copies of the boundaries that an accumulator was given, or of the usual ones.

        Raises
        ------
        UsageError
            If something among them is no boundary.
        """
        if given is None:
            listed = list(usual)
        elif isinstance(given, Mapping):
            listed = list(given.values())
        else:
            listed = [given] if isinstance(given, Boundary) else list(given)
        for each in listed:
            if not isinstance(each, Boundary):
                raise UsageError(
                    f"boundary holds {described(each)}: give boundaries, such as [door, evidence]"
                )
        return cls([clone(each) for each in listed])

    @property
    def delay(self) -> float:
        """The largest distance between a change and where it is noticed, m of way."""
        return max((float(each.delay) for each in self.each), default=0.0)

    def update(self, observation: Observation) -> Crossing | None:
        """Return what was crossed just now; a gateway before anything else."""
        crossed = None
        for each in self.each:
            pose: Pose2D | None = call(
                each, "update", observation, check=contracts.crossing, at=observation
            )
            if pose is not None and (crossed is None or each.gateway):
                crossed = Crossing(pose, bool(each.gateway))
        return crossed

    def believe(self, observation: Observation, probabilities: Values) -> float | None:
        """Return how far behind, m of way, an area has ended by what is believed, or None."""
        found = None
        for each in self.each:
            behind: float | None = call(
                each,
                "believe",
                observation,
                probabilities,
                check=contracts.behind,
                at=observation,
            )
            found = behind if found is None else found
        return found

    def enter(self) -> None:
        """Tell each that the robot is in another area."""
        for each in self.each:
            call(each, "enter")

    def recall(self, likelihoods: Values) -> None:
        """Tell each what was seen on earlier visits in that area."""
        for each in self.each:
            call(each, "recall", likelihoods)

    def joins(self, one: Values, other: Values) -> bool:
        """Tell whether all agree that two connected areas are one."""
        return all(call(each, "joins", one, other) for each in self.each)
