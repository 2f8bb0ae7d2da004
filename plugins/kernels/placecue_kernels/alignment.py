"""Weights of kernels by their alignment with the classes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from placecue.kernel import Gram

#: Directions in which the kernels differ by less than this share are no differences.
_SMALL = 1e-12


def aligned(grams: Sequence[Gram], codes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the weights of the sum of kernels that is best aligned with the classes.

    That is the largest centred alignment <K_c, Y> / |K_c|, Y being 1 between samples of one class
    and 0 between others (centring makes it one with +1 and -1 of two classes). Its weights are the
    direction of min_{v >= 0} v'Mv - 2 v'a, with M_kl = <K_kc, K_lc> and a_k = <K_kc, Y>: a problem
    of non-negative least squares.

    Parameters
    ----------
    grams : sequence of p arrays, shape (n, n)
        Of the kernels between the training samples.
    codes : ndarray of int, shape (n,)
        Their classes.

    Returns
    -------
    ndarray, shape (p,)
        Not negative, of any length; all 0 where no kernel is aligned.

    References
    ----------
    Cortes, Mohri and Rostamizadeh, Algorithms for learning kernels based on centered alignment,
    JMLR 13, 2012, proposition 9.
    """
    centred = [_centred(gram) for gram in grams]
    lengths = np.array([np.linalg.norm(gram) for gram in centred])
    inverse = np.divide(1, lengths, out=np.zeros(len(lengths)), where=lengths > 0)
    same = (codes[:, None] == codes[None]).astype(np.float64)
    products = np.array([[np.vdot(one, other) for other in centred] for one in centred])
    with_classes = np.array([np.vdot(one, same) for one in centred])
    # Of unit length each, so that kernels of very different sizes lose no digits.
    root, target = _least_squares(products * np.outer(inverse, inverse), with_classes * inverse)
    return np.asarray(nnls(root, target)[0] * inverse)


def _centred(gram: Gram) -> Gram:
    of_columns = gram.mean(axis=0, keepdims=True)
    return np.asarray(gram - of_columns - gram.mean(axis=1, keepdims=True) + of_columns.mean())


def _least_squares(quadratic: Gram, linear: NDArray[np.float64]) -> tuple[Gram, Gram]:
    """Return R and t such that |Rv - t|^2 is v'Mv - 2 v'a, but for a constant."""
    values, vectors = np.linalg.eigh(quadratic)
    kept = values > _SMALL * max(values[-1], _SMALL)
    roots = np.sqrt(values[kept])
    return roots[:, None] * vectors[:, kept].T, vectors[:, kept].T @ linear / roots
