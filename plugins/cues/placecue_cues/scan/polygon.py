"""Polygons that join the end points of beams, many at a time."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .summaries import NOISE, TINY, Matrix, ratio

Points = NDArray[np.complex128]


class Polygons:
    """n polygons of k vertices each, closed from the last to the first.

    Parameters
    ----------
    vertices : ndarray of complex128, shape (n, k)
        x + iy of each vertex, m, counter-clockwise.
    """

    def __init__(self, vertices: Points) -> None:
        self.vertices = vertices
        self.following = np.roll(vertices, -1, axis=1)

    @cached_property
    def edges(self) -> Points:
        """From each vertex to the next, m, shape (n, k)."""
        return self.following - self.vertices

    @cached_property
    def lengths(self) -> Matrix:
        """Length of each edge, m, shape (n, k)."""
        return np.abs(self.edges)

    @cached_property
    def directions(self) -> Points:
        """Unit vector along each edge, 0 for an edge of no length, shape (n, k)."""
        divisor = np.where(self.lengths > TINY, self.lengths, np.inf)
        return np.asarray(self.edges / divisor)

    @cached_property
    def perimeter(self) -> Matrix:
        """Perimeter, m, shape (n, 1)."""
        return np.asarray(self.lengths.sum(axis=1, keepdims=True))

    @cached_property
    def _crosses(self) -> Matrix:
        return np.asarray((self.vertices.conj() * self.following).imag)

    @cached_property
    def area(self) -> Matrix:
        """Signed area, positive where counter-clockwise, m**2, shape (n, 1)."""
        return np.asarray(self._crosses.sum(axis=1, keepdims=True) / 2)

    @cached_property
    def least_area(self) -> Matrix:
        """The area below which a polygon has none but rounding noise, m**2, shape (n, 1)."""
        return np.asarray(NOISE * self.perimeter**2 + TINY)

    @cached_property
    def centroid(self) -> Points:
        """Centre of the area; of the vertices where there is no area, x + iy, m, shape (n, 1)."""
        solid = np.abs(self.area) > self.least_area
        moment = ((self.vertices + self.following) * self._crosses).sum(axis=1, keepdims=True)
        centre = moment / np.where(solid, 6 * self.area, 1.0)
        return np.asarray(np.where(solid, centre, self.vertices.mean(axis=1, keepdims=True)))

    @cached_property
    def spokes(self) -> Matrix:
        """Distance from the centroid to each vertex, m, shape (n, k)."""
        return np.abs(self.vertices - self.centroid)

    def boundary_distance(self) -> Matrix:
        """Return mean and standard deviation of the distance from the centroid to the boundary.

        They are exact integrals along the edges, so that the spacing of the vertices does not
        matter.

        Returns
        -------
        ndarray of float64, shape (n, 2)
            Mean and standard deviation, m.
        """
        inward = (self.vertices - self.centroid) * self.directions.conj()
        start, stop = inward.real, inward.real + self.lengths
        largest = self.spokes.max(axis=1, keepdims=True)
        height = np.maximum(np.abs(inward.imag), NOISE * largest + TINY)
        first = _distance_integral(stop, height) - _distance_integral(start, height)
        second = height**2 * self.lengths + (stop**3 - start**3) / 3
        mean = ratio(first.sum(axis=1, keepdims=True), self.perimeter)
        square = ratio(second.sum(axis=1, keepdims=True), self.perimeter)
        return np.hstack([mean, np.sqrt(np.maximum(square - mean**2, 0))])


def _distance_integral(along: Matrix, height: Matrix) -> Matrix:
    """Return the integral of sqrt(height**2 + s**2) over s from 0 to ``along``."""
    hypotenuse = np.hypot(along, height)
    return np.asarray((along * hypotenuse + height**2 * np.arcsinh(along / height)) / 2)
