"""Fourier coefficients of a polygon's boundary, exact for the polygon."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, isqrt

import numpy as np

from .polygon import Points, Polygons
from .summaries import NOISE, Matrix, ratio


@dataclass(frozen=True, slots=True)
class Harmonics:
    """Magnitudes of the Fourier coefficients of the boundary z(t) by arc length t.

    Parameters
    ----------
    positive : ndarray of float64, shape (n, p)
        abs(c_k) for k = 1 ... p, m.
    negative : ndarray of float64, shape (n, q)
        abs(c_k) for k = -1 ... -q, m.
    """

    positive: Matrix
    negative: Matrix

    @property
    def first(self) -> Matrix:
        """abs(c_1), m, shape (n, 1); 0 where it is rounding noise."""
        c1, other = self.positive[:, :1], self.negative[:, :1]
        return np.where(c1 > NOISE * other, c1, 0.0)

    @property
    def scaled(self) -> tuple[Matrix, Matrix]:
        """The magnitudes divided by abs(c_1), 0 where that is 0."""
        return ratio(self.positive, self.first), ratio(self.negative, self.first)

    @property
    def axes(self) -> tuple[Matrix, Matrix]:
        """Major and minor half axis of the ellipse of c_1 and c_-1, m, shape (n, 1) each."""
        c1, other = self.positive[:, :1], self.negative[:, :1]
        return c1 + other, np.abs(c1 - other)


def harmonics(polygons: Polygons, positive: int, negative: int) -> Harmonics:
    """Return so many harmonics of each sign.

    c_k = P / (2 pi k)**2 sum_j (u_{j-1} - u_j) exp(-2 pi i k t_j / P), with u_j the unit vector
    along edge j, t_j the arc length at its start and P the perimeter.
    """
    turns = np.roll(polygons.directions, 1, axis=1) - polygons.directions
    travelled = np.cumsum(polygons.lengths, axis=1) - polygons.lengths
    phase = np.exp(-2j * np.pi * ratio(travelled, polygons.perimeter))
    # sum d conj(w)**k is the conjugate of sum conj(d) w**k.
    sums = _power_sums(turns, phase, positive), _power_sums(turns.conj(), phase, negative)
    return Harmonics(*(np.abs(part) * _weights(polygons.perimeter, part) for part in sums))


def _weights(perimeter: Matrix, sums: Points) -> Matrix:
    k = np.arange(1, sums.shape[1] + 1)
    return np.asarray(perimeter / (2 * np.pi * k) ** 2)


def _power_sums(factors: Points, base: Points, count: int) -> Points:
    """Return sum_j factors_j * base_j**k for k = 1 ... count, shape (n, count).

    With k = width * i + j the powers are products of few, and the sums one small matrix product.
    """
    width = isqrt(count - 1) + 1
    low = _geometric(base, base, width)
    high = _geometric(factors, low[:, -1], ceil(count / width))
    sums = high @ low.transpose(0, 2, 1)
    return sums.reshape(len(base), -1)[:, :count]


def _geometric(start: Points, factor: Points, count: int) -> Points:
    """Return start * factor**i for i = 0 ... count - 1, shape (n, count, k)."""
    powers = np.empty((start.shape[0], count, start.shape[1]), dtype=np.complex128)
    powers[:, 0] = start
    for i in range(1, count):
        np.multiply(powers[:, i - 1], factor, out=powers[:, i])
    return powers
