"""Scans on a fixed angular step, so that features do not depend on the number of beams."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .beams import Beams
from .summaries import Matrix

Angles = NDArray[np.float64]


def is_full_turn(angles: Angles) -> bool:
    """Tell whether the gap from the last beam on to the first is like that between neighbours."""
    if len(angles) < 3:
        return False
    gap = 2 * np.pi - (angles[-1] - angles[0])
    # Up to two steps: one beam may be missing at the seam, or be there twice.
    return bool(gap <= 2 * np.median(np.diff(angles)))


def resample(ranges: Matrix, angles: Angles, step: float, grazing: float) -> Beams:
    """Return the scans with beams every ``step``.

    Between two beams the surface is taken to be straight. Where it would lie within ``grazing``
    of the line of sight the two beams are taken to hit different things, and the nearer beam in
    angle counts.

    Parameters
    ----------
    ranges : ndarray of float64, shape (n, m)
        Lengths of beams in the same directions, m.
    angles : ndarray of float64, shape (m,)
        These directions, rad, not decreasing.
    step : float
        Angle between beams, rad; over less than a full turn it is adjusted so that the first and
        the last beam stay.
    grazing : float
        Angle, rad.
    """
    closed = is_full_turn(angles)
    if closed:
        wanted = angles[0] + np.arange(round(2 * np.pi / step)) * step
        ranges = np.hstack([ranges, ranges[:, :1]])
        angles = np.append(angles, max(angles[0] + 2 * np.pi, angles[-1]))
    else:
        wanted = np.linspace(angles[0], angles[-1], round((angles[-1] - angles[0]) / step) + 1)
    return Beams(_interpolate(ranges, angles, wanted, grazing), wanted, closed)


def _interpolate(ranges: Matrix, angles: Angles, wanted: Angles, grazing: float) -> Matrix:
    left = np.clip(np.searchsorted(angles, wanted, side="right") - 1, 0, max(len(angles) - 2, 0))
    right = np.minimum(left + 1, len(angles) - 1)
    gap, past = angles[right] - angles[left], wanted - angles[left]
    first, second = ranges.take(left, axis=1), ranges.take(right, axis=1)
    # The sine rule in the triangle of the scanner and both end points.
    below = first * np.sin(past) + second * np.sin(gap - past)
    surface = _is_surface(first, second, gap, grazing) & (below > 0)
    nearest = np.where(past > gap / 2, second, first)
    return np.divide(first * second * np.sin(gap), below, out=nearest, where=surface)


def _is_surface(first: Matrix, second: Matrix, gap: Angles, grazing: float) -> NDArray[np.bool_]:
    near, far = np.minimum(first, second), np.maximum(first, second)
    slope = np.arctan2(near * np.sin(gap), far - near * np.cos(gap))
    return np.asarray((slope > grazing) & (gap > 0) & (gap < np.pi / 2))
