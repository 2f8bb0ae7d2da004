"""Cues that are outputs of an image network."""

from __future__ import annotations

import hashlib
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.checks import check_whole
from placecue.cue import Cue
from placecue.errors import DataError, UsageError
from placecue.observation import Observation, Part

from .images import checked, eight_bit
from .networks.preparation import Preparation, read_sidecar
from .networks.session import Session


class DeepCue(Cue):
    """One output of an image network for each image, float64 of shape (d,).

    The network is opened when it is first needed. A subclass says which it is.

    Attributes
    ----------
    digest_ : str
        SHA-256 of the network's files. A model keeps it, and refuses a network of another one.
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)
    threads: int
    digest_: str

    @abstractmethod
    def loaded(self) -> tuple[str, bytes, Preparation]:
        """Return what messages call the network, its ONNX file, and how it is used."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What messages call the cue."""

    @abstractmethod
    def digest(self) -> str:
        """Return the SHA-256 of the network's files."""

    def check_parameters(self) -> None:  # noqa: D102
        check_whole("threads", self.threads, least=1)

    def prepare(self) -> None:
        """Note which network this is.

        Raises
        ------
        DataError
            If it is not the one that the model was trained with.
        """
        if hasattr(self, "_known"):
            return
        self.check_parameters()
        found = self.digest()
        if getattr(self, "digest_", found) != found:
            raise DataError(
                f"{self.name} is another network (SHA-256 {found[:12]}...) than the one that the "
                f"model was trained with ({self.digest_[:12]}...): put that one there, or train "
                "the model again"
            )
        self.digest_ = found
        self._known = True

    def extract(self, observation: Observation) -> NDArray[np.float64]:
        """Return the output for the observation's image, shape (d,).

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or the output is not finite.
        UsageError, DataError
            If there is no such network, or it cannot be used like this.
        """
        return np.asarray(self.transform([observation])[0])

    def transform(self, observations: Iterable[Observation]) -> NDArray[np.float64]:
        """Return the outputs for the images of n observations, shape (n, d)."""
        session, preparation = self._opened()
        channels = preparation.channels_of(session)
        images = [
            preparation.image(eight_bit(checked(each, self.name)), channels)
            for each in observations
        ]
        assert preparation.output is not None
        return preparation.vectors(session.run(np.stack(images), preparation.output))

    def _opened(self) -> tuple[Session, Preparation]:
        """Return the network, ready to run."""
        if not hasattr(self, "_session"):
            self.prepare()
            name, model, preparation = self.loaded()
            session = Session(name, model, self.threads)
            self._session = session, preparation.fitted_to(session)
        return self._session

    def __getstate__(self) -> dict[str, Any]:
        """Return the state without the open network, which no other process could use."""
        gone = ("_session", "_known")
        return {name: v for name, v in super().__getstate__().items() if name not in gone}


class OnnxNetwork(DeepCue):
    """An output of any ONNX image network, float64 of shape (d,).

    What is not given is taken from a YAML file beside the network, ``NAME.yaml`` of ``NAME.onnx``,
    which sets parameters by these names, else as is usual for networks trained on ImageNet.

    Parameters
    ----------
    model : str
        The ONNX file.
    output, size, framing, mean, std, colors, layout, pool, normalise : optional
        See :class:`placecue_cues.networks.preparation.Preparation`.
    threads : int
        How many cores an image is computed on.
    """

    def __init__(
        self,
        model: str | None = None,
        output: str | None = None,
        size: Any = None,
        framing: str | None = None,
        mean: Any = None,
        std: Any = None,
        colors: str | None = None,
        layout: str | None = None,
        pool: str | None = None,
        normalise: str | None = None,
        threads: int = 1,
    ) -> None:
        self.model = model
        self.output = output
        self.size = size
        self.framing = framing
        self.mean = mean
        self.std = std
        self.colors = colors
        self.layout = layout
        self.pool = pool
        self.normalise = normalise
        self.threads = threads

    def check_parameters(self) -> None:  # noqa: D102
        super().check_parameters()
        if not isinstance(self.model, str) or not self.model:
            raise UsageError(f"model is {self.model!r}; give an ONNX file, cues.onnx.model=FILE")

    def loaded(self) -> tuple[str, bytes, Preparation]:  # noqa: D102
        self.check_parameters()
        given = {each.name: getattr(self, each.name) for each in fields(Preparation)}
        beside = self._path.with_suffix(".yaml")
        preparation = Preparation.of(given, read_sidecar(beside), str(beside))
        return self.name, _read(self._path), preparation

    def digest(self) -> str:  # noqa: D102
        made, beside = hashlib.sha256(_read(self._path)), self._path.with_suffix(".yaml")
        if beside.is_file():
            made.update(_read(beside))
        return made.hexdigest()

    @property
    def _path(self) -> Path:
        return Path(str(self.model)).expanduser()

    @property
    def name(self) -> str:
        """What messages call it."""
        return f"cue onnx ({self.model})"


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        reason = error.strerror or error
        raise UsageError(f"the network {path} cannot be read: {reason}; give model=FILE") from error
