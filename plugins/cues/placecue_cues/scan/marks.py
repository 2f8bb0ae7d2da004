"""What stands out in a single scan: straight lines, and its nearest things."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks


def line_share(points: NDArray[np.complex128], tolerance: float, least: int) -> float:
    """Return the share of end points that lie on straight lines.

    Split and merge: the scan is split where it is farthest from the chord, until no point is
    farther than ``tolerance`` from its chord (Ramer, Douglas and Peucker), and stretches that
    are one line are merged again, which OpenCV's ``approxPolyDP`` does as its last stage.

    Parameters
    ----------
    points : ndarray of complex128, shape (m,)
        End points in the order of the beams, x + iy, m.
    tolerance : float
        Largest distance of a point from its line, m.
    least : int
        A line has at least so many points.
    """
    single = points.astype(np.complex64)
    path = single.view(np.float32).reshape(-1, 1, 2)
    kept = cv2.approxPolyDP(path, tolerance, closed=False)
    corners = np.flatnonzero(np.isin(single, np.ascontiguousarray(kept).view(np.complex64)))
    on_line = np.zeros(len(points), dtype=bool)
    for first, last in pairwise(corners):
        if last - first + 1 >= least:
            on_line[first : last + 1] = True
    return float(on_line.mean())


def nearest_minima(ranges: NDArray[np.float64], cyclic: bool, depth: float) -> NDArray[np.int64]:
    """Return the beams of the two smallest local minima, shape (2,), or (0,) if there are fewer.

    A flat minimum counts once, at its middle. What the ranges do not rise above by ``depth`` (m)
    on both sides before they fall below it is none. Beyond its ends a scan counts as open, so
    that an end can be a minimum; those of a full turn are neighbours.
    """
    # A full turn is cut open at its longest beam, which is no minimum.
    start = int(np.argmax(ranges)) if cyclic else 0
    turned = np.roll(ranges, -start)
    minima = find_peaks(-np.pad(turned, 1, constant_values=np.inf), prominence=depth)[0] - 1
    if len(minima) < 2:
        return np.empty(0, dtype=np.int64)
    order = np.argsort(turned[minima], kind="stable")[:2]
    return np.asarray((minima[order] + start) % len(ranges), dtype=np.int64)
