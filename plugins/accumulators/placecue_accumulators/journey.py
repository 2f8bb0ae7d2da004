"""Where the robot is: the node and the area that it is in, and what was seen there."""

from __future__ import annotations

import numpy as np

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import Observation, Pose2D
from placecue_accumulators.areas import AreaRecord, Areas, Way
from placecue_accumulators.boundaries import Boundaries
from placecue_accumulators.graph import NavigationGraph, Step
from placecue_accumulators.histogram import BinSums, Key, ViewpointHistogram, bin_of
from placecue_accumulators.judging import Judge
from placecue_accumulators.parting import part_at_change, part_at_gateway
from placecue_accumulators.way import Moment, Odometer, Recent, Turn


class News:
    """What has changed of areas and is not yet given out: of each area the latest."""

    def __init__(self) -> None:
        self._updates: dict[int, AreaUpdate] = {}

    def add(self, record: AreaRecord, finished: bool = False) -> None:
        """Tell how an area stands; the order is that of the news."""
        judged = record.judged
        self._updates.pop(record.number, None)
        self._updates[record.number] = AreaUpdate(
            record.number, judged.label, judged.probability, finished
        )

    def next(self) -> AreaUpdate | None:
        """Return the oldest and forget it; None where there is none."""
        return self._updates.pop(next(iter(self._updates))) if self._updates else None

    def __len__(self) -> int:
        return len(self._updates)


