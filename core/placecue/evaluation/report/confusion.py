"""Tables of what was taken for what."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.tally import Tally

#: The column of samples of which nothing was decided.
NOTHING = "nothing"
#: The pairs of all experiments together.
ALL = "all"


@dataclass(frozen=True)
class Matrix:
    """How often each class was taken for which.

    Parameters
    ----------
    method, experiment : str
        Whose; what its reader chooses by.
    classes : sequence of str
        The rows.
    columns : sequence of str
        What was decided: the classes, and whatever else was said.
    counts : ndarray of int, shape (rows, columns)
        Samples.
    """

    method: str
    experiment: str
    classes: Sequence[str]
    columns: Sequence[str]
    counts: NDArray[np.int64]

    @property
    def score(self) -> float | None:
        """The mean of the recalls, %; None without a sample."""
        recalls = [
            100 * row[list(self.columns).index(name)] / row.sum()
            for name, row in zip(self.classes, self.counts, strict=True)
            if row.sum() and name in self.columns
        ]
        return float(np.mean(recalls)) if recalls else None

    @property
    def rows(self) -> list[tuple[str, int, list[tuple[int, float]]]]:
        """Class, samples, and for each column how many, and which share of the class."""
        return [
            (name, int(row.sum()), [(int(n), float(n / max(row.sum(), 1))) for n in row])
            for name, row in zip(self.classes, self.counts, strict=True)
        ]


@dataclass(frozen=True)
class Matrices:
    """Matrices, of which the reader chooses one by method and experiment.

    Parameters
    ----------
    matrices : sequence of Matrix
        All that there are.
    """

    template: ClassVar[str] = "confusion.html.j2"

    matrices: Sequence[Matrix]

    @property
    def methods(self) -> list[str]:
        """To choose from, in the order of the matrices."""
        return list(dict.fromkeys(each.method for each in self.matrices))

    @property
    def experiments(self) -> list[str]:
        """To choose from, in the order of the matrices."""
        return list(dict.fromkeys(each.experiment for each in self.matrices))


def of_results(results: Results) -> Matrices:
    """Return the matrices of each method over the pairs of each experiment."""
    experiments = results.experiments
    matrices = []
    for method in results.methods:
        of_method = {name: results.of(method, name) for name in experiments}
        if len(experiments) > 1:
            of_method[ALL] = results.of(method)
        matrices += [_summed(method, name, each) for name, each in of_method.items() if each]
    return Matrices(matrices)


def _summed(method: str, experiment: str, results: Sequence[Result]) -> Matrix:
    classes = sorted({name for each in results for name in each.classes})
    counts = np.zeros((len(classes), len(classes) + 1), dtype=np.int64)
    for each in results:
        at = [classes.index(name) for name in each.classes]
        counts[np.ix_(at, [*at, len(classes)])] += each.confusion
    return _trimmed(Matrix(method, experiment, classes, [*classes, NOTHING], counts))


def of_tally(tally: Tally) -> Matrices:
    """Return the matrices of each cue and of all integrated."""
    return Matrices([_counted(name, tally.counts[name]) for name in reversed(tally.methods)])


def _counted(method: str, counter: Mapping[tuple[str, str], int]) -> Matrix:
    classes = sorted({truth for truth, _ in counter})
    said = sorted({decided for _, decided in counter} - set(classes))
    columns = [*classes, *said]
    counts = [[counter.get((truth, each), 0) for each in columns] for truth in classes]
    table = np.array(counts, dtype=np.int64).reshape(len(classes), len(columns))
    return Matrix(method, "", classes, columns, table)


def _trimmed(matrix: Matrix) -> Matrix:
    """Leave out the column of nothing decided where that did not happen."""
    if matrix.counts[:, -1].any():
        return matrix
    return Matrix(
        matrix.method, matrix.experiment, matrix.classes, matrix.classes, matrix.counts[:, :-1]
    )
