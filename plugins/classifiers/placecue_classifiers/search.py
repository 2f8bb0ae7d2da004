"""Parameter search by cross-validation on balanced accuracy, one Gram matrix a kernel and gamma."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from sklearn.metrics import recall_score

from placecue.kernel import Gram
from placecue.progress import track
from placecue.scores import Layout
from placecue_classifiers.fold_groups import FoldGroup, Split, grams
from placecue_classifiers.grid import Grid, Setting
from placecue_classifiers.machines import Machines

Codes = NDArray[np.int64]
#: One list a name: the parameters of each point of the grid, and its balanced accuracy.
Table = dict[str, list[Any]]
SCORE = "balanced_accuracy"


class Trainer(Protocol):
    """What the search needs of a support vector machine with given parameters."""

    def machines(self, gram: Gram, codes: Codes, names: Sequence[str]) -> Machines:
        """Train on a Gram matrix."""

    def machine_layout(
        self, names: Sequence[str], machines: Machines, gram: Gram, codes: Codes
    ) -> Layout:
        """Return the layout of the machines' outputs."""

    def same_machines(self) -> tuple[Any, ...]:
        """Return what the machines depend on; trainers that agree in it share them."""


def search(
    grid: Grid,
    groups: Sequence[FoldGroup],
    trainer: Callable[[Setting], Trainer],
    codes: Codes,
    names: Sequence[str],
) -> Table:
    """Score every point of the grid.

    The folds of a group are shared out by joblib among threads (LIBSVM lets go of the
    interpreter): within ``joblib.parallel_config(n_jobs=...)``, as many at a time.

    Parameters
    ----------
    grid : Grid
        What to try.
    groups : sequence of FoldGroup
        The folds of the n samples.
    trainer : callable
        Gives the machine of a multi-class extension, class weight and C.
    codes : ndarray of int64, shape (n,)
        Class of each sample, 0 to M - 1.
    names : sequence of str
        The M classes.

    Returns
    -------
    dict of str to list
        The searched parameters and ``balanced_accuracy``, one entry a point: the mean of the
        per-class recalls over all held-out samples, pooled over the folds.
    """
    trainers = [trainer(setting) for setting in grid.machines()]
    rounds = [(each, light) for each in grid.preparations() for light in grid.lights()]
    predicted: list[list[Codes]] = [[] for _ in rounds]
    steps = track(grams(groups, rounds), "searching parameters", len(groups) * len(rounds))
    for number, gram, splits in steps:
        predicted[number] += Parallel(require="sharedmem")(
            delayed(_predicted)(gram, codes, names, split, trainers) for split in splits
        )
    truth = np.concatenate([codes[held_out] for each in groups for _, held_out in each.splits])
    table: Table = {name: [] for name in (*grid.values, SCORE)}
    for (preparation, light), of_round in zip(rounds, predicted, strict=True):
        for column, of_machines in zip(np.concatenate(of_round).T, grid.machines(), strict=True):
            for name, value in {**preparation, **light, **of_machines}.items():
                table[name].append(value)
            table[SCORE].append(balanced_accuracy(truth, column))
    return table


def balanced_accuracy(truth: NDArray[Any], predicted: NDArray[Any]) -> float:
    """Return the mean recall of the classes that occur in ``truth``."""
    recalls = recall_score(truth, predicted, labels=np.unique(truth), average=None)
    return float(np.mean(recalls))


def best_of(table: Table) -> Setting:
    """Return the parameters of the best point of a table, the first of equals."""
    best = int(np.argmax(table[SCORE]))
    return {name: values[best] for name, values in table.items() if name != SCORE}


def _predicted(
    gram: Gram,
    codes: Codes,
    names: Sequence[str],
    split: Split,
    trainers: Sequence[Trainer],
) -> Codes:
    """Return the classes that each trainer's machines give the held-out rows, shape (m, T)."""
    training, held_out = split
    block, of_block = gram[np.ix_(training, training)], codes[training]
    asked = gram[np.ix_(held_out, training)]
    trained: dict[tuple[Any, ...], Machines] = {}
    predicted = []
    for trainer in trainers:
        key = trainer.same_machines()
        if key not in trained:
            trained[key] = trainer.machines(block, of_block, names)
        layout = trainer.machine_layout(names, trained[key], block, of_block)
        predicted.append(layout.rank(trained[key].decide(asked))[:, 0])
    return np.stack(predicted, axis=1)
