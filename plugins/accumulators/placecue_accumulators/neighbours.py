"""Weights of neighbouring labels: how they are learned from labelled maps, and kept in a file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import logsumexp

from placecue.errors import DataError
from placecue_accumulators.pairwise import Edges

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Neighbours:
    """What is known of labels side by side.

    Parameters
    ----------
    classes : tuple of str
        The M classes.
    weights : ndarray of float64, shape (M, M)
        In an HMM the probability of a step from row to column; in a field the logarithm of the
        potential of two neighbours.
    seen : float
        What a field multiplies what was seen at a node by.
    """

    classes: tuple[str, ...]
    weights: Values
    seen: float = 1.0

    def write(self, path: str | Path) -> None:
        """Write a JSON file that :meth:`read` reads."""
        content = {
            "type": "placecue/neighbours",
            "classes": list(self.classes),
            "weights": self.weights.tolist(),
            "seen": self.seen,
        }
        Path(path).write_text(json.dumps(content), encoding="utf-8")

    @classmethod
    def read(cls, path: str | Path, classes: Sequence[str]) -> Neighbours:
        """Read the weights of some classes, in their order.

        Raises
        ------
        DataError
            If it is no such file, or lacks one of the classes.
        """
        try:
            content = json.loads(Path(path).read_text("utf-8"))
            known = [str(name) for name in content["classes"]]
            weights = np.array(content["weights"], dtype=np.float64)
            seen = float(content["seen"])
            square = (len(known), len(known))
            if content["type"] != "placecue/neighbours" or weights.shape != square:
                raise ValueError(f"weights of shape {weights.shape} for {len(known)} classes")
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise DataError(
                f"{path} holds no weights of neighbours ({type(error).__name__}: {error})"
            ) from error
        missing = sorted(set(classes) - set(known))
        if missing:
            raise DataError(f"{path} has no weights of {', '.join(missing)}; it has {known}")
        rows = [known.index(name) for name in classes]
        return cls(tuple(classes), weights[np.ix_(rows, rows)], seen)


def steps_between(labels: Sequence[str], classes: Sequence[str], before: float = 1.0) -> Neighbours:
    """Learn the transitions of an HMM from the true labels of nodes in the order of a drive.

    Parameters
    ----------
    labels : sequence of str
        One a step; those of other classes are passed over.
    classes : sequence of str
        The classes.
    before : float
        Added to each count, so that nothing is impossible (Laplace).
    """
    row = {name: i for i, name in enumerate(classes)}
    counts = np.full((len(row), len(row)), before)
    known = [row[label] for label in labels if label in row]
    np.add.at(counts, (known[:-1], known[1:]), 1.0)
    return Neighbours(tuple(classes), counts / counts.sum(axis=1, keepdims=True))


def learned_field(
    unary: Values,
    edges: Edges,
    truth: NDArray[np.int64],
    classes: Sequence[str],
    prior: float = 0.1,
) -> Neighbours:
    """Learn the weights of a field from a labelled graph, by its pseudo-likelihood.

    Parameters
    ----------
    unary : ndarray of float64, shape (n, M)
        Log-likelihood of each class by what was seen at each node.
    edges : sequence of (int, int)
        Pairs of nodes.
    truth : ndarray of int64, shape (n,)
        The true class of each node.
    classes : sequence of str
        The M classes.
    prior : float
        Weight of the squares of the weights, against overfitting.

    References
    ----------
    Besag, Statistical analysis of non-lattice data, The Statistician 24(3), 1975.
    """
    n, m = unary.shape
    around = np.zeros((n, m))  # how many neighbours of each class a node has
    for a, b in edges:
        around[a, truth[b]] += 1
        around[b, truth[a]] += 1

    def loss(parameters: Values) -> tuple[float, Values]:
        seen, free = parameters[0], parameters[1:].reshape(m, m)
        odds = seen * unary + around @ (free + free.T)
        logs = odds - logsumexp(odds, axis=1, keepdims=True)
        wrong = np.exp(logs)
        wrong[np.arange(n), truth] -= 1
        slope = around.T @ wrong
        gradient = np.concatenate([[(wrong * unary).sum()], (slope + slope.T).ravel()])
        value = -logs[np.arange(n), truth].sum() + prior * (parameters @ parameters)
        return float(value), gradient + 2 * prior * parameters

    start = np.concatenate([[1.0], np.zeros(m * m)])
    found = minimize(loss, start, jac=True, method="L-BFGS-B").x
    free = found[1:].reshape(m, m)
    return Neighbours(tuple(classes), free + free.T, float(found[0]))
