"""Pairwise fields over a graph: probabilities of labels by what is seen at nodes and neighbours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

Values = NDArray[np.float64]
Edges = Sequence[tuple[int, int]]


def _normalised(logarithms: Values) -> Values:
    return np.asarray(logarithms - logsumexp(logarithms, axis=1, keepdims=True))


def _directed(edges: Edges) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Return sources and targets of all edges both ways, and the row of each one's opposite."""
    ends = np.array(edges, dtype=np.intp).reshape(-1, 2)
    n = len(ends)
    sources, targets = np.concatenate([ends, ends[:, ::-1]]).T
    return sources, targets, np.concatenate([np.arange(n, 2 * n), np.arange(n)])


def belief_propagation(
    unary: Values, pair: Values, edges: Edges, rounds: int = 200, damping: float = 0.3
) -> Values:
    """Return the probability of each label at each node of a pairwise field.

    Exact where the edges make no loop, after as many rounds as the longest way; with loops it is
    the loopy approximation.

    Parameters
    ----------
    unary : ndarray of float64, shape (n, M)
        Logarithm of the potential of each label at each node.
    pair : ndarray of float64, shape (M, M)
        Logarithm of the potential of the labels of two neighbours; symmetric.
    edges : sequence of (int, int)
        Pairs of nodes.
    rounds : int
        At most so many exchanges of messages, beyond the number of nodes.
    damping : float
        The share of a message that stays from the round before, 0 to 1.

    Returns
    -------
    ndarray of float64, shape (n, M)

    References
    ----------
    Pearl, Probabilistic Reasoning in Intelligent Systems, 1988; Murphy, Weiss and Jordan, UAI 1999.
    """
    if not len(edges):
        return np.asarray(np.exp(_normalised(unary)))
    sources, targets, opposite = _directed(edges)
    messages = np.zeros((len(sources), unary.shape[1]))
    for _ in range(rounds + len(unary)):
        heard = unary.copy()
        np.add.at(heard, targets, messages)
        sent = (heard[sources] - messages[opposite])[:, :, None] + pair
        new = _normalised(logsumexp(sent, axis=1))
        new = _normalised(np.logaddexp(new + np.log1p(-damping), messages + np.log(damping)))
        change = np.abs(new - messages).max()
        messages = new
        if change < 1e-9:
            break
    heard = unary.copy()
    np.add.at(heard, targets, messages)
    return np.asarray(np.exp(_normalised(heard)))


def relaxed(probabilities: Values, compatibility: Values, edges: Edges, rounds: int = 20) -> Values:
    """Return the probabilities of labels after each node has listened to its neighbours.

    Parameters
    ----------
    probabilities : ndarray of float64, shape (n, M)
        Of each label at each node by what was seen there.
    compatibility : ndarray of float64, shape (M, M)
        How well a node's label (row) goes with a neighbour's (column), -1 to 1.
    edges : sequence of (int, int)
        Pairs of nodes.
    rounds : int
        How often they listen.

    References
    ----------
    Rosenfeld, Hummel and Zucker, Scene labeling by relaxation operations, IEEE SMC 6(6), 1976;
    Stachniss, Grisetti, Martinez Mozos and Burgard, ICRA 2007.
    """
    if not len(edges):
        return probabilities
    sources, targets, _ = _directed(edges)
    neighbours = np.bincount(targets, minlength=len(probabilities))
    for _ in range(rounds):
        support = np.zeros_like(probabilities)
        np.add.at(support, targets, probabilities[sources] @ compatibility.T)
        support /= np.maximum(neighbours, 1)[:, None]
        probabilities = probabilities * (1 + support)
        probabilities = probabilities / probabilities.sum(axis=1, keepdims=True)
    return probabilities
