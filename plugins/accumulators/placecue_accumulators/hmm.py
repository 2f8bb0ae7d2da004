"""A hidden Markov model over the places that the robot passes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from placecue.checks import check_number
from placecue_accumulators.boundaries import Given
from placecue_accumulators.by_node import NodeAccumulator
from placecue_accumulators.graph import Step
from placecue_accumulators.hidden_markov import forward, smoothed, staying, viterbi
from placecue_accumulators.neighbours import Neighbours

Values = NDArray[np.float64]

#: Of each node: how often the likeliest sequence gave it each class, and summed probabilities.
Settled = dict[int, tuple[Values, Values]]

#: No transition is less probable than this.
SMALLEST = 1e-9


class HiddenMarkov(NodeAccumulator):
    """Places follow one another along the drive: the likeliest sequence labels the nodes.

    One step of the model is a visit to a node of the navigation graph. While the robot drives the
    forward algorithm tells where it is (:meth:`filtered`); the map has the Viterbi sequence, and
    probabilities by forward and backward. A node that was visited several times has the mean of
    its visits, and the class that most of them have. Visits more than ``lag`` ago are settled, so
    that memory does not grow with time.

    Parameters
    ----------
    lasts : float
        Mean way within a place, m; it is left for each other with equal probability.
    transitions : str or None
        File of learned transitions instead, one row a class
        (:class:`~placecue_accumulators.neighbours.Neighbours`).
    lag : int
        How many visits are kept open.
    boundary : Boundary, or sequence or mapping of Boundary, optional
        Doors, which part areas of one label; none by default.
    bin_x, bin_y, bin_theta, accept_confidence, label_probability, sharpness, independent, doubt, \
    node_spacing, gateway_spacing, prior_bins, temperature
        As of :class:`~placecue_accumulators.spatiotemporal.SpatioTemporal`.

    References
    ----------
    Rottmann, Martinez Mozos, Stachniss and Burgard, Semantic place classification of indoor
    environments with mobile robots using boosting, AAAI 2005.
    """

    def __init__(
        self,
        lasts: float = 16.0,
        transitions: str | None = None,
        lag: int = 500,
        boundary: Given = None,
        bin_x: float = 0.2,
        bin_y: float = 0.2,
        bin_theta: float = 0.1,
        accept_confidence: float = 0.1,
        label_probability: float = 0.5,
        sharpness: float | None = None,
        independent: float = 0.03,
        doubt: float = 0.005,
        node_spacing: float = 1.0,
        gateway_spacing: float = 1.0,
        prior_bins: float = 20.0,
        temperature: float = 1.0,
    ) -> None:
        self.lasts = lasts
        self.transitions = transitions
        self.lag = lag
        self.boundary = boundary
        self.bin_x = bin_x
        self.bin_y = bin_y
        self.bin_theta = bin_theta
        self.accept_confidence = accept_confidence
        self.label_probability = label_probability
        self.sharpness = sharpness
        self.independent = independent
        self.doubt = doubt
        self.node_spacing = node_spacing
        self.gateway_spacing = gateway_spacing
        self.prior_bins = prior_bins
        self.temperature = temperature

    def check_parameters(self) -> None:
        """Raise UsageError if a length is not positive or a share not between 0 and 1."""
        super().check_parameters()
        check_number("lasts", self.lasts, above=0)

    def reset(self) -> None:
        """Forget everything, as before the first observation."""
        super().reset()
        self.visits_: list[tuple[int, Values]] = []  # the open ones: node, log-likelihoods
        self.settled_: Settled = {}
        self.steps_: Values | None = None

    def filtered(self) -> Values:
        """Return the probability of each class where the robot is, by all up to now, shape (M,)."""
        rows = np.array([row for _, row in self._open()])
        return np.asarray(np.exp(forward(rows, self._steps())[-1]))

    def _context(self) -> Values:
        m = len(self._steps())
        if not self.visits_:
            return np.full(m, 1 / m)
        before = forward(np.array([row for _, row in self.visits_]), self._steps())[-1]
        return np.asarray(np.exp(logsumexp(before[:, None] + self._steps(), axis=0)))

    def _stepped(self, step: Step, likelihood: Values) -> None:
        if step.before is not None:
            self.visits_.append((step.before, likelihood))
        if len(self.visits_) > self.lag:
            half = self.lag // 2 + 1
            self._settle(self.settled_, self.visits_, half)
            self.visits_ = self.visits_[half:]

    def _broken(self) -> None:
        self._settle(self.settled_, self.visits_, len(self.visits_))
        self.visits_ = []

    def _open(self) -> list[tuple[int, Values]]:
        """Return the open visits, with the one that is going on."""
        node, judge = self.graph_.current, self.judge_
        if node is None or judge is None:
            return list(self.visits_)
        return [*self.visits_, (node, judge.likelihoods(self._here()))]

    def _settle(
        self,
        settled: dict[int, tuple[Values, Values]],
        visits: Sequence[tuple[int, Values]],
        n: int,
    ) -> None:
        """Add the first n of some visits to what is settled of their nodes."""
        if not visits or self.judge_ is None:
            return
        rows = np.array([row for _, row in visits])
        path, shares = viterbi(rows, self._steps()), smoothed(rows, self._steps())
        for (node, _), label, share in list(zip(visits, path, shares, strict=True))[:n]:
            votes, total = settled.get(node, (np.zeros(len(share)), np.zeros(len(share))))
            settled[node] = votes + np.eye(len(share))[label], total + share

    def _steps(self) -> Values:
        """Return the logarithm of the transitions, shape (M, M)."""
        assert self.judge_ is not None
        classes = self.judge_.layout.classes
        if self.steps_ is None and self.transitions is not None:
            learned = Neighbours.read(self.transitions, classes).weights
            self.steps_ = np.log(np.maximum(learned, SMALLEST))
        elif self.steps_ is None:
            self.steps_ = staying(len(classes), self.node_spacing, self.lasts)
        return self.steps_

    def _probabilities(self, likelihoods: Values, edges: Sequence[tuple[int, int]]) -> Values:
        """Return the mean over the visits of each node; its Viterbi label is the largest."""
        settled = dict(self.settled_)
        visits = self._open()
        self._settle(settled, visits, len(visits))
        found = np.full(likelihoods.shape, 1 / likelihoods.shape[1])
        for node, (votes, total) in settled.items():
            share = total / total.sum()
            best, most = int(votes.argmax()), int(share.argmax())
            share[[best, most]] = share[[most, best]]  # rarely another; then hardly less probable
            found[node] = share
        return found
