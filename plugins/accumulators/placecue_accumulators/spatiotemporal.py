"""Beliefs gathered over time and space into labelled areas."""

from __future__ import annotations

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.checks import check_choice, check_number, check_whole
from placecue.observation import Observation
from placecue.semantic_map import Node, SemanticMap
from placecue_accumulators.areas import Areas
from placecue_accumulators.boundaries import Boundaries, Given
from placecue_accumulators.door import Door
from placecue_accumulators.doubts import Doubts
from placecue_accumulators.graph import NavigationGraph
from placecue_accumulators.journey import Journey
from placecue_accumulators.judging import Judge, accepts, check_judging, judge_for
from placecue_accumulators.same_label import MERGES, Merge, merge_same_label
from placecue_accumulators.time_windows import TimeWindows
from placecue_accumulators.way import is_pose

#: Where one area swallows the drive though beliefs disagree.
ADVICE = "compare accumulator=crf, which labels node by node and needs no boundary"


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
    temperature : float
        Log odds of a place are divided by this before they are told, and by how much less than in
        training the model's cues agree (:mod:`~placecue_accumulators.strangeness`).
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
        independent: float = 0.03,
        doubt: float = 0.005,
        forget_after: int | None = 30,
        node_spacing: float = 1.0,
        gateway_spacing: float = 2.0,
        prior_bins: float = 20.0,
        temperature: float = 1.0,
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
        self.temperature = temperature
        self.merge = merge

    def reset(self) -> None:
        """Forget everything, as before the first observation.

        Raises
        ------
        UsageError
            If a size or spacing is not positive, or a number of bins is negative.
        """
        self.check_parameters()
        self.journey_ = Journey(
            Boundaries.of(self.boundary, [Door()]),
            NavigationGraph(self.node_spacing, self.gateway_spacing),
            Areas(self.prior_bins),
            (self.bin_x, self.bin_y, self.bin_theta),
            self.forget_after,
        )
        self.judge_: Judge | None = None
        self.doubts_ = Doubts(ADVICE)
        self.windows_ = TimeWindows()

    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in the next observation; see :class:`placecue.Accumulator`.

        Where one observation leads out of one area and into another, the second update is given
        with the next observation.

        Raises
        ------
        UsageError
            If the belief's scores have another layout than those before.
        """
        if not hasattr(self, "journey_"):
            self.reset()
        pose, journey = observation.pose, self.journey_
        if pose is None or not is_pose(pose):
            return self._unplaced(observation, belief)
        turn = journey.move(pose, observation.stamp)  # drive on, or begin somewhere else
        if turn != "on":
            self.doubts_.broken(turn, pose)
        journey.follow(observation, pose)  # cross boundaries, reach nodes and areas
        viewpoint = journey.visit(pose, observation.stamp)  # be somewhere
        if belief is not None and accepts(belief, self.accept_confidence):
            journey.judge = self._judge_of(belief)
            journey.judge.strangeness.hear(belief, viewpoint)
            journey.hear(observation, belief)  # end the area where beliefs have changed
            journey.accumulate(viewpoint, belief)  # add to the node and the area, and judge
            self.doubts_.count(belief.label)
        return journey.news.next()

    def semantic_map(self) -> SemanticMap:
        """Return the map as it stands after the observations so far."""
        if not hasattr(self, "journey_"):
            self.reset()
        graph, areas = self.journey_.graph, self.journey_.areas
        if self.judge_ is not None and self.windows_ and not graph.places:
            return self.windows_.semantic_map(self.judge_)
        made = SemanticMap(
            areas=areas.to_areas(),
            nodes=tuple(
                Node(
                    number,
                    place.x,
                    place.y,
                    areas.area_of[number],
                    place.gateway,
                    place.heading,
                    self._probabilities(number),
                )
                for number, place in enumerate(graph.places)
            ),
            edges=tuple(sorted(graph.edges)),
            classes=self.judge_.layout.classes if self.judge_ else (),
            frame=self.journey_.frame or "odom",
        )
        return merge_same_label(made, self.merge)

    def warnings(self) -> list[str]:
        """Return what a person should know of the map, a line each."""
        if not hasattr(self, "journey_"):
            return []
        strange = self.judge_.strangeness.lines() if self.judge_ else []
        return [*strange, *self.doubts_.lines(self.semantic_map())]

    def _unplaced(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in a moment without a pose: of a log without any, areas are windows of time."""
        self.doubts_.unplaced += 1
        placed = bool(self.journey_.graph.places)
        if placed or belief is None or not accepts(belief, self.accept_confidence):
            return None
        self.doubts_.count(belief.label)
        judge = self._judge_of(belief)
        return self.windows_.add(observation.stamp, belief.scores.values[0], judge)

    def _probabilities(self, node: int) -> dict[str, float]:
        prior = self.journey_.areas.priors.get(node)
        if self.judge_ is None or prior is None or prior.bins <= 0:
            return {}
        found = self.judge_.probabilities(prior).tolist()
        return dict(zip(self.judge_.layout.classes, found, strict=True))

    def _judge_of(self, belief: Belief) -> Judge:
        """Return the judge of beliefs; the first tells what their scores are."""
        self.judge_ = judge_for(self, belief, self.label_confidence)
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
