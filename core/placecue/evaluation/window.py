"""What part of space a picture shows, where a few points lie absurdly far away."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

#: Points so many times as far from the middle as nearly all others are not shown,
FAR = 8.0
#: nor ones nearer than this, m, left out: a robot that hardly moves has nothing absurd about it.
NEAR = 20.0
#: Share of the points that are nearly all, from either side.
SHARE = 0.05


def window_of(points: Points) -> Points:
    """Return the lower left and upper right corner of what is to be shown, m, shape (2, 2).

    That is everything, unless a few points are far from nearly all others; then it is everything
    but these. Points that are not finite are left out.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Positions, m.
    """
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        return np.array([[-1.0, -1.0], [1.0, 1.0]])
    low, high = np.quantile(points, [SHARE, 1.0 - SHARE], axis=0, method="nearest")
    reach = max(NEAR, FAR * float((high - low).max()))
    kept = points[((points >= low - reach) & (points <= high + reach)).all(axis=1)]
    return np.array([kept.min(axis=0), kept.max(axis=0)])


def within(points: Points, window: Points) -> NDArray[np.bool_]:
    """Tell which points, m, shape (n, 2), lie in a window."""
    return np.asarray(((points >= window[0]) & (points <= window[1])).all(axis=1))
