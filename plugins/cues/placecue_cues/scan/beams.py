"""Scans of equal beams, and what several features of them share."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .fourier import Harmonics, harmonics
from .polygon import Polygons
from .summaries import Matrix, ratio


class Beams:
    """n scans of m beams in the same directions.

    Parameters
    ----------
    ranges : ndarray of float64, shape (n, m)
        Length of each beam, m.
    angles : ndarray of float64, shape (m,)
        Direction of each beam, rad.
    cyclic : bool
        Whether the last beam is followed by the first. Where not, pairs end with the last beam
        and the polygon is closed by the scanner's own position.
    """

    def __init__(self, ranges: Matrix, angles: NDArray[np.float64], cyclic: bool) -> None:
        self.ranges = ranges
        self.angles = angles
        self.cyclic = cyclic
        self._harmonics: dict[tuple[int, int], Harmonics] = {}

    @property
    def count(self) -> int:
        """Number of beams of a scan."""
        return len(self.angles)

    def pairs(self, values: Matrix) -> tuple[Matrix, Matrix]:
        """Return every value and its successor, shape (n, m) or (n, m - 1) each."""
        if self.cyclic:
            return values, np.roll(values, -1, axis=1)
        return values[:, :-1], values[:, 1:]

    def differences(self, clip: float = np.inf) -> Matrix:
        """Return abs(d_i - d_next), m, the ranges clipped at ``clip``."""
        this, following = self.pairs(np.minimum(self.ranges, clip))
        return np.abs(this - following)

    def ratios(self, offset: float = 0.0) -> Matrix:
        """Return the smaller over the larger of each pair of ranges plus ``offset``."""
        this, following = self.pairs(self.ranges + offset)
        return ratio(np.minimum(this, following), np.maximum(this, following))

    @cached_property
    def points(self) -> NDArray[np.complex128]:
        """End points, x + iy, m, shape (n, m)."""
        return np.asarray(self.ranges * np.exp(1j * self.angles))

    @cached_property
    def polygons(self) -> Polygons:
        """The polygons that join the end points."""
        if self.cyclic:
            return Polygons(self.points)
        return Polygons(np.pad(self.points, ((0, 0), (0, 1))))

    def harmonics(self, positive: int, negative: int) -> Harmonics:
        """Return so many harmonics of each sign of the polygons' boundaries."""
        key = positive, negative
        if key not in self._harmonics:
            self._harmonics[key] = harmonics(self.polygons, positive, negative)
        return self._harmonics[key]
