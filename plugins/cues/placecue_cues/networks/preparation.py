"""What is done to an image before a network sees it, and to what the network says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import cv2
import numpy as np
import yaml
from numpy.typing import NDArray

from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import DataError, UnusableObservation, UsageError, choices, described

from .session import Session

#: Of ImageNet's pixels, 0 to 255: red, green, blue.
IMAGENET_MEAN, IMAGENET_STD = (123.675, 116.28, 103.53), (58.395, 57.12, 57.375)
FRAMINGS = ("stretch", "crop", "pad")
LAYOUTS = ("nchw", "nhwc")
COLORS = ("rgb", "bgr")
POOLS = ("mean", "max", "none")
NORMALISATIONS = ("none", "unit", "softmax")


@dataclass(frozen=True)
class Preparation:
    """How a network is to be used.

    Parameters
    ----------
    output : str or None
        The name of the output that is taken; None for the only one.
    size : int, pair of int or None
        Side, or height and width, of the picture that goes in, pixels; None: as the network says.
    framing : {"stretch", "crop", "pad"}
        How an image of another aspect is made to fit: stretched, its middle cut out, or with grey
        (the mean) around it.
    mean, std : float, triple of float or None
        Pixels, 0 to 255, become (pixel - mean) / std, a number for each channel. None: those usual
        for ImageNet; of a network that takes bytes 0 and 1, and no others.
    colors : {"rgb", "bgr"}
        Order of the channels.
    layout : {"nchw", "nhwc"}
        Whether channels come before the rows or after the columns.
    pool : {"mean", "max", "none"}
        What becomes of a map of features, one value a channel or all of them.
    normalise : {"none", "unit", "softmax"}
        What becomes of the vector.
    """

    output: str | None = None
    size: int | tuple[int, int] | None = None
    framing: str = "stretch"
    mean: float | tuple[float, ...] | None = None
    std: float | tuple[float, ...] | None = None
    colors: str = "rgb"
    layout: str = "nchw"
    pool: str = "mean"
    normalise: str = "none"

    @classmethod
    def of(cls, given: Mapping[str, Any], sidecar: Mapping[str, Any], where: str) -> Self:
        """Return what was given, else what a sidecar says, else the usual.

        Raises
        ------
        UsageError
            If a value cannot be, or the sidecar names what is none of the parameters.
        """
        names = [each.name for each in fields(cls)]
        for name in sidecar:
            if name not in names:
                raise UsageError(f"{where} sets '{name}'; {choices(str(name), names)}")
        own = {name: value for name, value in given.items() if value is not None}
        made: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in {**sidecar, **own}.items()
        }
        preparation = cls(**made)
        preparation.check()
        return preparation

    def check(self) -> None:
        """Raise UsageError if a value cannot be."""
        for name, allowed in _WORDS.items():
            check_choice(name, getattr(self, name), allowed)
        if self.size is not None:
            for side in self.size if isinstance(self.size, tuple) else (self.size,):
                check_whole("size", side, least=1)
            if isinstance(self.size, tuple) and len(self.size) != 2:
                raise UsageError(f"size is {self.size!r}; give a side, or height and width")
        for name in ("mean", "std"):
            value = getattr(self, name)
            for each in value if isinstance(value, tuple) else (value,):
                if value is None:
                    continue
                check_number(name, each, above=0 if name == "std" else None)
            if isinstance(value, tuple) and len(value) != 3:
                raise UsageError(f"{name} is {value!r}; give one number, or one for each channel")

    def fitted_to(self, session: Session) -> Self:
        """Return a copy with the size and output that a network has.

        Raises
        ------
        UsageError
            If they are not those of the network, or it leaves its size open and none is given.
        """
        channels, *sides = self._axes(session)
        if channels not in (3, 1) and isinstance(channels, int):
            raise UsageError(
                f"{session.name} takes shape {session.shape}, and layout={self.layout} looks for 3 "
                f"channels where it has {channels}: choose another layout ({', '.join(LAYOUTS)})"
            )
        wanted = self.size if self.size is not None else tuple(sides)
        height, width = wanted if isinstance(wanted, tuple) else (wanted, wanted)
        for asked, has in zip((height, width), sides, strict=True):
            if isinstance(has, int) and asked != has:
                raise UsageError(
                    f"{session.name} takes images of {sides[1]}x{sides[0]} pixels, and size says "
                    f"{width}x{height}: leave size out"
                )
        if not (isinstance(height, int) and isinstance(width, int)):
            raise UsageError(
                f"{session.name} leaves open how large images are: give size, such as size=224"
            )
        settled = {each.name: getattr(self, each.name) for each in fields(self)}
        settled |= {"size": (height, width), "output": session.output_named(self.output)}
        settled |= self._scaled_for(session)
        return type(self)(**settled)

    def _scaled_for(self, session: Session) -> dict[str, Any]:
        """Return the mean and std of pixels that a network takes."""
        raw = session.takes_bytes
        usual = {"mean": 0.0, "std": 1.0} if raw else {"mean": IMAGENET_MEAN, "std": IMAGENET_STD}
        made = {name: usual[name] if (v := getattr(self, name)) is None else v for name in usual}
        if raw and any(np.any(np.asarray(made[name]) != usual[name]) for name in usual):
            raise UsageError(
                f"{session.name} takes pixels as bytes, 0 to 255, and mean={made['mean']}, "
                f"std={made['std']} make other numbers of them: leave both out"
            )
        return made

    def image(self, image: NDArray[np.uint8], channels: int = 3) -> NDArray[np.float32]:
        """Return what the network is given of one image, RGB or grey, without the first axis."""
        assert isinstance(self.size, tuple)
        if 0 in image.shape:
            raise UnusableObservation(f"an image without pixels, {image.shape}")
        if channels == 1 and image.ndim == 3:
            image = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), dtype=np.uint8)
        pixels = self._sized(image, *self.size).astype(np.float32)
        if pixels.ndim == 2:
            pixels = np.repeat(pixels[:, :, None], channels, axis=2)
        if self.colors == "bgr":
            pixels = pixels[:, :, ::-1]
        mean, std = (np.asarray(each, np.float32) for each in (self.mean, self.std))
        if channels == 1:
            mean, std = mean.mean(keepdims=True), std.mean(keepdims=True)
        made = (pixels - mean) / std
        return np.ascontiguousarray(made.transpose(2, 0, 1) if self.layout == "nchw" else made)

    def _sized(self, image: NDArray[np.uint8], height: int, width: int) -> NDArray[Any]:
        """Return an image of the network's size, framed as asked."""
        rows, columns = image.shape[:2]
        if self.framing == "crop":
            scale = min(rows / height, columns / width)
            inner = max(round(height * scale), 1), max(round(width * scale), 1)
            top, left = (rows - inner[0]) // 2, (columns - inner[1]) // 2
            image = image[top : top + inner[0], left : left + inner[1]]
        if self.framing != "pad":
            return _resized(image, height, width)
        scale = max(rows / height, columns / width)
        inner = max(round(rows / scale), 1), max(round(columns / scale), 1)
        top, left = (height - inner[0]) // 2, (width - inner[1]) // 2
        grey = np.asarray(self.mean, np.float64).mean().astype(np.uint8)
        made = np.full((height, width, *image.shape[2:]), grey, dtype=np.uint8)
        made[top : top + inner[0], left : left + inner[1]] = _resized(image, *inner)
        return made

    def vectors(self, made: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the vectors, shape (n, d), of an output, shape (n, ...)."""
        if made.ndim > 2 and self.pool != "none":
            # Channels stand first in (n, c, h, w), last in (n, h, w, c) and in (n, tokens, c).
            first = made.ndim == 4 and self.layout == "nchw"
            axes = tuple(range(2, made.ndim)) if first else tuple(range(1, made.ndim - 1))
            made = made.mean(axis=axes) if self.pool == "mean" else made.max(axis=axes)
        made = made.reshape(len(made), -1)
        if self.normalise == "unit":
            lengths = np.linalg.norm(made, axis=1, keepdims=True)
            return np.asarray(made / np.where(lengths > 0, lengths, 1.0))
        if self.normalise == "softmax":
            powers = np.exp(made - made.max(axis=1, keepdims=True))
            return np.asarray(powers / powers.sum(axis=1, keepdims=True))
        return made

    def channels_of(self, session: Session) -> int:
        """Return how many channels a network takes: 3, or 1 where it says so."""
        return 1 if self._axes(session)[0] == 1 else 3

    def _axes(self, session: Session) -> list[Any]:
        """Return the channels, height and width of what a network takes."""
        _, *axes = session.shape
        return axes if self.layout == "nchw" else [axes[2], *axes[:2]]


_WORDS = {
    "framing": FRAMINGS,
    "colors": COLORS,
    "layout": LAYOUTS,
    "pool": POOLS,
    "normalise": NORMALISATIONS,
}


def _resized(image: NDArray[np.uint8], height: int, width: int) -> NDArray[Any]:
    smaller = height * width <= image.shape[0] * image.shape[1]
    how = cv2.INTER_AREA if smaller else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, (width, height), interpolation=how))


def read_sidecar(path: Path) -> dict[str, Any]:
    """Return the parameters that a YAML file beside a network sets; none where there is no file.

    Raises
    ------
    DataError
        If it cannot be read or is no mapping.
    """
    if not path.is_file():
        return {}
    try:
        made = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise DataError(f"{path} cannot be read: {' '.join(str(error).split())}") from error
    if made is None:
        return {}
    if not isinstance(made, dict):
        raise DataError(f"{path} holds {described(made)}, not parameters by name")
    return made
