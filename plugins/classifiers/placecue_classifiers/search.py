"""Search for C and gamma by cross-validation on balanced accuracy, one Gram matrix a gamma."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.metrics import recall_score

from placecue.errors import UsageError, choices
from placecue.folds import Rows
from placecue.kernel import DistanceKernel, Gram, Kernel
from placecue.progress import track
from placecue.scores import Layout
from placecue_classifiers.machines import Machines


class Trainer(Protocol):
    """What the search needs of a support vector machine."""

    def machines(self, gram: Gram, codes: NDArray[np.int64], C: float) -> Machines:
        """Train on a Gram matrix."""

    def layout(
        self, names: NDArray[np.str_], machines: Machines, gram: Gram, codes: NDArray[np.int64]
    ) -> Layout:
        """Return the layout of the outputs."""


@dataclass(frozen=True, slots=True)
class Grid:
    """Kernels and costs to try.

    Parameters
    ----------
    kernels : list of Kernel
        One a gamma, or the kernel as it is.
    costs : list of float
    gammas : list of float or None
        The gamma of each kernel, where gamma is searched.
    """

    kernels: list[Kernel]
    costs: list[float]
    gammas: list[float] | None

    @classmethod
    def of(cls, values: Mapping[str, Sequence[float]], kernel: Kernel, C: float) -> Grid:
        """Read ``{"C": [...], "gamma": [...]}``.

        Raises
        ------
        UsageError
            If a parameter cannot be searched, a list is empty, or the kernel has no gamma.
        """
        for name, tried in values.items():
            if name not in ("C", "gamma"):
                raise UsageError(f"search cannot vary '{name}'; {choices(name, ('C', 'gamma'))}")
            if not len(tried) or min(tried) <= 0:
                raise UsageError(f"search.{name} must list values above 0, got {list(tried)}")
        costs = [float(cost) for cost in values.get("C", [C])]
        if "gamma" not in values:
            return cls([kernel], costs, None)
        if not isinstance(kernel, DistanceKernel):
            raise UsageError(
                f"kernel {type(kernel).__name__} has no gamma to search: leave search.gamma out"
            )
        gammas = [float(gamma) for gamma in values["gamma"]]
        return cls([clone(kernel).set_params(gamma=gamma) for gamma in gammas], costs, gammas)


def search(
    grid: Grid,
    gram_of: Callable[[Kernel], Gram],
    codes: NDArray[np.int64],
    splits: Sequence[tuple[Rows, Rows]],
    trainer: Trainer,
) -> dict[str, list[float]]:
    """Score every point of the grid.

    Parameters
    ----------
    grid : Grid
        What to try.
    gram_of : callable
        Gives the (n, n) Gram matrix of a kernel of the grid; called once for each.
    codes : ndarray of int64, shape (n,)
        Class of each sample.
    splits : sequence of (training rows, held-out rows)
        The folds.
    trainer : Trainer
        Trains on blocks of the Gram matrix.

    Returns
    -------
    dict of str to list of float
        ``C``, ``gamma`` (if searched) and ``balanced_accuracy``, one entry a point: the mean of
        the per-class recalls over all held-out samples, pooled over the folds.
    """
    table: dict[str, list[float]] = {"C": [], "balanced_accuracy": []}
    if grid.gammas is not None:
        table["gamma"] = []
    for number, kernel in enumerate(track(grid.kernels, "searching C and gamma")):
        gram = gram_of(kernel)
        accuracy = _accuracy_by_cost(gram, codes, splits, grid.costs, trainer)
        table["C"] += grid.costs
        table["balanced_accuracy"] += accuracy
        if grid.gammas is not None:
            table["gamma"] += [grid.gammas[number]] * len(grid.costs)
    return table


def _accuracy_by_cost(
    gram: Gram,
    codes: NDArray[np.int64],
    splits: Sequence[tuple[Rows, Rows]],
    costs: Sequence[float],
    trainer: Trainer,
) -> list[float]:
    names = np.array([str(code) for code in range(int(codes.max()) + 1)])
    predicted: dict[float, list[Any]] = {cost: [] for cost in costs}
    for training, held_out in splits:
        block = gram[np.ix_(training, training)]
        asked = gram[np.ix_(held_out, training)]
        for cost in costs:
            machines = trainer.machines(block, codes[training], cost)
            layout = trainer.layout(names, machines, block, codes[training])
            predicted[cost].append(layout.rank(machines.decide(asked))[:, 0])
    truth = np.concatenate([codes[held_out] for _, held_out in splits])
    return [
        float(recall_score(truth, np.concatenate(p), labels=np.unique(truth), average="macro"))
        for p in predicted.values()
    ]
