"""Areas as small as the nodes of the navigation graph."""

from __future__ import annotations

from typing import ClassVar

from placecue.accumulator import Boundary
from placecue.observation import Observation, Pose2D
from placecue_accumulators.graph import NavigationGraph


class NodeLeft(Boundary):
    """An area ends wherever one node of the navigation graph is left for another.

    It needs no laser. Space is cut into pieces of about ``spacing``, whatever rooms there are;
    neighbouring areas of one category can be merged afterwards.

    Parameters
    ----------
    spacing : float
        Distance between nodes, m. Best the same as the accumulator's ``node_spacing``.

    Attributes
    ----------
    gateway : bool
        False: what is crossed is no place of its own, so it becomes no node of the graph.
    """

    gateway: ClassVar[bool] = False

    def __init__(self, spacing: float = 1.0) -> None:
        self.spacing = spacing

    def update(self, observation: Observation) -> Pose2D | None:
        """Return the robot's pose where it has come to another node, or None."""
        if observation.pose is None:
            return None
        if not hasattr(self, "graph_"):
            self.reset()
        step = self.graph_.visit(observation.pose.x, observation.pose.y)
        return None if step is None or step.before is None else observation.pose

    def reset(self) -> None:
        """Forget the nodes."""
        self.graph_ = NavigationGraph(self.spacing)
