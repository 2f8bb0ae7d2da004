"""The gist of a scene: how much of each orientation and scale is where in the image."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import fft

from placecue.cue import Cue
from placecue.errors import UsageError
from placecue.observation import Observation, Part

from .images import grey

Plane = NDArray[np.float32]


class Gist(Cue):
    """Energies of a bank of Gabor filters over a coarse grid, float32 of shape (d,).

    d is grid**2 times the sum of ``orientations``: by default 16 * 32 = 512. The values come scale
    by scale from fine to coarse, orientation by orientation, then row by row of the grid. Every
    image is resized to a fixed square first, so that any size will do.

    Parameters
    ----------
    orientations : sequence of int
        Number of orientations of each scale, from fine to coarse.
    grid : int
        Cells a side.
    size : int
        Side of the square, pixels.
    prefilter : float
        Cycles an image below which the local mean and contrast are evened out; 0 for none.
    contrast_floor : float
        Added to the local contrast (of log grey levels) that a pixel is divided by.

    References
    ----------
    Oliva and Torralba, Modeling the shape of the scene: a holistic representation of the spatial
    envelope, IJCV 42(3), 2001. The bank's constants are those of the authors' own program: the
    finest scale at 0.3 cycles a pixel, each next one 1.85 times coarser.
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)

    def __init__(
        self,
        orientations: Sequence[int] = (8, 8, 8, 8),
        grid: int = 4,
        size: int = 128,
        prefilter: float = 4.0,
        contrast_floor: float = 0.2,
    ) -> None:
        self.orientations = orientations
        self.grid = grid
        self.size = size
        self.prefilter = prefilter
        self.contrast_floor = contrast_floor

    def extract(self, observation: Observation) -> NDArray[np.float32]:
        """Return the energies of the observation's image, shape (d,).

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or has no pixels.
        UsageError
            If a parameter cannot be.
        """
        self._check()
        square = (self.size, self.size)
        plane = cv2.resize(grey(observation, "gist"), square, interpolation=cv2.INTER_AREA)
        even = self._even(plane.astype(np.float32))
        margin = self.size // 8
        padded = np.pad(even, margin, mode="symmetric")
        filters = bank(tuple(self.orientations), len(padded))
        responses = np.abs(fft.ifft2(fft.fft2(padded) * filters))
        inner = responses[:, margin : margin + self.size, margin : margin + self.size]
        cell = self.size // self.grid
        cells = inner.reshape(len(filters), self.grid, cell, self.grid, cell)
        return np.asarray(cells.mean(axis=(2, 4)).ravel(), dtype=np.float32)

    def _check(self) -> None:
        if not self.orientations or min(self.orientations) < 1:
            raise UsageError(f"gist needs orientations >= 1, got {list(self.orientations)}")
        if self.grid < 1 or self.size < 16 or self.size % self.grid:
            raise UsageError(
                f"gist needs a size of 16 or more that the grid divides, got {self.size} and "
                f"{self.grid}"
            )
        if not (self.prefilter >= 0 and self.contrast_floor > 0):
            raise UsageError(
                "gist needs prefilter >= 0 and contrast_floor > 0, got "
                f"{self.prefilter} and {self.contrast_floor}"
            )

    def _even(self, plane: Plane) -> Plane:
        """Return log grey levels less their local mean, divided by the local contrast."""
        logs = np.log1p(plane)
        if self.prefilter == 0:
            return logs
        margin = self.size // 8
        padded = np.pad(logs, margin, mode="symmetric")
        low_pass = _low_pass(self.prefilter, len(padded))
        detail = padded - fft.irfft2(fft.rfft2(padded) * low_pass, padded.shape)
        power = fft.irfft2(fft.rfft2(detail**2) * low_pass, padded.shape)
        contrast = np.sqrt(np.maximum(power, 0))
        even = detail / (self.contrast_floor + contrast)
        return np.asarray(even[margin:-margin, margin:-margin], dtype=np.float32)


@lru_cache
def bank(orientations: tuple[int, ...], size: int) -> Plane:
    """Return the transfer functions of the filters.

    Parameters
    ----------
    orientations : tuple of int
        Number of orientations of each scale, from fine to coarse.
    size : int
        Side of the image, pixels.

    Returns
    -------
    ndarray of float32, shape (number of filters, size, size)
        Over the frequencies in the order of the FFT; real, one-sided.
    """
    y, x = np.meshgrid(fft.fftfreq(size), fft.fftfreq(size), indexing="ij")
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    filters = []
    for scale, count in enumerate(orientations):
        radial = np.exp(-3.5 * (radius / (0.3 / 1.85**scale) - 1) ** 2)
        for k in range(count):
            turn = (angle + np.pi * k / count + np.pi) % (2 * np.pi) - np.pi
            filters.append(radial * np.exp(-2 * np.pi * (count / 8) ** 2 * turn**2))
    return np.array(filters, dtype=np.float32)


@lru_cache
def _low_pass(cycles: float, size: int) -> Plane:
    """Return a Gaussian that is one half at so many cycles an image, for real transforms."""
    y, x = np.meshgrid(fft.fftfreq(size), fft.rfftfreq(size), indexing="ij")
    squared = (x**2 + y**2) * size**2
    return np.asarray(np.exp(-squared * np.log(2) / cycles**2), dtype=np.float32)
