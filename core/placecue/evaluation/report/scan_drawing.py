"""A laser scan from above, as a few numbers of SVG."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: Half the side of the drawing, its own units.
HALF = 60
#: Beams that are drawn.
BEAMS = 120


class Drawing(NamedTuple):
    """What the laser saw, the robot in the middle and looking upwards.

    Parameters
    ----------
    path : str
        The free space, as the data of an SVG path within -60 to 60.
    reach : float
        How far it is from the middle to the border, m.
    """

    path: str
    reach: float


def draw_scan(points: NDArray[np.float64]) -> Drawing:
    """Draw where beams ended.

    Parameters
    ----------
    points : ndarray of float64, shape (k, 2)
        End points in the robot's frame (x ahead, y to the left), m, in the order of the beams.
    """
    thinned = points[:: -(-len(points) // BEAMS)]
    far = np.abs(thinned).max(initial=0)
    reach = float(np.clip(np.ceil(far), 2, 10))
    # Ahead is up, and the left is left: SVG counts y downwards.
    x, y = (-thinned[:, ::-1] * HALF / reach).T
    ends = np.clip(np.round(np.column_stack([x, y])), -999, 999).astype(int)
    return Drawing("M0 0L" + " ".join(f"{x} {y}" for x, y in ends.tolist()) + "Z", reach)
