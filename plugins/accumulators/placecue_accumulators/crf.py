"""A conditional random field over the navigation graph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.distribution import softmax
from placecue_accumulators.boundaries import Given
from placecue_accumulators.by_node import NodeAccumulator
from placecue_accumulators.neighbours import Neighbours
from placecue_accumulators.pairwise import belief_propagation

Values = NDArray[np.float64]


class RandomField(NodeAccumulator):
    """Labels of nodes depend on what is seen there, and on those of their neighbours.

    Marginals are exact where the graph is a tree, and by loopy belief propagation otherwise.

    Parameters
    ----------
    same : float
        Logarithm of how much likelier two neighbours are of one class than of two given ones.
    weights : str or None
        File of learned weights instead (:func:`~placecue_accumulators.neighbours.learned_field`).
    rounds : int
        At most so many rounds of belief propagation, beyond the number of nodes.
    boundary : Boundary, or sequence or mapping of Boundary, optional
        Doors, which part areas of one label; none by default.
    bin_x, bin_y, bin_theta, accept_confidence, label_probability, sharpness, independent, doubt, \
    node_spacing, gateway_spacing, prior_bins, temperature
        As of :class:`~placecue_accumulators.spatiotemporal.SpatioTemporal`.

    References
    ----------
    Lafferty, McCallum and Pereira, Conditional random fields, ICML 2001; named in Pronobis et al.,
    IJRR 2010, section 5, as a more advanced way.
    """

    def __init__(
        self,
        same: float = 2.0,
        weights: str | None = None,
        rounds: int = 200,
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
        self.same = same
        self.weights = weights
        self.rounds = rounds
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

    def reset(self) -> None:
        """Forget everything, as before the first observation."""
        super().reset()
        self.field_: Neighbours | None = None

    def _alone(self, likelihoods: Values) -> Values:
        return softmax(self._known().seen * likelihoods)

    def _probabilities(self, likelihoods: Values, edges: Sequence[tuple[int, int]]) -> Values:
        known = self._known()
        return belief_propagation(known.seen * likelihoods, known.weights, edges, self.rounds)

    def _known(self) -> Neighbours:
        assert self.judge_ is not None
        classes = self.judge_.layout.classes
        if self.field_ is None and self.weights is not None:
            self.field_ = Neighbours.read(self.weights, classes)
        elif self.field_ is None:
            self.field_ = Neighbours(classes, self.same * np.eye(len(classes)))
        return self.field_
