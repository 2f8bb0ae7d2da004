"""Probabilistic relaxation over the navigation graph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.checks import check_number
from placecue.distribution import softmax
from placecue_accumulators.boundaries import Given
from placecue_accumulators.by_node import NodeAccumulator
from placecue_accumulators.pairwise import relaxed

Values = NDArray[np.float64]


class Relaxation(NodeAccumulator):
    """Nodes listen to their neighbours, again and again, and become like them.

    Parameters
    ----------
    support : float
        How well a class goes with itself next door, 0 to 1; with each other class as badly,
        shared among them.
    rounds : int
        How often nodes listen.
    boundary : Boundary, or sequence or mapping of Boundary, optional
        Doors, which part areas of one label; none by default.
    bin_x, bin_y, bin_theta, accept_confidence, label_probability, sharpness, independent, doubt, \
    node_spacing, gateway_spacing, prior_bins, temperature
        As of :class:`~placecue_accumulators.spatiotemporal.SpatioTemporal`.

    References
    ----------
    Rosenfeld, Hummel and Zucker, IEEE SMC 6(6), 1976; Stachniss, Grisetti, Martinez Mozos and
    Burgard, Efficiently learning metric and topological maps with autonomous service robots, 2007.
    """

    def __init__(
        self,
        support: float = 0.3,
        rounds: int = 10,
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
        self.support = support
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

    def check_parameters(self) -> None:
        """Raise UsageError if a size is not positive or a share not between 0 and 1."""
        super().check_parameters()
        check_number("support", self.support, least=0, below=1)

    def _probabilities(self, likelihoods: Values, edges: Sequence[tuple[int, int]]) -> Values:
        m = likelihoods.shape[1]
        same = np.eye(m, dtype=bool)
        compatibility = np.where(same, self.support, -self.support / (m - 1))
        return relaxed(softmax(likelihoods), compatibility, edges, self.rounds)
