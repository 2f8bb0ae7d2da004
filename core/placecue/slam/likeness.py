"""How alike two places look, wherever the robot thinks that it is: signatures of what was seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue.slam.planar import Array

#: Bins of distances from the robot and between points, and how wide they are, m.
RINGS, RING, PAIRS, PAIR = 32, 0.25, 32, 0.35
#: Points whose distances from one another are taken.
TAKEN = 64
#: A signature takes so many bytes.
SIZE = RINGS + PAIRS

Signature = NDArray[np.uint8]


def signature_of(points: Array) -> Signature:
    """Return what stays the same of some points however the robot is turned, shape (64,).

    How many points lie how far from the robot, and how many pairs of them how far from one
    another; square roots of both, so that their products tell how alike two are.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        One a cell of a grid, in the robot's frame, m.

    References
    ----------
    Osada, Funkhouser, Chazelle, Dobkin, Shape distributions, ACM Transactions on Graphics 21(4),
    2002 (pairs). Kim, Kim, Scan context, IROS 2018 (rings).
    """
    away = np.hypot(points[:, 0], points[:, 1])
    near = points[away < RINGS * RING]
    some = near[np.linspace(0, len(near) - 1, min(TAKEN, len(near))).astype(int)]
    one, other = np.triu_indices(len(some), 1)
    apart = np.hypot(*(some[one] - some[other]).T)
    told = np.concatenate([_shares(away, RINGS, RING), _shares(apart, PAIRS, PAIR)])
    return np.asarray(np.round(255 * np.sqrt(told)), dtype=np.uint8)


def likeness(one: Signature, others: Signature) -> Array:
    """Return how alike one signature is to others, shape (n,), 1 for the same.

    Parameters
    ----------
    one : ndarray of uint8, shape (64,)
        A signature.
    others : ndarray of uint8, shape (n, 64)
        Some.
    """
    parts = []
    for half in (slice(0, RINGS), slice(RINGS, SIZE)):
        a, b = one[half].astype(np.float64), others[:, half].astype(np.float64)
        sizes = np.linalg.norm(a) * np.linalg.norm(b, axis=1)
        parts.append(b @ a / np.maximum(sizes, 1.0))
    return np.asarray(np.minimum(*parts))


def _shares(lengths: Array, bins: int, width: float) -> Array:
    """Return the share of lengths in each bin, each spread over three, shape (bins,)."""
    counts = np.bincount((lengths[lengths < bins * width] / width).astype(int), minlength=bins)
    spread = np.convolve(counts, [0.25, 0.5, 0.25], mode="same")
    return np.asarray(spread / max(spread.sum(), 1.0))
