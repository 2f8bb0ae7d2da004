"""EfficientNet-Lite: a small network trained on ImageNet, as a cue."""

from __future__ import annotations

from placecue.checks import check_choice

from .deep import DeepCue
from .networks.packages import PACKAGES, network_of, weights_of
from .networks.preparation import Preparation

OUTPUTS = ("embedding", "logits")
#: What pixels are divided by after 127 is taken off.
MEAN, STD = 127.0, 128.0


class EfficientNetLite(DeepCue):
    """Outputs of EfficientNet-Lite, trained on ImageNet's 1,000 objects; float64 of shape (d,).

    The whole image is resized to the network's square. Weights are those of a package that is
    installed (``placecue[deep]`` brings lite0's); nothing is downloaded.

    Parameters
    ----------
    network : {"lite0", "lite1", "lite2"}
        The larger ones take more time: about 15, 22 and 29 ms on a core.
    output : {"embedding", "logits"}
        The 1,280 averages before the last layer, or the scores of 1,000 objects.
    threads : int
        How many cores an image is computed on.

    References
    ----------
    Tan and Le, EfficientNet: rethinking model scaling for convolutional neural networks, ICML 2019.
    """

    def __init__(self, network: str = "lite0", output: str = "embedding", threads: int = 1) -> None:
        self.network = network
        self.output = output
        self.threads = threads

    def check_parameters(self) -> None:  # noqa: D102
        super().check_parameters()
        check_choice("network", self.network, tuple(PACKAGES))
        check_choice("output", self.output, OUTPUTS)

    def loaded(self) -> tuple[str, bytes, Preparation]:  # noqa: D102
        preparation = Preparation(output=self.output, mean=MEAN, std=STD)
        return self.name, network_of(self.network), preparation

    def digest(self) -> str:  # noqa: D102
        weights_of(self.network)
        return PACKAGES[self.network].graph

    @property
    def name(self) -> str:
        """What messages call it."""
        return f"cue {self.network}"
