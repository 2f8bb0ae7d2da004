"""Area moments of a polygon."""

from __future__ import annotations

import cv2
import numpy as np

from .polygon import Polygons
from .summaries import TINY, Matrix


def shape_moments(polygons: Polygons, floor: float) -> Matrix:
    """Return Hu's moments, the normalised compactness and the normalised eccentricity.

    Parameters
    ----------
    polygons : Polygons
        n polygons.
    floor : float
        The moments h are given as sign(h) log10(1 + abs(h) / floor).

    Returns
    -------
    ndarray of float64, shape (n, 9)
        Seven moments; area**2 / (2 pi (mu20 + mu02)), 1 for a disc; and
        sqrt((mu20 - mu02)**2 + 4 mu11**2) / (mu20 + mu02), 0 for a disc and 1 for a line. All 0
        for a polygon without area.
    """
    largest = polygons.spokes.max(axis=1, keepdims=True)
    # About the centroid and of unit size: OpenCV takes vertices in single precision.
    unit = (polygons.vertices - polygons.centroid) / np.where(largest > TINY, largest, 1.0)
    rows = np.stack([unit.real, unit.imag], axis=2).astype(np.float32)
    return np.array([_shape_moments(row, floor) for row in rows])


def _shape_moments(vertices: Matrix, floor: float) -> Matrix:
    moments = cv2.moments(vertices[:, None, :])
    hu = cv2.HuMoments(moments).ravel()
    spread = moments["mu20"] + moments["mu02"]
    if not spread > 0:
        return np.zeros(9)
    compactness = moments["m00"] ** 2 / (2 * np.pi * spread)
    eccentricity = np.hypot(moments["mu20"] - moments["mu02"], 2 * moments["mu11"]) / spread
    signed_log = np.sign(hu) * np.log10(1 + np.abs(hu) / floor)
    return np.array([*signed_log, compactness, eccentricity])
