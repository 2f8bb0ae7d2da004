"""The results of an experiment, looked at by method and pair."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.store import ResultStore


class Results:
    """Results of several methods on the same pairs, as far as there are any.

    Parameters
    ----------
    results : iterable of Result
        In the order in which methods and experiments are to be shown.
    """

    def __init__(self, results: Iterable[Result]) -> None:
        self._by_key = {(each.method, each.pair): each for each in results}

    def __iter__(self) -> Iterator[Result]:
        return iter(self._by_key.values())

    def __len__(self) -> int:
        return len(self._by_key)

    @property
    def methods(self) -> list[str]:
        """The methods, in the order of the results."""
        return list(dict.fromkeys(each.method for each in self))

    @property
    def experiments(self) -> list[str]:
        """The experiments, in the order of the results."""
        return list(dict.fromkeys(each.pair.experiment for each in self))

    @property
    def worlds(self) -> list[str]:
        """The worlds, in the order of the results."""
        return list(dict.fromkeys(each.pair.world for each in self))

    @property
    def failed(self) -> list[Result]:
        """Those that came to nothing."""
        return [each for each in self if each.error]

    def of(
        self, method: str | None = None, experiment: str | None = None, world: str | None = None
    ) -> list[Result]:
        """Return the results of a method, an experiment, a world; of all where none is named.

        Results that came to nothing are left out.
        """
        return [
            each
            for each in self
            if not each.error
            and method in (None, each.method)
            and experiment in (None, each.pair.experiment)
            and world in (None, each.pair.world)
        ]

    def get(self, method: str, pair: Pair) -> Result | None:
        """Return what a method says of a pair, None where there is nothing."""
        found = self._by_key.get((method, pair))
        return None if found is None or found.error else found

    def scores(self, method: str, experiment: str | None = None) -> dict[Pair, float]:
        """Return the balanced accuracy of a method on each pair, 0 to 1."""
        self.check(method)
        return {each.pair: each.score for each in self.of(method, experiment)}

    def paired(
        self, methods: Sequence[str], experiment: str | None = None
    ) -> tuple[list[Pair], NDArray[np.float64]]:
        """Return the pairs that all of some methods have a result of, and their scores.

        Returns
        -------
        list of n Pair
        ndarray of float64, shape (n, len(methods))
            Balanced accuracy, 0 to 1: what paired significance tests take.
        """
        of_method = [self.scores(method, experiment) for method in methods]
        pairs = [pair for pair in of_method[0] if all(pair in each for each in of_method)]
        table = [[each[pair] for each in of_method] for pair in pairs]
        return pairs, np.array(table, dtype=np.float64).reshape(len(pairs), len(methods))

    def check(self, method: str) -> None:
        """Raise UsageError where there is no such method."""
        if method not in self.methods:
            raise UsageError(f"no results of method '{method}'; {choices(method, self.methods)}")

    def save(self, folder: Path) -> None:
        """Keep every result that is one in a folder."""
        store = ResultStore(folder)
        for each in self:
            if not each.error:
                store.save(each)
