"""From scores to probabilities: how sure one belief, or many together, make us of each class."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue.scores import Layout, Probabilities, Scores

Values = NDArray[np.float64]

#: A classifier's probability is taken for at least this: none is as sure as 0.
LEAST = 1e-4


def log_odds(values: Values, layout: Layout) -> Values:
    """Return how much scores speak for each class, up to a constant: a logarithm for probabilities.

    Parameters
    ----------
    values : ndarray of float64, shape (n, V)
        Scores.
    layout : Layout
        What the columns are.

    Returns
    -------
    ndarray of float64, shape (n, M)
        The largest is the class that the layout's own rule picks.
    """
    if isinstance(layout, Probabilities):
        return np.asarray(np.log(np.maximum(values, LEAST)))
    return Scores(values, layout).preferences()


def softmax(odds: Values) -> Values:
    """Return the probabilities of log odds, over the last axis."""
    powers = np.exp(odds - odds.max(axis=-1, keepdims=True))
    return np.asarray(powers / powers.sum(axis=-1, keepdims=True))


def tempered(probabilities: Values, temperature: float) -> Values:
    """Return the probabilities with their log odds divided by a temperature; 1 changes nothing.

    Parameters
    ----------
    probabilities : ndarray of float64, shape (..., M)
        Over the last axis they sum to one.
    temperature : float
        Above 1 they become less sure; their order stays.

    References
    ----------
    Guo, Pleiss, Sun and Weinberger, On calibration of modern neural networks, ICML 2017.
    """
    logarithms = np.log(np.maximum(probabilities, np.finfo(np.float64).tiny))
    return softmax(logarithms / temperature)


def doubted(probabilities: Values, doubt: float) -> Values:
    """Return the probabilities where a share of the beliefs may say anything.

    Parameters
    ----------
    probabilities : ndarray of float64, shape (..., M)
        Over the last axis they sum to one.
    doubt : float
        The share, 0 to 1.
    """
    m = probabilities.shape[-1]
    return np.asarray((1 - doubt) * probabilities + doubt / m)