class Journey:
    """Follows the robot through the graph and the areas; see :class:`SpatioTemporal`.

    Parameters
    ----------
    boundaries : Boundaries
        They say where areas end.
    graph : NavigationGraph
    areas : Areas
    sizes : (float, float, float)
        Of a bin of the pose: m, m, rad.
    forget_after : int or None
        See :class:`~placecue_accumulators.histogram.ViewpointHistogram`.

    Attributes
    ----------
    judge : Judge or None
        Says what accumulated scores mean; None before the first belief.
    news : News
        What is to be told of areas.
    current : AreaRecord or None
        The area that the robot is in; None while it is at a gateway.
    left : int
        The area that it was in last.
    changed : float or None
        Where beliefs changed and no area was parted yet, m of way.
    """

    def __init__(
        self,
        boundaries: Boundaries,
        graph: NavigationGraph,
        areas: Areas,
        sizes: tuple[float, float, float],
        forget_after: int | None,
    ) -> None:
        self.boundaries = boundaries
        self.graph = graph
        self.areas = areas
        self.sizes = sizes
        self.of_node = ViewpointHistogram(forget_after)
        self.of_area = ViewpointHistogram(forget_after)
        self.odometer = Odometer()
        self.recent = Recent(boundaries.delay)
        self.news = News()
        self.judge: Judge | None = None
        self.frame: str | None = None  # the first
        self.current: AreaRecord | None = None
        self.left = 0
        self.entry = BinSums()  # stored evidence of the current area when it was entered
        self.changed: float | None = None
        self._ended = False  # a boundary that is no gateway was crossed since the last step
        self._way: Way = {}  # positions since a gateway was reached
        self._way_start: int | None = None

    # ------------------------------------------------------------------ the way

    def move(self, pose: Pose2D, stamp: int) -> Turn:
        """Drive on to a pose; where the way is broken off, leave everything."""
        turn = self.odometer.follow(pose, stamp)
        if self.frame is None:
            self.frame = pose.frame
        if turn == "on":
            return turn
        self._leave_node()
        self._leave_area()
        self._way, self._way_start = {}, None
        self.of_node.clear()
        self.recent.clear()
        self.boundaries.enter()
        if turn == "frame":
            self.graph.begin_part()
        else:
            self.graph.leave()
        return turn

    def follow(self, observation: Observation, pose: Pose2D) -> None:
        """Cross boundaries, and reach nodes and areas."""
        crossed, stamp = self.boundaries.update(observation), observation.stamp
        if self.graph.current is None:  # so that there is an area before any gateway
            self._take(self.graph.visit(pose.x, pose.y), stamp)
        step = None
        if crossed is not None and crossed.gateway:
            door = crossed.pose
            step = self.graph.pass_gateway(door.x, door.y, door.theta)
            if step is not None:
                part_at_gateway(self, step)
        elif crossed is not None:
            self._ended = True
        self._take(step or self.graph.visit(pose.x, pose.y), stamp)

    def visit(self, pose: Pose2D, stamp: int) -> Key:
        """Be at a pose: count the viewpoint, and return its bin."""
        place = bin_of((pose.x, pose.y), self.sizes[:2])
        self._walk(place, pose, stamp)
        viewpoint = bin_of((pose.x, pose.y, self.odometer.theta), self.sizes)
        self.of_node.visit(viewpoint)
        self.of_area.visit(viewpoint)
        if self.recent.length:
            seen = self.of_area.visits, self.of_node.visits
            self.recent.add(Moment(self.odometer.way, stamp, self.graph.current, place, *seen))
        return viewpoint

    def _walk(self, place: Key, pose: Pose2D, stamp: int) -> None:
        if self.current is None:
            self._way.setdefault(place, (pose.x, pose.y))
            self._way_start = stamp if self._way_start is None else self._way_start
        else:
            self.current.way.setdefault(place, (pose.x, pose.y))
            self.current.end = max(stamp, self.current.end)

    # ------------------------------------------------------------------ nodes and areas

    def _take(self, step: Step | None, stamp: int) -> None:
        if step is None:
            return
        self._leave_node(step.before)
        if self.graph.places[step.node].gateway:
            self._leave_area()
            if step.new:
                self.areas.assign(step.node, self.left)
        else:
            self._reach_node(step, stamp)

    def _reach_node(self, step: Step, stamp: int) -> None:
        if step.new:
            if self.current is None or self._ended:
                self._leave_area()
                begun = stamp if self._way_start is None else self._way_start
                self._enter(self.areas.begin(begun, self.odometer.frame))
            if self.current is not None:
                self.areas.assign(step.node, self.current.number)
        else:
            self._enter_known(self.areas.records[self.areas.area_of[step.node]])
        self._ended = False

    def _enter_known(self, known: AreaRecord) -> None:
        here = self.current
        if here is known:
            return
        if here is not None and self._are_one(here, known):
            self.of_area.clear()  # it is stored at the nodes
            self.current = self.areas.merge(here.number, known.number)
            self.left = self.current.number
            self._enter(self.current)
        else:
            self._leave_area()
            self._enter(known)

    def _are_one(self, here: AreaRecord, known: AreaRecord) -> bool:
        if not here.nodes:
            return True  # of an area that never got as far as a node nothing would be left
        judge = self.judge
        if judge is None:
            return self.boundaries.joins(np.zeros(2), np.zeros(2))
        seen = self.entry + self.of_area.sums()
        one, other = (judge.likelihoods(sums) for sums in (seen, known.evidence))
        return self.boundaries.joins(one, other)

    def _leave_node(self, before: int | None = None) -> None:
        """Store what was seen at the node; what was seen outside its area goes to the next."""
        before = self.graph.current if before is None else before
        here = self.current
        if here is None or before is None or self.areas.area_of[before] != here.number:
            return
        self.areas.store(before, self.of_node.sums())
        self.of_node.clear()

    def _leave_area(self) -> None:
        if self.current is not None:
            self.news.add(self.current, finished=True)
            self.left, self.current = self.current.number, None
            self.of_area.clear()

    def _enter(self, record: AreaRecord) -> None:
        self.current = record
        self.entry = record.evidence.limited(self.areas.prior_bins)
        record.way.update(self._way)
        self._way, self._way_start = {}, None
        if record.number == self.left:
            part_at_change(self)
        else:
            self.changed = None
            self.boundaries.enter()
            if self.judge is not None and self.entry.bins > 0:
                self.boundaries.recall(self.judge.likelihoods(self.entry))
        self.judge_area()
        self.news.add(self.current)

    # ------------------------------------------------------------------ beliefs

    def hear(self, observation: Observation, belief: Belief) -> None:
        """Ask the boundaries whether what is believed has changed, and part the area there."""
        assert self.judge is not None
        probabilities = self.judge.single(belief.scores.values[0])
        behind = self.boundaries.believe(observation, probabilities)
        if behind is not None:
            self.changed = self.odometer.way - behind
            part_at_change(self)

    def accumulate(self, viewpoint: Key, belief: Belief) -> None:
        """Add a belief to the node and the area, and judge the area."""
        values = belief.scores.values[0]
        self.of_node.add(viewpoint, values)
        self.of_area.add(viewpoint, values)
        if self.judge_area() and self.current is not None:
            self.news.add(self.current)

    def judge_area(self) -> bool:
        """Judge the current area by all that was seen in it; tell whether its label changed."""
        sums = self.entry + self.of_area.sums()
        if self.current is None or self.judge is None or sums.bins <= 0:
            return False
        return self.current.judge(sums, self.judge)
