"""How far a point is from what was seen, and where a scan lies best when little is known of it."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.slam.planar import Array, compose, moved

#: Side of a cell, m; room around the points, m; and what a point far from all counts as, m.
CELL, MARGIN, FAR = 0.1, 1.0, 2.0
#: Poses are tried so far apart, m and rad, with so many points, whose distance from what was seen
#: counts by a bell of this width, m.
STEP, STEP_TURN, TRIED, WIDTH = 0.2, 0.05, 120, 0.2


@dataclass(frozen=True, slots=True)
class Found:
    """The best pose of a search.

    Parameters
    ----------
    pose : ndarray, shape (3,)
        The pose.
    score : float
        Mean of the bells over the points, 0 to 1.
    """

    pose: Array
    score: float


class Field:
    """Distances to the nearest of some points, on a grid.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        m; at least one.
    """

    def __init__(self, points: Array) -> None:
        self._corner = points.min(axis=0) - MARGIN
        columns, rows = np.ceil((np.ptp(points, axis=0) + 2 * MARGIN) / CELL).astype(int) + 1
        empty = np.ones((rows, columns), np.uint8)
        at = self._cells(points)
        empty[at[:, 1], at[:, 0]] = 0
        self._distances: NDArray[np.float32] = (
            cv2.distanceTransform(empty, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * CELL
        )

    def distances(self, points: Array) -> NDArray[np.float64]:
        """Return the distance of each point from what was seen, to a cell, m, shape (n,)."""
        at = self._cells(points)
        height, width = self._distances.shape
        inside = (at >= 0).all(axis=1) & (at[:, 0] < width) & (at[:, 1] < height)
        found = np.full(len(points), FAR)
        found[inside] = self._distances[at[inside, 1], at[inside, 0]]
        return found

    def search(
        self, points: Array, guess: Array, reach: float, turn: float, coarse: float = 1.0
    ) -> Found:
        """Try poses around a guess on a grid, and return the best.

        Parameters
        ----------
        points : ndarray, shape (n, 2)
            In their own frame, m.
        guess : ndarray, shape (3,)
            Where their frame may be.
        reach, turn : float
            How far off that may be in x and y, m, and in heading, rad.
        coarse : float
            Steps are so many times as wide, and points so many times fewer.

        References
        ----------
        Olson, Real-time correlative scan matching, ICRA 2009.
        """
        step, step_turn, tried = coarse * STEP, coarse * STEP_TURN, int(TRIED / coarse)
        some = points[np.linspace(0, len(points) - 1, min(tried, len(points))).astype(int)]
        far = np.minimum(self._distances, FAR)
        pad = int(np.ceil(reach / CELL)) + 1
        bells = np.pad(np.exp(-0.5 * (far / (coarse * WIDTH)) ** 2), pad)
        offsets = np.arange(-(reach // step), reach // step + 1) * step
        cells = np.round(offsets / CELL).astype(np.int64)
        best = Found(guess, -1.0)
        for heading in np.arange(-(turn // step_turn), turn // step_turn + 1) * step_turn:
            start = compose(guess, np.array([0.0, 0.0, heading]))
            scores = _scores(bells, self._cells(moved(some, start)), cells, pad)
            at = int(scores.argmax())
            if scores.flat[at] > best.score:
                row, column = divmod(at, len(offsets))
                pose = start + np.array([offsets[column], offsets[row], 0.0])
                best = Found(pose, float(scores.flat[at]))
        return best

    def _cells(self, points: Array) -> NDArray[np.int64]:
        return np.asarray(np.floor((points - self._corner) / CELL), dtype=np.int64)


def _scores(
    padded: NDArray[np.float64], at: NDArray[np.int64], offsets: NDArray[np.int64], pad: int
) -> NDArray[np.float64]:
    """Return the mean bell of cells moved by each pair of offsets, shape (rows, columns)."""
    height, width = padded.shape
    # What lies outside the grid lies in its rim, where there is nothing.
    columns = np.clip(at[:, 0] + pad, pad - 1, width - pad)
    rows = np.clip(at[:, 1] + pad, pad - 1, height - pad)
    starts = rows * width + columns
    moves = (offsets[:, None] * width + offsets[None, :]).ravel()
    index = np.clip(starts[None, :] + moves[:, None], 0, padded.size - 1)
    return np.asarray(padded.ravel()[index].mean(axis=1).reshape(len(offsets), len(offsets)))
