"""Composed receptive field histograms of the image."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.cue import Cue
from placecue.errors import UnusableObservation, UsageError, choices
from placecue.observation import Observation, Part

from .descriptors import Descriptor, parse_descriptors, responses
from .images import GREY_SCALES, checked

PRECISIONS: dict[str, type[np.floating[Any]]] = {"double": np.float64, "single": np.float32}
CHANNELS = ("mean", "hls")
DEFAULT_DESCRIPTORS = ("Lxx@4", "Lxy@4", "Lyy@4", "Lxx@64", "Lxy@64", "Lyy@64")


class CRFH(Cue):
    """Composed receptive field histogram: the joint histogram of filter responses at every pixel.

    Gives a CSR row of shape (1, bins**n) for n descriptors, float64, summing to one. The bin of a
    pixel is the sum over i of bin_i * bins**i, the first descriptor the least significant. The
    constants are those of the paper's group (its library ROCS).

    Parameters
    ----------
    descriptors : sequence of str
        Responses NAME@SCALE: L, Lx, Ly, Lxx, Lxy or Lyy, and t = sigma**2 in pixels**2.
    bins : int
        Bins of each response.
    derivative_limit : float
        Derivatives are binned over [-derivative_limit, derivative_limit] grey levels, L over
        [0, 255]; what lies outside counts in the end bins.
    border : int
        Pixels left out on each side of the image.
    channel : {"mean", "hls"}
        Grey level of a colour: (R + G + B) / 3, or the 8-bit lightness (max + min) / 2.
        A grey image is taken as it is; one of 16 bits is scaled to [0, 255].
    precision : {"double", "single"}
        Floating-point precision of the filters. Single takes half the time, and moves pixels
        that lie on the edge of a bin (exactly flat regions do) to the next one.
    threshold : float
        Bins that hold less than this share of the pixels are dropped, without renormalising.

    References
    ----------
    Linde and Lindeberg, Object recognition using composed receptive field histograms of higher
    dimensionality, ICPR 2004. Pronobis et al., IJRR 29(2-3), 2010, section 3.1.
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)

    def __init__(
        self,
        descriptors: Sequence[str] = DEFAULT_DESCRIPTORS,
        bins: int = 28,
        derivative_limit: float = 128.0,
        border: int = 15,
        channel: str = "mean",
        precision: str = "double",
        threshold: float = 0.0,
    ) -> None:
        self.descriptors = descriptors
        self.bins = bins
        self.derivative_limit = derivative_limit
        self.border = border
        self.channel = channel
        self.precision = precision
        self.threshold = threshold

    def extract(self, observation: Observation) -> sparse.csr_array:
        """Return the histogram of the observation's image, CSR of shape (1, bins**n).

        Raises
        ------
        UnusableObservation
            If the image is no larger than its borders, or not an 8-bit RGB or 8 or 16-bit grey
            one.
        UsageError
            If a parameter cannot be.
        """
        descriptors = self._checked()
        plane = self._plane(checked(observation, "crfh"))
        keys = self._keys(plane, descriptors)
        occupied, counts = _count(keys)
        shares = counts / keys.size
        if self.threshold > 0:
            kept = shares >= self.threshold
            occupied, shares = occupied[kept], shares[kept]
        row = (shares, occupied, np.array([0, shares.size], dtype=occupied.dtype))
        return sparse.csr_array(row, shape=(1, self.bins ** len(descriptors)))

    def _checked(self) -> tuple[Descriptor, ...]:
        """Return the parsed descriptors once every parameter is known to be sensible."""
        descriptors = parse_descriptors(tuple(self.descriptors))
        for name, known in (("channel", CHANNELS), ("precision", tuple(PRECISIONS))):
            if getattr(self, name) not in known:
                value = getattr(self, name)
                raise UsageError(f"unknown crfh {name} '{value}'; {choices(str(value), known)}")
        if self.bins < 1 or self.border < 0 or not self.derivative_limit > 0:
            raise UsageError(
                f"crfh needs bins >= 1, border >= 0 and derivative_limit > 0, got {self.bins}, "
                f"{self.border} and {self.derivative_limit:g}"
            )
        if self.bins ** len(descriptors) > np.iinfo(np.int64).max:
            raise UsageError(
                f"{self.bins} bins of {len(descriptors)} descriptors are more than 64-bit keys "
                "can number: use fewer bins or descriptors"
            )
        return descriptors

    def _plane(self, image: NDArray[Any]) -> NDArray[Any]:
        """Return the grey levels, in the precision asked for, shape (H, W)."""
        height, width = image.shape[:2]
        if min(height, width) <= 2 * self.border:
            raise UnusableObservation(
                f"the image is {width}x{height} pixels, crfh leaves out {self.border} on each "
                "side: use larger images or a smaller border"
            )
        dtype = PRECISIONS[self.precision]
        if image.ndim == 2:
            return np.asarray(image.astype(dtype) / dtype(GREY_SCALES[image.dtype]))
        return _mean(image, dtype) if self.channel == "mean" else _lightness(image, dtype)

    def _keys(self, plane: NDArray[Any], descriptors: tuple[Descriptor, ...]) -> NDArray[Any]:
        """Return the number of the bin that each pixel falls into, shape (pixels,)."""
        largest = self.bins ** len(descriptors) - 1
        dtype: type[Any] = np.int32 if largest <= np.iinfo(np.int32).max else np.int64
        shape = (plane.shape[0] - 2 * self.border, plane.shape[1] - 2 * self.border)
        keys = np.zeros(shape, dtype=dtype)
        for i, (descriptor, response) in enumerate(responses(plane, descriptors, self.border)):
            keys += self._bin(response, descriptor).astype(dtype) * dtype(self.bins**i)
        return keys.ravel()

    def _bin(self, response: NDArray[Any], descriptor: Descriptor) -> NDArray[Any]:
        """Return the bin of each response as a number whose whole part counts."""
        limit = self.derivative_limit
        low, high = (-limit, limit) if descriptor.order else (0.0, 255.0)
        real = response.dtype.type
        response -= real(low)
        response *= real(self.bins / (high - low))
        return np.clip(response, 0, self.bins - 1, out=response)


def _mean(image: NDArray[np.uint8], dtype: type[np.floating[Any]]) -> NDArray[Any]:
    red, green, blue = cv2.split(image)
    total = cv2.add(cv2.add(red, green, dtype=cv2.CV_16U), blue, dtype=cv2.CV_16U)
    return np.divide(total, 3, dtype=dtype)


def _lightness(image: NDArray[np.uint8], dtype: type[np.floating[Any]]) -> NDArray[Any]:
    return cv2.cvtColor(image, cv2.COLOR_RGB2HLS)[:, :, 1].astype(dtype)


def _count(keys: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the keys that occur, sorted, and how often each does."""
    occupied, counts = np.unique(keys, return_counts=True)
    return occupied, counts
