"""RootSIFT: SIFT descriptors on which Euclidean distance compares histograms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def root_sift(descriptors: NDArray[np.float32], out: bool = False) -> NDArray[np.float32]:
    """Return the square roots of descriptors made to sum to one, which have unit length.

    Parameters
    ----------
    descriptors : ndarray of float32, shape (n, d)
        Not negative; one of zeros stays so.
    out : bool
        Overwrite the descriptors.

    References
    ----------
    Arandjelovic and Zisserman, Three things everyone should know to improve object retrieval,
    CVPR 2012.
    """
    sums = descriptors.sum(axis=1, keepdims=True)
    shares = np.divide(descriptors, np.where(sums > 0, sums, 1), out=descriptors if out else None)
    return np.sqrt(shares, out=shares)
