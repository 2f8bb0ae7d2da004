"""An accumulator: from single beliefs to labelled areas of space."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.belief import Belief
from placecue.correction import Correction
from placecue.estimator import Estimator
from placecue.observation import Observation, Pose2D
from placecue.semantic_map import AreaUpdate as AreaUpdate
from placecue.semantic_map import SemanticMap

Values = NDArray[np.float64]


class Boundary(Estimator, ABC):
    """Says where one area ends, one observation at a time.

    Attributes
    ----------
    gateway : bool
        Whether what is crossed is a place of its own, such as a door, and becomes a node.
    """

    gateway: ClassVar[bool] = True

    @property
    def delay(self) -> float:
        """The largest distance between a change and the place where it is noticed, m of way."""
        return 0.0

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

    def believe(self, observation: Observation, probabilities: Values) -> float | None:
        """Return how far behind an area has ended, by what is believed, m of way, or None.

        Asked after :meth:`update` where there is a belief that counts; the default is never
        convinced.

        Parameters
        ----------
        observation : Observation
            The moment, with its pose.
        probabilities : ndarray of float64, shape (M,)
            Of each class, by this belief alone.
        """
        return None

    def enter(self) -> None:
        """Take note that the robot is in another area now, whoever noticed."""

    def recall(self, likelihoods: Values) -> None:
        """Take note of what was seen on earlier visits in the area that the robot is in now.

        Told after :meth:`enter` where the area is a known one.

        Parameters
        ----------
        likelihoods : ndarray of float64, shape (M,)
            Log-likelihoods of each class.
        """

    def joins(self, one: Values, other: Values) -> bool:
        """Tell whether two areas are one, as the robot went from one straight into the other.

        Parameters
        ----------
        one, other : ndarray of float64, shape (M,)
            Log-likelihoods of each class by what was seen in each area.

        Returns
        -------
        bool
            By default so if what separates areas is a place of its own, which was not passed.
        """
        return self.gateway


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

    def corrected(self, correction: Correction) -> None:
        """Take note that the poses of earlier observations are known better now.

        Called before the :meth:`update` with the first observation that is told in the new poses.
        The default keeps everything where it is: :class:`placecue.slam.retold.Retold` around an
        accumulator sees to it that it is told everything again.

        Parameters
        ----------
        correction : Correction
            Where each moment of the way was put, and where it is now.
        """

    def finish(self) -> None:
        """Take note that the log has ended; the default does nothing."""

    def warnings(self) -> list[str]:
        """Return what a person should know of the map before trusting it, a line each."""
        return []
