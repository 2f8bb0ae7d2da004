"""Histograms of the image's colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.cue import Cue
from placecue.errors import UnusableObservation, UsageError
from placecue.observation import Observation, Part

from .images import checked, eight_bit


class ColorHistogram(Cue):
    """Joint histogram of CIE L*a*b* over the pixels, CSR of shape (1, L bins * a bins * b bins).

    Sums to one. The bin of a pixel is (l * a_bins + a) * b_bins + b. A grey image has a* = b* = 0
    throughout.

    Parameters
    ----------
    bins : sequence of 3 int
        Bins of L*, a* and b*.
    chroma_limit : float
        a* and b* are binned over plus and minus this; what lies outside counts in the end bins.
        L* is binned over [0, 100].

    References
    ----------
    Swain and Ballard, Color indexing, IJCV 7(1), 1991. CIE L*a*b* under D65, as OpenCV has it.
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)

    def __init__(self, bins: Sequence[int] = (8, 12, 12), chroma_limit: float = 48.0) -> None:
        self.bins = bins
        self.chroma_limit = chroma_limit

    def extract(self, observation: Observation) -> sparse.csr_array:
        """Return the histogram of the observation's image.

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or has no pixels.
        UsageError
            If a parameter cannot be.
        """
        if len(self.bins) != 3 or min(self.bins) < 1 or not self.chroma_limit > 0:
            raise UsageError(
                "color_histogram needs three numbers of bins >= 1 and chroma_limit > 0, got "
                f"{list(self.bins)} and {self.chroma_limit}"
            )
        lab = _lab(observation)
        limit = self.chroma_limit
        lows, widths = np.array([0, -limit, -limit]), np.array([100, 2 * limit, 2 * limit])
        keys = np.zeros(lab.shape[1], dtype=np.int64)
        for values, low, width, bins in zip(lab, lows, widths, self.bins, strict=True):
            inner = np.clip((values - low) * (bins / width), 0, bins - 1)
            keys = keys * bins + inner.astype(np.int64)
        total = int(np.prod(self.bins))
        counts = np.bincount(keys, minlength=total)
        return sparse.csr_array((counts / keys.size)[None])


def _lab(observation: Observation) -> NDArray[np.float32]:
    """Return L*, a* and b* of every pixel, shape (3, pixels)."""
    image = eight_bit(checked(observation, "color_histogram"))
    if image.size == 0:
        raise UnusableObservation(f"color_histogram got an image without pixels, {image.shape}")
    colours = image if image.ndim == 3 else np.repeat(image[:, :, None], 3, axis=2)
    lab = cv2.cvtColor(colours.astype(np.float32) / 255, cv2.COLOR_RGB2Lab)
    return np.asarray(lab.reshape(-1, 3).T)
