"""Which objects are seen: the scores that an image classifier gives them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue import call, clone
from placecue.checks import check_choice
from placecue.cue import Cue
from placecue.errors import UsageError, described
from placecue.observation import Observation, Part

from .deep import DeepCue
from .lite import EfficientNetLite

SCORES = ("logits", "probabilities")
#: Probabilities below it count as this.
_LEAST = 1e-12


class Objects(Cue):
    """The score of each object less the mean of all, float64 of shape (number of objects,).

    For the classifier ``knowledge``, which has the names of the objects, or any other.

    Parameters
    ----------
    network : Cue, optional
        What gives a score to each object: EfficientNet-Lite0 by default, or ``onnx`` with any
        image classifier.
    scores : {"logits", "probabilities"}
        What it gives; of probabilities the logarithm is taken.

    Attributes
    ----------
    network_ : Cue
        The one in use.

    References
    ----------
    Rottmann, Martinez Mozos, Stachniss and Burgard, AAAI 2005: objects seen in the image beside
    the geometry of a laser scan.
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)

    def __init__(self, network: Cue | None = None, scores: str = "logits") -> None:
        self.network = network
        self.scores = scores

    def check_parameters(self) -> None:  # noqa: D102
        check_choice("scores", self.scores, SCORES)
        if self.network is not None and not isinstance(self.network, DeepCue):
            raise UsageError(
                "objects.network must be an image classifier, such as {plugin: onnx, model: FILE}, "
                f"got {described(self.network)}"
            )

        if isinstance(self.network, EfficientNetLite) and self.network.output != "logits":
            raise UsageError(
                f"objects takes scores of objects, and its network gives {self.network.output}: "
                "give {plugin: lite0, output: logits}, or output=logits"
            )

    def prepare(self) -> None:
        """Open the network."""
        if not hasattr(self, "network_"):
            self.check_parameters()
            usual = EfficientNetLite(output="logits")
            self.network_: Cue = usual if self.network is None else clone(self.network)
        call(self.network_, "prepare")

    def extract(self, observation: Observation) -> NDArray[np.float64]:
        """Return the scores of the objects in the observation's image."""
        return np.asarray(self.transform([observation])[0])

    def transform(self, observations: Iterable[Observation]) -> NDArray[np.float64]:
        """Return the scores of the objects in the images of n observations, shape (n, objects)."""
        self.prepare()
        scores = np.asarray(call(self.network_, "transform", list(observations)), np.float64)
        if self.scores == "probabilities":
            scores = np.log(np.maximum(scores, _LEAST))
        return np.asarray(scores - scores.mean(axis=1, keepdims=True))
