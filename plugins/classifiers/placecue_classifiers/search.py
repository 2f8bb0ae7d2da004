"""Parameter search by cross-validation on balanced accuracy, one Gram matrix a kernel and gamma."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from sklearn.metrics import recall_score

from placecue.folds import Rows
from placecue.kernel import Gram
from placecue.progress import track
from placecue_classifiers.grid import Grid, Setting
from placecue_classifiers.machines import Machines
from placecue_classifiers.multiclass import Multiclass
from placecue_classifiers.prepared import Prepared, remembering
from placecue_classifiers.smo import block

Codes = NDArray[np.int64]
#: The training rows of a fold, and those held out.
Split: TypeAlias = tuple[Rows, Rows]
#: One list a name: the parameters of each point of the grid, and its balanced accuracy.
Table = dict[str, list[Any]]
SCORE = "balanced_accuracy"


@dataclass(frozen=True)
class Folds:
    """Folds that share features, scaling and kernel, and with them Gram matrices.

    All folds do where nothing of that learns from the samples; elsewhere each is alone.

    Parameters
    ----------
    prepare : callable
        Returns what prepares all n samples for the parameters of a grid.
    splits : sequence of (training rows, held-out rows)
        The folds.
    """

    prepare: Callable[[], Callable[[Setting], Prepared]]
    splits: Sequence[Split]

    def rounds(
        self, rounds: Sequence[tuple[Setting, Setting]]
    ) -> Iterator[tuple[Gram, Sequence[Split]]]:
        """Yield the Gram matrix of each round (preparation, light parameters) with the folds."""
        prepare = remembering(self.prepare())
        for preparation, light in rounds:
            yield prepare(preparation).gram(light), self.splits


def search(
    grid: Grid,
    folds: Sequence[Folds],
    extensions: Sequence[Multiclass],
    codes: Codes,
) -> Table:
    """Score every point of the grid.

    Folds that share a matrix are shared out by joblib: within ``joblib.parallel_config``, among
    as many workers as that says (LIBSVM lets go of the interpreter, so threads do).

    Parameters
    ----------
    grid : Grid
        What to try.
    folds : sequence of Folds
        The folds of the n samples.
    extensions : sequence of Multiclass
        The machines for the points that share a Gram matrix, in the order of ``grid.machines()``.
    codes : ndarray of int64, shape (n,)
        Class of each sample, 0 to M - 1.

    Returns
    -------
    dict of str to list
        The searched parameters and ``balanced_accuracy``, one entry a point: the mean of the
        per-class recalls over all held-out samples, pooled over the folds.
    """
    rounds = [(each, light) for each in grid.preparations() for light in grid.lights()]
    predicted: list[list[Codes]] = [[] for _ in rounds]
    steps = (step for alike in folds for step in enumerate(alike.rounds(rounds)))
    for number, (gram, splits) in track(steps, "searching parameters", len(folds) * len(rounds)):
        predicted[number] += Parallel(prefer="threads")(
            delayed(_predicted)(gram, codes, split, extensions) for split in splits
        )
    truth = np.concatenate([codes[held_out] for alike in folds for _, held_out in alike.splits])
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


def _predicted(gram: Gram, codes: Codes, split: Split, extensions: Sequence[Multiclass]) -> Codes:
    """Return the classes that the machines of each extension give the held-out rows, (m, T)."""
    training, held_out = split
    if all(each.name == "oao" for each in extensions):
        # Side by side by class, as the machines of pairs take them out.
        training = training[np.argsort(codes[training], kind="stable")]
    within, of_rows = block(gram, training, training), codes[training]
    asked = block(gram, held_out, training)
    trained = _trained(within, of_rows, extensions)
    predicted = []
    for extension, machines in zip(extensions, trained, strict=True):
        machines = extension.centred(machines, within, of_rows)
        predicted.append(extension.layout.rank(machines.decide(asked))[:, 0])
    return np.stack(predicted, axis=1)


def _trained(gram: Gram, codes: Codes, extensions: Sequence[Multiclass]) -> list[Machines]:
    """Return the machines of each extension, trained together where only C differs."""
    costs: dict[tuple[Any, ...], dict[float, None]] = {}
    for each in extensions:
        costs.setdefault(each.same, {})[each.C] = None
    found: dict[tuple[Any, float], Machines] = {}
    for each in extensions:
        if (each.same, each.C) not in found:
            tried = list(costs[each.same])
            machines = each.at_costs(gram, codes, tried)
            found |= {(each.same, C): m for C, m in zip(tried, machines, strict=True)}
    return [found[each.same, each.C] for each in extensions]
