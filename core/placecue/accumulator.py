"""An accumulator: from single beliefs to labelled areas of space."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from placecue.belief import Belief
from placecue.estimator import Estimator
from placecue.observation import Observation, Pose2D
from placecue.semantic_map import AreaUpdate as AreaUpdate
from placecue.semantic_map import SemanticMap


class Boundary(Estimator, ABC):
    """Says where one area ends, one observation at a time.

    Attributes
    ----------
    gateway : bool
        Whether what is crossed is a place of its own, such as a door, and becomes a node.
    """

    gateway: ClassVar[bool] = True

    @abstractmethod
    def update(self, observation: Observation) -> Pose2D | None:
        """Return the pose of a boundary that has just been crossed, or None.

        Parameters
        ----------
        observation : Observation
            The next moment; one without the parts that the boundary needs is passed over.
        """

    @abstractmethod
    def reset(self) -> None:
        """Forget everything, as before the first observation."""


class Accumulator(Estimator, ABC):
    """Gathers beliefs over time and space; owns bins, areas and the navigation graph.

    One pass, one observation at a time; memory grows with the space seen, not with time.
    """

    @abstractmethod
    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in the next observation.

        Parameters
        ----------
        observation : Observation
            The next moment, with its pose.
        belief : Belief or None
            What the pipeline says of it; None where nothing could be said. The pose and scan
            still count for boundaries and the graph.

        Returns
        -------
        AreaUpdate or None
            The current area, where its label or its extent changed.
        """

    @abstractmethod
    def semantic_map(self) -> SemanticMap:
        """Return the map as it stands after the observations so far."""

    @abstractmethod
    def reset(self) -> None:
        """Forget everything, as before the first observation."""
