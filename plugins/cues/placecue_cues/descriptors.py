"""Receptive field responses: normalised Gaussian derivatives of an image at several scales."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, sqrt
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices

Plane = NDArray[Any]

_FIRST = np.array([[-0.5, 0.0, 0.5]])
_SECOND = np.array([[1.0, -2.0, 1.0]])
#: What each name correlates the smoothed image with, before the normalisation by scale.
MASKS = {
    "L": np.array([[1.0]]),
    "Lx": _FIRST,
    "Ly": _FIRST.T,
    "Lxx": _SECOND,
    "Lxy": _FIRST.T @ _FIRST,
    "Lyy": _SECOND.T,
}
_PATTERN = re.compile(r"(?P<name>\w+)@(?P<scale>\d+(\.\d+)?)")


@dataclass(frozen=True, slots=True)
class Descriptor:
    """One response at every pixel, such as ``Lxx@4``.

    Parameters
    ----------
    name : {"L", "Lx", "Ly", "Lxx", "Lxy", "Lyy"}
        Which derivative.
    scale : float
        t = sigma**2 of the Gaussian, pixels**2.
    """

    name: str
    scale: float

    @property
    def order(self) -> int:
        """Order of the derivative, 0 for the smoothed image itself."""
        return len(self.name) - 1


@lru_cache
def parse_descriptors(texts: tuple[str, ...]) -> tuple[Descriptor, ...]:
    """Read descriptors such as ``("Lxx@4", "Lxy@64")``.

    Raises
    ------
    UsageError
        If there is none, or one is not NAME@SCALE with a known name and a positive scale.
    """
    if not texts:
        raise UsageError("crfh needs at least one descriptor, such as descriptors=[Lxx@4]")
    return tuple(_parse(text) for text in texts)


def _parse(text: str) -> Descriptor:
    match = _PATTERN.fullmatch(text)
    if match is None or float(match["scale"]) <= 0:
        raise UsageError(
            f"descriptor '{text}' is not NAME@SCALE with a scale above 0, such as Lxx@4"
        )
    if match["name"] not in MASKS:
        raise UsageError(f"unknown descriptor '{text}'; {choices(match['name'], MASKS)}")
    return Descriptor(match["name"], float(match["scale"]))


@lru_cache
def gaussian(scale: float) -> NDArray[np.float64]:
    """Return the sampled Gaussian of variance ``scale``, summing to one, of half width 3 sigma."""
    half = max(ceil(3 * sqrt(scale)), 1)
    taps = np.exp(-(np.arange(-half, half + 1.0) ** 2) / (2 * scale))
    return np.asarray(taps / taps.sum())


def responses(
    plane: Plane, descriptors: Sequence[Descriptor], border: int
) -> Iterator[tuple[Descriptor, Plane]]:
    """Yield the response to each descriptor, in their order; each is gone when the next comes.

    Parameters
    ----------
    plane : ndarray of float32 or float64, shape (H, W)
        The image; it and its smoothed versions count as zero outside.
    descriptors : sequence of Descriptor
        Those of one scale that follow one another share its smoothing.
    border : int
        Pixels to leave out on each side.

    Yields
    ------
    tuple of Descriptor and ndarray, shape (H - 2 * border, W - 2 * border)
        The response, in grey levels: second derivatives times t, first ones times sqrt(t).
    """
    height, width = plane.shape
    inner = np.s_[border : height - border, border : width - border]
    # Large arrays are written again and again: fresh ones cost a third of the time.
    smoothed, response, scale = np.empty_like(plane), np.empty_like(plane), None
    for descriptor in descriptors:
        if descriptor.scale != scale:
            scale, taps = descriptor.scale, gaussian(descriptor.scale)
            cv2.sepFilter2D(plane, -1, taps, taps, smoothed, borderType=cv2.BORDER_CONSTANT)
        mask = MASKS[descriptor.name] * descriptor.scale ** (descriptor.order / 2)
        cv2.filter2D(smoothed, -1, mask, response, borderType=cv2.BORDER_CONSTANT)
        yield descriptor, response[inner]
