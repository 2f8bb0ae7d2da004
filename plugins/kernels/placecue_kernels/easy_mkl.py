"""EasyMKL: weights of kernels by the margin between the classes that each of them gives."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import SVC

from placecue.interrupting import interruptible
from placecue.kernel import Gram


def by_margin(
    grams: Sequence[Gram], codes: NDArray[np.int64], regularization: float
) -> NDArray[np.float64]:
    """Return the weights d_r of kernels, summed over the problems of one class against the rest.

    Of one problem d_r = g'Y K_r Y g, where g minimises (1 - L) g'Y (sum_r K_r) Y g + L |g|^2 over
    distributions on the samples of either side: the squared distance, by kernel r, of two points
    of their convex hulls.

    Parameters
    ----------
    grams : sequence of p arrays, shape (n, n)
        Of the kernels between the training samples, with a mean diagonal of 1.
    codes : ndarray of int, shape (n,)
        Their classes; M of them.
    regularization : float
        L, above 0 and up to 1, where g is even and the points are the means of either side.

    Returns
    -------
    ndarray, shape (p,)

    References
    ----------
    Aiolli and Donini, EasyMKL: a scalable multiple kernel learning algorithm, Neurocomputing 169,
    2015. The sum over the classes of more than two: our choice.
    """
    classes = np.unique(codes)
    total = (1 - regularization) * np.sum(grams, axis=0)
    total[np.diag_indices_from(total)] += regularization
    problems = [np.where(codes == each, 1.0, -1.0) for each in classes]
    weights = np.zeros(len(grams))
    for sides in problems:
        signed = sides * interruptible(partial(nearest_points, total, sides))
        weights += [signed @ gram @ signed for gram in grams]
    return np.maximum(weights, 0)


def nearest_points(gram: Gram, sides: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return g, shape (n,): the two points of the convex hulls of either side that are nearest.

    They are those of a machine with a hard margin, whose dual coefficients are g but for a factor.

    Parameters
    ----------
    gram : ndarray, shape (n, n)
        Between the samples, positive definite.
    sides : ndarray, shape (n,)
        1 or -1.
    """
    # Coefficients add up to 4 over the squared distance of the points, which the ridge in the
    # diagonal keeps above 0, so that this cost bounds none of them.
    svc = SVC(kernel="precomputed", C=1e12, tol=1e-6).fit(gram, sides)
    found = np.zeros(len(sides))
    found[svc.support_] = np.abs(svc.dual_coef_[0])
    return np.asarray(found / (found.sum() / 2))
