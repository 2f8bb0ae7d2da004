"""Beliefs gathered over time and space into labelled areas."""

from __future__ import annotations

from math import isfinite, pi

import numpy as np

from placecue import contracts
from placecue.accumulator import Accumulator, AreaUpdate, Boundary
from placecue.belief import Belief
from placecue.errors import DataError, UsageError
from placecue.estimator import clone
from placecue.guard import call
from placecue.observation import Observation, Pose2D
from placecue.scores import Layout
from placecue.semantic_map import UNKNOWN, Node, SemanticMap
from placecue_accumulators.areas import AreaRecord, Areas, Way
from placecue_accumulators.door import Door
from placecue_accumulators.graph import NavigationGraph, Step
from placecue_accumulators.histogram import BinSums, Key, ViewpointHistogram, bin_of
from placecue_accumulators.same_label import merge_same_label


class SpatioTemporal(Accumulator):
    """Semantic labelling of space: beliefs averaged within a viewpoint, summed over an area.

    Two histograms over (x, y, heading) are kept, of the current node and of the current area.
    A node's is added to what is stored at the node when the robot comes to another; the area's is
    cleared where the area ends. When the robot comes back to an area, what is stored at its nodes
    counts as well. The scores' own multi-class rule decides, and its label goes to the whole area.

    Parameters
    ----------
    boundary : Boundary, optional
        Where one area ends; :class:`~placecue_accumulators.door.Door` with its defaults if None.
    bin_x, bin_y : float
        Size of a bin, m.
    bin_theta : float
        Size of a bin, rad. The heading is unwrapped: a full turn leads to other bins.
    accept_confidence : float
        Beliefs of less confidence are dropped, in the unit of the scores; so are those that the
        pipeline calls ``unknown``.
    label_confidence : float
        An area is ``unknown`` until its accumulated belief has this confidence, in the same unit.
    forget_after : int or None
        Bins last visited more than this many viewpoints ago are dropped; None keeps all. Every
        pose counts, also where no belief was accepted.
    node_spacing : float
        Distance between the nodes of the navigation graph, m.
    gateway_spacing : float
        A door no farther than this from an earlier one makes no gateway, m.
    prior_bins : float
        What is stored of earlier visits counts as at most this many bins.
    merge_same_label : bool
        Whether neighbouring areas of one label are one in the map given out.

    Notes
    -----
    An observation without a pose is passed over. A door makes a gateway node; the robot is in no
    area until it is nearer to another node. That node's area is entered, or a new area begins if
    the node is new; what was seen since the door belongs to it. Areas are merged when the robot
    goes from an ordinary node of one straight to one of the other.

    References
    ----------
    Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place classification,
    IJRR 29(2-3), 2010, section 5. Zender et al., Conceptual spatial representations for indoor
    mobile robots, RAS 56(6), 2008.
    """

    def __init__(
        self,
        boundary: Boundary | None = None,
        bin_x: float = 0.2,
        bin_y: float = 0.2,
        bin_theta: float = 0.1,
        accept_confidence: float = 0.1,
        label_confidence: float = 0.1,
        forget_after: int | None = 30,
        node_spacing: float = 1.0,
        gateway_spacing: float = 2.0,
        prior_bins: float = 20.0,
        merge_same_label: bool = False,
    ) -> None:
        self.boundary = boundary
        self.bin_x = bin_x
        self.bin_y = bin_y
        self.bin_theta = bin_theta
        self.accept_confidence = accept_confidence
        self.label_confidence = label_confidence
        self.forget_after = forget_after
        self.node_spacing = node_spacing
        self.gateway_spacing = gateway_spacing
        self.prior_bins = prior_bins
        self.merge_same_label = merge_same_label

    def reset(self) -> None:
        """Forget everything, as before the first observation.

        Raises
        ------
        UsageError
            If a size or spacing is not positive, or a number of bins is negative.
        """
        self._check_parameters()
        self.boundary_: Boundary = Door() if self.boundary is None else clone(self.boundary)
        # Whether a boundary is a place of its own, as a door is, and becomes a node.
        self.gateways_ = bool(self.boundary_.gateway)
        self.graph_ = NavigationGraph(self.node_spacing, self.gateway_spacing)
        self.areas_ = Areas(self.prior_bins)
        self.of_node_ = ViewpointHistogram(self.forget_after)
        self.of_area_ = ViewpointHistogram(self.forget_after)
        self.current_: AreaRecord | None = None  # None while at a gateway
        self.left_ = 0  # the area that the robot was in last
        self.entry_ = BinSums()  # stored evidence of the current area when it was entered
        self.ended_ = False  # a boundary that is no gateway was crossed since the last step
        self.way_: Way = {}  # positions since a gateway was reached
        self.way_start_: int | None = None
        self.pose_: Pose2D | None = None
        self.theta_ = 0.0
        self.layout_: Layout | None = None
        self.updates_: dict[int, AreaUpdate] = {}  # not yet given out, the latest of each area

    # ------------------------------------------------------------------ one observation

    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in the next observation; see :class:`placecue.Accumulator`.

        Where one observation leads out of one area and into another, the second update is given
        with the next observation.

        Raises
        ------
        UsageError
            If the belief's scores have another layout than those before.
        DataError
            If the pose is in another frame than those before.
        """
        pose = observation.pose
        if pose is None or not all(map(isfinite, (pose.x, pose.y, pose.theta))):
            return None
        if not hasattr(self, "graph_"):
            self.reset()
        self._turn(pose)
        self._follow(observation, pose)
        self._walk(pose, observation.stamp)
        viewpoint = self._visit(pose)
        if belief is not None and self._accepts(belief):
            self._accumulate(viewpoint, belief)
        return self.updates_.pop(next(iter(self.updates_))) if self.updates_ else None

    def semantic_map(self) -> SemanticMap:
        """Return the map as it stands after the observations so far."""
        if not hasattr(self, "graph_"):
            self.reset()
        made = SemanticMap(
            areas=self.areas_.to_areas(),
            nodes=tuple(
                Node(number, place.x, place.y, self.areas_.area_of[number], place.gateway)
                for number, place in enumerate(self.graph_.places)
            ),
            edges=tuple(sorted(self.graph_.edges)),
            classes=self.layout_.classes if self.layout_ else (),
            frame=self.pose_.frame if self.pose_ else "odom",
        )
        return merge_same_label(made) if self.merge_same_label else made

    # ------------------------------------------------------------------ space

    def _turn(self, pose: Pose2D) -> None:
        last = self.pose_
        if last is None:
            self.theta_ = pose.theta
        elif last.frame != pose.frame:
            raise DataError(
                f"the pose is in frame '{pose.frame}' and those before were in '{last.frame}': "
                "give one pose topic to one accumulator"
            )
        else:
            self.theta_ += (pose.theta - last.theta + pi) % (2 * pi) - pi
        self.pose_ = pose

    def _follow(self, observation: Observation, pose: Pose2D) -> None:
        crossed: Pose2D | None = call(
            self.boundary_, "update", observation, check=contracts.crossing, at=observation
        )
        if self.graph_.current is None:  # so that there is an area before any gateway
            self._take(self.graph_.visit(pose.x, pose.y), observation.stamp)
        step = None
        if crossed is not None and self.gateways_:
            step = self.graph_.pass_gateway(crossed.x, crossed.y)
        elif crossed is not None:
            self.ended_ = True
        self._take(step or self.graph_.visit(pose.x, pose.y), observation.stamp)

    def _take(self, step: Step | None, stamp: int) -> None:
        if step is None:
            return
        if self.graph_.places[step.node].gateway:
            self._reach_gateway(step)
        else:
            self._reach_node(step, stamp)

    def _reach_gateway(self, step: Step) -> None:
        self._leave_node(step)
        self._leave_area()
        if step.new:
            self.areas_.assign(step.node, self.left_)

    def _reach_node(self, step: Step, stamp: int) -> None:
        self._leave_node(step)
        if step.new:
            if self.current_ is None or self.ended_:
                self._leave_area()
                begun = stamp if self.way_start_ is None else self.way_start_
                self._enter(self.areas_.begin(begun))
            if self.current_ is not None:
                self.areas_.assign(step.node, self.current_.number)
        else:
            self._enter_known(self.areas_.records[self.areas_.area_of[step.node]])
        self.ended_ = False

    def _enter_known(self, known: AreaRecord) -> None:
        here = self.current_
        if here is known:
            return
        if here is not None and self.gateways_:
            self.of_area_.clear()  # it is stored at the nodes
            self._enter(self.areas_.merge(here.number, known.number))
        else:
            self._leave_area()
            self._enter(known)

    def _leave_node(self, step: Step) -> None:
        """Store what was seen at the node; what was seen at a gateway goes to the next node."""
        if self.current_ is not None and step.before is not None:
            self.areas_.store(step.before, self.of_node_.sums())
            self.of_node_.clear()

    def _leave_area(self) -> None:
        if self.current_ is not None:
            self._announce(self.current_, finished=True)
            self.left_, self.current_ = self.current_.number, None
            self.of_area_.clear()

    def _enter(self, record: AreaRecord) -> None:
        self.current_ = record
        self.entry_ = record.evidence.limited(self.prior_bins)
        record.way.update(self.way_)
        self.way_, self.way_start_ = {}, None
        self._judge()
        self._announce(record)

    def _walk(self, pose: Pose2D, stamp: int) -> None:
        key = bin_of((pose.x, pose.y), (self.bin_x, self.bin_y))
        if self.current_ is None:
            self.way_.setdefault(key, (pose.x, pose.y))
            self.way_start_ = stamp if self.way_start_ is None else self.way_start_
        else:
            self.current_.way.setdefault(key, (pose.x, pose.y))
            self.current_.end = max(stamp, self.current_.end)

    def _visit(self, pose: Pose2D) -> Key:
        """Count the viewpoint, and return its bin."""
        sizes = (self.bin_x, self.bin_y, self.bin_theta)
        viewpoint = bin_of((pose.x, pose.y, self.theta_), sizes)
        self.of_node_.visit(viewpoint)
        self.of_area_.visit(viewpoint)
        return viewpoint

    # ------------------------------------------------------------------ beliefs

    def _accepts(self, belief: Belief) -> bool:
        sure = belief.label != UNKNOWN and belief.confidence >= self.accept_confidence
        return sure and bool(np.isfinite(belief.scores.values).all())

    def _accumulate(self, viewpoint: Key, belief: Belief) -> None:
        self._check_layout(belief.scores.layout)
        values = belief.scores.values[0]
        self.of_node_.add(viewpoint, values)
        self.of_area_.add(viewpoint, values)
        if self._judge() and self.current_ is not None:
            self._announce(self.current_)

    def _judge(self) -> bool:
        sums = self.entry_ + self.of_area_.sums()
        if self.current_ is None or self.layout_ is None or sums.bins == 0:
            return False
        return self.current_.judge(sums, self.layout_, self.label_confidence)

    def _announce(self, record: AreaRecord, finished: bool = False) -> None:
        update = AreaUpdate(record.number, record.label, record.confidence, finished)
        self.updates_.pop(record.number, None)  # so that the order is that of the news
        self.updates_[record.number] = update

    # ------------------------------------------------------------------ checks

    def _check_layout(self, layout: Layout) -> None:
        if self.layout_ is None:
            self.layout_ = layout
        elif layout is not self.layout_ and layout != self.layout_:
            raise UsageError(
                f"the layout of scores changed from {_described(self.layout_)} to "
                f"{_described(layout)}: an accumulator takes the beliefs of one pipeline; reset "
                "it before it is given another's"
            )

    def _check_parameters(self) -> None:
        for name in ("bin_x", "bin_y", "bin_theta", "node_spacing"):
            if not getattr(self, name) > 0:
                raise UsageError(f"{name} is {getattr(self, name)}: give a size above 0")
        for name in ("gateway_spacing", "prior_bins", "forget_after"):
            value = getattr(self, name)
            if value is not None and not value >= 0:
                raise UsageError(f"{name} is {value}: give 0 or more")


def _described(layout: Layout) -> str:
    return f"{layout.name} of {len(layout.classes)} classes ({', '.join(layout.classes)})"
