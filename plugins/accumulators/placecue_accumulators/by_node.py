"""What accumulators share that label the nodes of the graph first, and find areas afterwards."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.checks import check_number, check_whole
from placecue.distribution import softmax
from placecue.errors import UsageError
from placecue.observation import Observation, Pose2D
from placecue.semantic_map import UNKNOWN, Area, Node, SemanticMap
from placecue_accumulators.areas import Way
from placecue_accumulators.boundaries import Boundaries, Given
from placecue_accumulators.doubts import Doubts
from placecue_accumulators.graph import (
    NavigationGraph,
    Place,
    Step,
    neighbours_of,
    on_its_side,
    within_reach,
)
from placecue_accumulators.histogram import BinSums, Key, ViewpointHistogram, bin_of
from placecue_accumulators.judging import Judge, accepts, check_judging, judge_for
from placecue_accumulators.parting import DOOR_HALF_WIDTH
from placecue_accumulators.time_windows import TimeWindows
from placecue_accumulators.way import Odometer, is_pose

Values = NDArray[np.float64]

#: While the robot drives, its node hears of those so many edges away.
REACH = 6
#: A robot that turns round so far behind a door, m, has been in the room there.
LOOKING_IN = 0.5


class NodeAccumulator(Accumulator):
    """Gathers evidence at the nodes of the navigation graph; areas are nodes of one label.

    Parameters are those of :class:`~placecue_accumulators.spatiotemporal.SpatioTemporal`, but for
    ``boundary``: only what is a place of its own, such as a door, ends an area here, and by
    default nothing does. A door is a node, at which nothing is seen.
    """

    boundary: Given
    bin_x: float
    bin_y: float
    bin_theta: float
    accept_confidence: float
    label_probability: float
    sharpness: float | None
    independent: float
    doubt: float
    node_spacing: float
    gateway_spacing: float
    prior_bins: float
    temperature: float

    @abstractmethod
    def _probabilities(self, likelihoods: Values, edges: Sequence[tuple[int, int]]) -> Values:
        """Return the probability of each class at each node, shape (n, M).

        Parameters
        ----------
        likelihoods : ndarray of float64, shape (n, M)
            Log-likelihoods by what was seen at each node.
        edges : sequence of (int, int)
            Pairs of nodes.
        """

    def _alone(self, likelihoods: Values) -> Values:
        """Return the probability of each class at a node without neighbours, shape (M,)."""
        return softmax(likelihoods)

    def _context(self) -> Values:
        """Return what is known of the class where the robot is before anything is seen, (M,)."""
        node = self.graph_.current
        assert node is not None
        near = within_reach(self.graph_.edges, node, REACH)
        row = {each: number for number, each in enumerate(near)}
        edges = [(row[a], row[b]) for a, b in self.graph_.edges if a in row and b in row]
        likelihoods = self._likelihoods(near)
        likelihoods[row[node]] = 0.0
        return np.asarray(self._probabilities(likelihoods, sorted(edges))[row[node]])

    def _stepped(self, step: Step, likelihood: Values) -> None:
        """Take note that the robot leaves a node, and what it has seen there on this visit."""

    def _broken(self) -> None:
        """Take note that the robot is somewhere else, and did not drive there."""

    def reset(self) -> None:
        """Forget everything, as before the first observation.

        Raises
        ------
        UsageError
            If a parameter is out of range, or a boundary no place of its own.
        """
        self.check_parameters()
        self.boundaries_ = Boundaries.of(self.boundary, [])
        for each in self.boundaries_.each:
            if not each.gateway:
                raise UsageError(
                    f"this accumulator takes no boundary {type(each).__name__}, as what is "
                    "believed parts its areas anyway: give doors, or none ([])"
                )
        self.graph_ = NavigationGraph(self.node_spacing, self.gateway_spacing)
        self.here_ = ViewpointHistogram(None)
        self.priors_: dict[int, BinSums] = {}
        self.ways_: dict[int, Way] = {}
        self.times_: dict[int, tuple[int, int]] = {}
        self.frames_: dict[int, str] = {}
        self.odometer_ = Odometer()
        self.judge_: Judge | None = None
        self.doubts_ = Doubts()
        self.windows_ = TimeWindows()
        self.at_: tuple[int, str] | None = None  # the node, and its label
        self.said_: tuple[int, str] | None = None  # the area, and its label
        self.looked_: dict[int, int] = {}  # nodes that were only looked into, and the door
        self.labels_: dict[int, str] = {}  # that were said of nodes; doors have none
        self.context_: Values | None = None  # of the node that the robot is at

    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in the next observation; see :class:`placecue.Accumulator`.

        The update tells the label of the node that the robot is at, by what was seen there and
        nearby so far, and the area by labels said before: when the map is asked for, all nodes
        are labelled anew.
        """
        if not hasattr(self, "graph_"):
            self.reset()
        pose = observation.pose
        if pose is None or not is_pose(pose):
            return self._unplaced(observation, belief)
        self._move(observation, pose)
        self._walk(pose, observation.stamp)
        if belief is None or not accepts(belief, self.accept_confidence):
            return None
        viewpoint = self._viewpoint(pose)
        self._judge_of(belief).strangeness.hear(belief, viewpoint)
        self.here_.add(viewpoint, belief.scores.values[0])
        self.doubts_.count(belief.label)
        return self._news()

    def semantic_map(self) -> SemanticMap:
        """Return the map as it stands after the observations so far."""
        if not hasattr(self, "graph_"):
            self.reset()
        n = len(self.graph_.places)
        if self.judge_ is not None and self.windows_ and not n:
            return self.windows_.semantic_map(self.judge_)
        edges = sorted(self.graph_.edges)
        classes = self.judge_.layout.classes if self.judge_ else ()
        found = self._probabilities(self._likelihoods(), edges) if classes else np.zeros((n, 0))
        found = self.judge_.told(found) if self.judge_ else found
        labels = [self._label(row, classes) for row in found]
        area_of, ways = self._areas(labels, edges), self._ways()
        members: dict[int, list[int]] = {}
        for node, area in enumerate(area_of):
            members.setdefault(area, []).append(node)
        return SemanticMap(
            areas=tuple(
                self._area(i, members[i], labels, found, classes, ways) for i in sorted(members)
            ),
            nodes=tuple(
                Node(
                    number,
                    place.x,
                    place.y,
                    area_of[number],
                    place.gateway,
                    place.heading,
                    {} if place.gateway else _by_class(classes, found[number]),
                )
                for number, place in enumerate(self.graph_.places)
            ),
            edges=tuple(edges),
            classes=classes,
            frame=self.frames_.get(0, "odom"),
        )

    def warnings(self) -> list[str]:
        """Return what a person should know of the map, a line each."""
        if not hasattr(self, "graph_"):
            return []
        strange = self.judge_.strangeness.lines() if self.judge_ else []
        return [*strange, *self.doubts_.lines(self.semantic_map())]

    def evidence(self) -> tuple[Values, list[tuple[int, int]]]:
        """Return what was seen at each node, as neighbours are learned of, and the edges.

        Returns
        -------
        ndarray of float64, shape (n, M)
            Log-likelihood of each class, up to a constant.
        list of (int, int)
            Pairs of nodes.

        Raises
        ------
        UsageError
            If there was no belief yet that counts.
        """
        if getattr(self, "judge_", None) is None:
            raise UsageError("nothing was believed of any place yet")
        return self._likelihoods(), sorted(self.graph_.edges)

    def _unplaced(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in a moment without a pose: of a log without any, areas are windows of time."""
        self.doubts_.unplaced += 1
        if self.graph_.places or belief is None or not accepts(belief, self.accept_confidence):
            return None
        judge = self._judge_of(belief)
        return self.windows_.add(observation.stamp, belief.scores.values[0], judge)

    # ------------------------------------------------------------------ space

    def _move(self, observation: Observation, pose: Pose2D) -> None:
        turn = self.odometer_.follow(pose, observation.stamp)
        if turn != "on":
            self._store(self.graph_.current)
            self.doubts_.broken(turn, pose)
            self._broken()
            if turn == "frame":
                self.graph_.begin_part()
            else:
                self.graph_.leave()
        if self.graph_.current is None:  # so that there is a node before any door
            self._take(self.graph_.visit(pose.x, pose.y), observation.stamp, pose.frame)
        step = self._door(observation) or self.graph_.visit(pose.x, pose.y)
        self._take(step, observation.stamp, pose.frame)

    def _door(self, observation: Observation) -> Step | None:
        """Pass a door that is there, and part edges that turn out to lead through it."""
        crossed = self.boundaries_.update(observation)
        if crossed is None:
            return None
        door = crossed.pose
        step = self.graph_.pass_gateway(door.x, door.y, door.theta)
        if step is not None:
            self.graph_.part_at(step.node, DOOR_HALF_WIDTH)
        return step

    def _take(self, step: Step | None, stamp: int, frame: str) -> None:
        if step is None:
            return
        self.context_ = None
        self._look_into(step)
        self.looked_.pop(step.node, None)
        self.times_.setdefault(step.node, (stamp, stamp))
        self.frames_.setdefault(step.node, frame)
        seen = self._store(step.before)
        if seen is not None:
            self._stepped(step, seen)

    def _look_into(self, step: Step) -> None:
        """Make a node of what was seen behind a door that the robot leaves as it came."""
        at = step.before
        if at is None or not self.graph_.places[at].gateway or self.judge_ is None:
            return
        door, to = self.graph_.places[at], self.graph_.places[step.node]
        side = -1 if door.depth(to) > 0 else 1  # that the robot does not go on to
        depth = {key: side * door.depth(self._middle(key)) for key in self.here_}
        inside = [key for key, far in depth.items() if far >= LOOKING_IN]
        if not inside:
            return
        deepest = self._middle(max(inside, key=lambda key: depth[key]))
        made = self.graph_.look_into(at, deepest.x, deepest.y)
        if made is not None:
            self.looked_[made] = at
            self.priors_[made] = self.here_.part(inside)
            self.times_[made], self.frames_[made] = self.times_[at], self.frames_[at]
            self._stepped(Step(at, made, new=False), self.judge_.likelihoods(self.priors_[made]))

    def _middle(self, key: Key) -> Place:
        """Return where a viewpoint is."""
        return Place(key[0] * self.bin_x, key[1] * self.bin_y)

    def _store(self, node: int | None) -> Values | None:
        """Add what was seen at a node to what is stored there; return it alone."""
        sums = self.here_.sums()
        self.here_.clear()
        if node is None:
            return None
        if self.graph_.places[node].gateway:
            sums = BinSums()
        if sums.bins > 0:
            before = self.priors_.get(node, BinSums())
            self.priors_[node] = before.limited(self.prior_bins) + sums
        return None if self.judge_ is None else self.judge_.likelihoods(sums)

    def _viewpoint(self, pose: Pose2D) -> Key:
        """Return the bin of a pose; one who turns on the spot holds no more than a full turn."""
        sizes = (self.bin_x, self.bin_y, self.bin_theta)
        x, y, turned = bin_of((pose.x, pose.y, self.odometer_.theta), sizes)
        return x, y, turned % round(2 * pi / self.bin_theta)

    def _walk(self, pose: Pose2D, stamp: int) -> None:
        node = self.graph_.current
        if node is None:
            return
        key = bin_of((pose.x, pose.y), (self.bin_x, self.bin_y))
        self.ways_.setdefault(node, {}).setdefault(key, (pose.x, pose.y))
        first, last = self.times_[node]
        self.times_[node] = min(first, stamp), max(last, stamp)

    # ------------------------------------------------------------------ labels

    def _likelihoods(self, nodes: Iterable[int] | None = None) -> Values:
        """Return what was seen at some nodes, or at all, shape (n, M)."""
        assert self.judge_ is not None
        here, rows = self.graph_.current, []
        for node in range(len(self.graph_.places)) if nodes is None else nodes:
            sums = self.priors_.get(node, BinSums())
            rows.append(self.judge_.likelihoods(sums + self._here() if node == here else sums))
        return np.array(rows).reshape(-1, len(self.judge_.layout.classes))

    def _here(self) -> BinSums:
        """Return what was seen on this visit of a node; at a door nothing is."""
        node = self.graph_.current
        at_door = node is not None and self.graph_.places[node].gateway
        return BinSums() if at_door else self.here_.sums()

    def _label(self, row: Values, classes: Sequence[str]) -> str:
        if not len(row) or row.max() < self.label_probability:
            return UNKNOWN
        return classes[int(row.argmax())]

    def _areas(self, labels: Sequence[str], edges: Sequence[tuple[int, int]]) -> list[int]:
        """Return the area of each node: the smallest of those that hang together without a door.

        A door belongs to the area of its smallest neighbour. What was only looked into is parted by
        a door where another label was seen: else the robot may have stood between furniture.
        """
        doors = [place.gateway for place in self.graph_.places]
        home = list(range(len(labels)))

        def root(node: int) -> int:
            while home[node] != node:
                home[node] = home[home[node]]
                node = home[node]
            return node

        for a, b in edges:
            if labels[a] == labels[b] and not (doors[a] or doors[b]):
                first, second = sorted((root(a), root(b)))
                home[second] = first
        beside = neighbours_of(edges)
        for node, door in self.looked_.items():
            for other in beside[door]:
                if not doors[other] and labels[other] == labels[node]:
                    first, second = sorted((root(node), root(other)))
                    home[second] = first
        found = [root(node) for node in range(len(labels))]
        for a, b in sorted(edges):
            for door, other in ((a, b), (b, a)):
                if doors[door] and found[door] == door and found[other] != door:
                    found[door] = found[other]
        return found

    def _ways(self) -> dict[int, list[tuple[float, float]]]:
        """Return the positions at each node; those at a door go to the nodes on their side."""
        places = self.graph_.places
        ways = {
            node: list(way.values()) for node, way in self.ways_.items() if not places[node].gateway
        }
        beside = neighbours_of(self.graph_.edges)
        for door, way in self.ways_.items():
            if places[door].gateway:
                for at in way.values():
                    ways.setdefault(on_its_side(at, door, beside[door], places), []).append(at)
        return ways

    def _area(
        self,
        number: int,
        nodes: Sequence[int],
        labels: Sequence[str],
        found: Values,
        classes: Sequence[str],
        ways: Mapping[int, list[tuple[float, float]]],
    ) -> Area:
        rooms = [node for node in nodes if not self.graph_.places[node].gateway]
        by_class = _by_class(classes, found[rooms].mean(axis=0)) if rooms else {}
        label = labels[rooms[0]] if rooms else UNKNOWN
        times = [self.times_[node] for node in nodes]
        return Area(
            id=number,
            label=label,
            confidence=by_class.get(label, 0.0),
            probabilities=by_class,
            start=min(first for first, _ in times),
            end=max(last for _, last in times),
            frame=self.frames_[number],
            trajectory=tuple(at for node in nodes for at in ways.get(node, ())),
        )

    def _news(self) -> AreaUpdate | None:
        node, judge = self.graph_.current, self.judge_
        if node is None or judge is None:
            return None
        if self.context_ is None:
            self.context_ = self._context()
        sums = self.priors_.get(node, BinSums()) + self.here_.sums()  # behind a door too
        found = self.context_ * self._alone(judge.likelihoods(sums))
        found = judge.told(found / found.sum())
        label = self._label(found, judge.layout.classes)
        if self.at_ == (node, label):
            return None
        self.at_ = node, label
        area = self._area_of(node, label)
        if self.said_ == (area, label):
            return None
        self.said_ = area, label
        return AreaUpdate(area, label, float(found.max()) if label != UNKNOWN else 0.0)

    def _area_of(self, node: int, label: str) -> int:
        """Return the area that a node is in, by the labels that were said; a door's is the last."""
        if self.graph_.places[node].gateway:
            return node if self.said_ is None else self.said_[0]
        self.labels_[node] = label
        beside, found, outer = neighbours_of(self.graph_.edges), {node}, {node}
        while outer:
            reached = {other for each in outer for other in beside[each]} - found
            outer = {other for other in reached if self.labels_.get(other) == label}
            found |= outer
        return min(found)

    def _judge_of(self, belief: Belief) -> Judge:
        self.judge_ = judge_for(self, belief, 0.0)
        return self.judge_

    def check_parameters(self) -> None:
        """Raise UsageError if a size is not positive or a share not between 0 and 1."""
        for name in ("bin_x", "bin_y", "bin_theta", "node_spacing", "prior_bins"):
            check_number(name, getattr(self, name), above=0)
        check_number("gateway_spacing", self.gateway_spacing, least=0)
        check_judging(self)
        for name in ("rounds", "lag"):
            if hasattr(self, name):
                check_whole(name, getattr(self, name), least=1)


def _by_class(classes: Sequence[str], row: Values) -> dict[str, float]:
    return dict(zip(classes, row.tolist(), strict=True))
