"""Beliefs gathered over time and space into labelled areas."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.checks import check_choice, check_number, check_whole
from placecue.observation import Observation, Pose2D
from placecue.semantic_map import UNKNOWN, Node, SemanticMap
from placecue_accumulators.areas import AreaRecord, Areas, Way
from placecue_accumulators.boundaries import Boundaries, Given
from placecue_accumulators.door import Door
from placecue_accumulators.doubts import Doubts
from placecue_accumulators.graph import NavigationGraph, Step
from placecue_accumulators.histogram import BinSums, Key, ViewpointHistogram, bin_of
from placecue_accumulators.judging import Judge, Judgement, check_judging, judge_for
from placecue_accumulators.same_label import MERGES, Merge, merge_same_label
from placecue_accumulators.time_windows import TimeWindows
from placecue_accumulators.way import Moment, Odometer, Recent, is_pose

Values = NDArray[np.float64]

#: From the middle of a doorway to where its wall surely begins, m.
DOOR_HALF_WIDTH = 0.6


class SpatioTemporal(Accumulator):
    """Semantic labelling of space: beliefs averaged within a viewpoint, summed over an area.

    Two histograms over (x, y, heading) are kept, of the current node and of the current area.
    A node's is added to what is stored at the node when the robot comes to another; the area's is
    cleared where the area ends. When the robot comes back to an area, what is stored at its nodes
    counts as well. The scores' own multi-class rule decides, and its label goes to the whole area.

    Parameters
    ----------
    boundary : Boundary, or several in a list or mapping, optional
        Where one area ends: where any of them says so. A door
        (:class:`~placecue_accumulators.door.Door`) with its defaults if None.
    bin_x, bin_y : float
        Size of a bin, m.
    bin_theta : float
        Size of a bin, rad. The heading is unwrapped: a full turn leads to other bins.
    accept_confidence : float
        Beliefs of less confidence are dropped, in the unit of the scores; so are those that the
        pipeline calls ``unknown``.
    label_confidence : float
        An area is ``unknown`` until its accumulated belief has this confidence, in the same unit.
    label_probability : float
        And until its label is as probable as this.
    sharpness : float or None
        Log odds of one belief by the unit of its scores. None takes what the model has learned,
        or, where it has not, what is usual.
    independent : float
        The share of what a bin says that its neighbours have not said already, 0 to 1.
    doubt : float
        The share of beliefs, and of places, that may say anything, 0 to 1.
    forget_after : int or None
        Bins last visited more than this many viewpoints ago are dropped; None keeps all. Every
        pose counts, also where no belief was accepted.
    node_spacing : float
        Distance between the nodes of the navigation graph, m.
    gateway_spacing : float
        A door no farther than this from an earlier one makes no gateway, m.
    prior_bins : float
        What is stored of earlier visits counts as at most this many bins.
    merge : {"none", "open", "all"}
        Which neighbouring areas of one label are one in the map given out: none, those without a
        door between them, or all. The evidence stays apart.

    Notes
    -----
    An observation without a pose is passed over; of a log without any pose, areas are windows of
    10 s. A door makes a gateway node; the robot is in no
    area until it is nearer to another node. That node's area is entered, or a new area begins if
    the node is new; what was seen since the door belongs to it. Where the door stands across a way
    that the robot went before without seeing it, the area is parted there. Areas are merged when
    the robot goes from an ordinary node of one straight to one of the other, unless a boundary
    has it that they are two. Where a boundary notices later that an area has ended, the nodes
    and beliefs since then go to the new one. Poses in another frame begin a part of the map that
    has nothing to do with the one before; where poses jump, no edge is drawn.

    References
    ----------
    Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place classification,
    IJRR 29(2-3), 2010, section 5. Zender et al., Conceptual spatial representations for indoor
    mobile robots, RAS 56(6), 2008.
    """

    def __init__(
        self,
        boundary: Given = None,
        bin_x: float = 0.2,
        bin_y: float = 0.2,
        bin_theta: float = 0.1,
        accept_confidence: float = 0.1,
        label_confidence: float = 0.1,
        label_probability: float = 0.5,
        sharpness: float | None = None,
        independent: float = 0.1,
        doubt: float = 0.02,
        forget_after: int | None = 30,
        node_spacing: float = 1.0,
        gateway_spacing: float = 2.0,
        prior_bins: float = 20.0,
        merge: Merge = "none",
    ) -> None:
        self.boundary = boundary
        self.bin_x = bin_x
        self.bin_y = bin_y
        self.bin_theta = bin_theta
        self.accept_confidence = accept_confidence
        self.label_confidence = label_confidence
        self.label_probability = label_probability
        self.sharpness = sharpness
        self.independent = independent
        self.doubt = doubt
        self.forget_after = forget_after
        self.node_spacing = node_spacing
        self.gateway_spacing = gateway_spacing
        self.prior_bins = prior_bins
        self.merge = merge

    def reset(self) -> None:
        """Forget everything, as before the first observation.

        Raises
        ------
        UsageError
            If a size or spacing is not positive, or a number of bins is negative.
        """
        self.check_parameters()
        self.boundaries_ = Boundaries.of(self.boundary, [Door()])
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
        self.odometer_ = Odometer()
        self.recent_ = Recent(self.boundaries_.delay)
        self.changed_: float | None = None  # where beliefs changed and no area was parted yet, m
        self.judge_: Judge | None = None
        self.frame_: str | None = None  # the first
        self.doubts_ = Doubts()
        self.windows_ = TimeWindows()
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
        """
        if not hasattr(self, "graph_"):
            self.reset()
        pose = observation.pose
        if pose is None or not is_pose(pose):
            return self._unplaced(observation, belief)
        self._move(pose, observation.stamp)
        self._follow(observation, pose)
        self._walk(pose, observation.stamp)
        viewpoint = self._visit(pose, observation.stamp)
        if belief is not None and self._accepts(belief):
            judge = self._judge_of(belief)
            self._hear(observation, judge.single(belief.scores.values[0]))
            self._accumulate(viewpoint, belief)
        return self.updates_.pop(next(iter(self.updates_))) if self.updates_ else None

    def semantic_map(self) -> SemanticMap:
        """Return the map as it stands after the observations so far."""
        if not hasattr(self, "graph_"):
            self.reset()
        if self.judge_ is not None and self.windows_ and not self.graph_.places:
            return self.windows_.semantic_map(self.judge_)
        made = SemanticMap(
            areas=self.areas_.to_areas(),
            nodes=tuple(
                Node(
                    number,
                    place.x,
                    place.y,
                    self.areas_.area_of[number],
                    place.gateway,
                    place.heading,
                    self._probabilities(number),
                )
                for number, place in enumerate(self.graph_.places)
            ),
            edges=tuple(sorted(self.graph_.edges)),
            classes=self.judge_.layout.classes if self.judge_ else (),
            frame=self.frame_ or "odom",
        )
        return merge_same_label(made, self.merge)

    def warnings(self) -> list[str]:
        """Return what a person should know of the map, a line each."""
        if not hasattr(self, "graph_"):
            return []
        return self.doubts_.lines(self.semantic_map())

    def _unplaced(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in a moment without a pose: of a log without any, areas are windows of time."""
        self.doubts_.unplaced += 1
        if self.graph_.places or belief is None or not self._accepts(belief):
            return None
        self.doubts_.count(belief.label)
        judge = self._judge_of(belief)
        return self.windows_.add(observation.stamp, belief.scores.values[0], judge)

    def _probabilities(self, node: int) -> dict[str, float]:
        prior = self.areas_.priors.get(node, BinSums())
        if self.judge_ is None or prior.bins <= 0:
            return {}
        found = self.judge_.probabilities(prior).tolist()
        return dict(zip(self.judge_.layout.classes, found, strict=True))

    # ------------------------------------------------------------------ space

    def _move(self, pose: Pose2D, stamp: int) -> None:
        turn = self.odometer_.follow(pose, stamp)
        if self.frame_ is None:
            self.frame_ = pose.frame
        if turn == "on":
            return
        self._leave_node()
        self._leave_area()
        self.way_, self.way_start_ = {}, None
        self.of_node_.clear()
        self.recent_.clear()
        self.boundaries_.enter()
        self.doubts_.broken(turn, pose)
        if turn == "frame":
            self.graph_.begin_part()
        else:
            self.graph_.leave()

    def _follow(self, observation: Observation, pose: Pose2D) -> None:
        crossed = self.boundaries_.update(observation)
        if self.graph_.current is None:  # so that there is an area before any gateway
            self._take(self.graph_.visit(pose.x, pose.y), observation.stamp)
        step = None
        if crossed is not None and crossed.gateway:
            door = crossed.pose
            step = self.graph_.pass_gateway(door.x, door.y, door.theta)
            self._part(step, observation.stamp)
        elif crossed is not None:
            self.ended_ = True
        self._take(step or self.graph_.visit(pose.x, pose.y), observation.stamp)

    def _part(self, step: Step | None, stamp: int) -> None:
        """Part areas that a new door lies across, as the robot came in without seeing it."""
        if step is None:
            return
        through = self.graph_.part_at(step.node, DOOR_HALF_WIDTH)
        area_of = self.areas_.area_of
        for area in sorted({area_of[a] for a, b in through if area_of[a] == area_of[b]}):
            record = self.areas_.records[area]
            for piece in self.graph_.pieces(record.nodes)[1:]:
                new = self.areas_.begin(record.start, record.frame)
                new.end = record.end
                self.areas_.move(piece, new)
                self._share_way(record, new)
                self._rejudge(new)
                self._announce(new)
                if step.before in piece and self.current_ is record:
                    self.current_, self.left_ = new, new.number
            self._rejudge(record)

    def _share_way(self, record: AreaRecord, new: AreaRecord) -> None:
        """Hand a new area the positions that are nearer to its nodes than to the old one's."""
        at = [
            np.array([(self.graph_.places[n].x, self.graph_.places[n].y) for n in each.nodes])
            for each in (record, new)
        ]
        for key, position in list(record.way.items()):
            kept, taken = (np.hypot(*(nodes - position).T).min() for nodes in at)
            if taken < kept:
                new.way[key] = record.way.pop(key)

    def _rejudge(self, record: AreaRecord) -> None:
        if self.judge_ is not None and record.evidence.bins > 0:
            record.judged = Judgement()
            record.judge(record.evidence, self.judge_)

    def _take(self, step: Step | None, stamp: int) -> None:
        if step is None:
            return
        if self.graph_.places[step.node].gateway:
            self._reach_gateway(step)
        else:
            self._reach_node(step, stamp)

    def _reach_gateway(self, step: Step) -> None:
        self._leave_node(step.before)
        self._leave_area()
        if step.new:
            self.areas_.assign(step.node, self.left_)

    def _reach_node(self, step: Step, stamp: int) -> None:
        self._leave_node(step.before)
        if step.new:
            if self.current_ is None or self.ended_:
                self._leave_area()
                begun = stamp if self.way_start_ is None else self.way_start_
                self._enter(self.areas_.begin(begun, self.odometer_.frame))
            if self.current_ is not None:
                self.areas_.assign(step.node, self.current_.number)
        else:
            self._enter_known(self.areas_.records[self.areas_.area_of[step.node]])
        self.ended_ = False

    def _enter_known(self, known: AreaRecord) -> None:
        here = self.current_
        if here is known:
            return
        if here is not None and self._are_one(here, known):
            self.of_area_.clear()  # it is stored at the nodes
            self.current_ = self.areas_.merge(here.number, known.number)
            self.left_ = self.current_.number
            self._enter(self.current_)
        else:
            self._leave_area()
            self._enter(known)

    def _are_one(self, here: AreaRecord, known: AreaRecord) -> bool:
        if not here.nodes:
            return True  # of an area that never got as far as a node nothing would be left
        judge = self.judge_
        if judge is None:
            return self.boundaries_.joins(np.zeros(2), np.zeros(2))
        seen = self.entry_ + self.of_area_.sums()
        one, other = (judge.likelihoods(sums) for sums in (seen, known.evidence))
        return self.boundaries_.joins(one, other)

    def _leave_node(self, before: int | None = None) -> None:
        """Store what was seen at the node; what was seen outside its area goes to the next."""
        before = self.graph_.current if before is None else before
        here = self.current_
        if here is None or before is None or self.areas_.area_of[before] != here.number:
            return
        self.areas_.store(before, self.of_node_.sums())
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
        if record.number == self.left_:
            self._part_at_change()
        else:
            self.changed_ = None
            self.boundaries_.enter()
        self._judge()
        self._announce(self.current_)

    def _walk(self, pose: Pose2D, stamp: int) -> None:
        key = self._position(pose)
        if self.current_ is None:
            self.way_.setdefault(key, (pose.x, pose.y))
            self.way_start_ = stamp if self.way_start_ is None else self.way_start_
        else:
            self.current_.way.setdefault(key, (pose.x, pose.y))
            self.current_.end = max(stamp, self.current_.end)

    def _position(self, pose: Pose2D) -> Key:
        return bin_of((pose.x, pose.y), (self.bin_x, self.bin_y))

    def _visit(self, pose: Pose2D, stamp: int) -> Key:
        """Count the viewpoint, and return its bin."""
        sizes = (self.bin_x, self.bin_y, self.bin_theta)
        viewpoint = bin_of((pose.x, pose.y, self.odometer_.theta), sizes)
        self.of_node_.visit(viewpoint)
        self.of_area_.visit(viewpoint)
        if self.recent_.length:
            seen = self.of_area_.visits, self.of_node_.visits
            here = self.graph_.current, self._position(pose)
            self.recent_.add(Moment(self.odometer_.way, stamp, *here, *seen))
        return viewpoint

    # ------------------------------------------------------------------ beliefs

    def _accepts(self, belief: Belief) -> bool:
        sure = belief.label != UNKNOWN and belief.confidence >= self.accept_confidence
        return sure and bool(np.isfinite(belief.scores.values).all())

    def _hear(self, observation: Observation, probabilities: Values) -> None:
        """Ask the boundaries whether what is believed has changed, and part the area there."""
        behind = self.boundaries_.believe(observation, probabilities)
        if behind is not None:
            self.changed_ = self.odometer_.way - behind
            self._part_at_change()

    def _part_at_change(self) -> None:
        """Part the current area where beliefs changed; at a gateway that waits until it is left."""
        here, changed = self.current_, self.changed_
        if here is None or changed is None:
            return
        since, self.changed_ = self.recent_.since(changed), None
        if not since:
            return
        reached = {moment.node for moment in since if moment.node != since[0].node}
        new = self.areas_.begin(since[0].stamp, here.frame)
        new.end = self.odometer_.stamp
        self.areas_.move([node for node in here.nodes if node in reached], new)
        for moment in since:
            if moment.key in here.way:
                new.way[moment.key] = here.way.pop(moment.key)
        here.end = since[0].stamp
        self._part_evidence(since[0], here)
        self._announce(here, finished=True)
        self.left_, self.current_, self.entry_ = here.number, new, BinSums()
        self._judge()
        self._announce(new)

    def _part_evidence(self, change: Moment, here: AreaRecord) -> None:
        """Leave what was seen before a change with the area that ended there."""
        before = self.of_area_.sums()
        self.of_area_.keep_since(change.of_area)
        before = before - self.of_area_.sums()
        if change.node is not None and change.node == self.graph_.current:
            at_node = self.of_node_.sums()
            self.of_node_.keep_since(change.of_node)
            if self.areas_.area_of[change.node] == here.number:
                self.areas_.store(change.node, at_node - self.of_node_.sums())
        if self.judge_ is not None:
            seen = here.evidence if here.evidence.bins > 0 else before
            here.judged = Judgement()
            here.judge(seen, self.judge_)

    def _accumulate(self, viewpoint: Key, belief: Belief) -> None:
        values = belief.scores.values[0]
        self.of_node_.add(viewpoint, values)
        self.of_area_.add(viewpoint, values)
        self.doubts_.count(belief.label)
        if self._judge() and self.current_ is not None:
            self._announce(self.current_)

    def _judge(self) -> bool:
        sums = self.entry_ + self.of_area_.sums()
        if self.current_ is None or self.judge_ is None or sums.bins <= 0:
            return False
        return self.current_.judge(sums, self.judge_)

    def _announce(self, record: AreaRecord, finished: bool = False) -> None:
        judged = record.judged
        update = AreaUpdate(record.number, judged.label, judged.probability, finished)
        self.updates_.pop(record.number, None)  # so that the order is that of the news
        self.updates_[record.number] = update

    # ------------------------------------------------------------------ checks

    def _judge_of(self, belief: Belief) -> Judge:
        """Return the judge of scores; the first belief tells what they are."""
        self.judge_ = judge_for(self, belief.scores.layout, self.label_confidence)
        return self.judge_

    def check_parameters(self) -> None:
        """Raise UsageError if a size is not positive or a share not between 0 and 1."""
        for name in ("bin_x", "bin_y", "bin_theta", "node_spacing"):
            check_number(name, getattr(self, name), above=0)
        for name in ("gateway_spacing", "prior_bins"):
            check_number(name, getattr(self, name), least=0)
        check_judging(self)
        if self.forget_after is not None:
            check_whole("forget_after", self.forget_after, least=0)
        check_choice("merge", self.merge, MERGES)
