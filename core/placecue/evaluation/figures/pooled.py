"""The samples of all pairs of an experiment, put together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results


@dataclass(frozen=True)
class Pooled:
    """What one method says of the n samples of several pairs.

    Parameters
    ----------
    truth, decided : ndarray of str, shape (n,)
        Classes; empty where nothing was decided.
    groups : ndarray of int64, shape (n,)
        What is drawn together: scenes where a source knows them, else recordings.
    samples : ndarray, shape (n, 2)
        Which sample each is: number of its pair, and its time, ns.
    """

    truth: NDArray[Any]
    decided: NDArray[Any]
    groups: NDArray[np.int64]
    samples: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.truth)

    @property
    def accuracy(self) -> float:
        """The mean over the classes of the share that is right, %."""
        right = self.decided == self.truth
        return 100 * float(np.mean([right[self.truth == c].mean() for c in np.unique(self.truth)]))

    def at(self, samples: NDArray[np.int64]) -> Pooled:
        """Return those of some samples, in their order; all of them must be there."""
        number = {key: row for row, key in enumerate(map(tuple, self.samples.tolist()))}
        rows = [number[tuple(key)] for key in samples.tolist()]
        return Pooled(self.truth[rows], self.decided[rows], self.groups[rows], self.samples[rows])


def pooled(results: Results, method: str, experiment: str) -> Pooled:
    """Return what a method says of the samples of all pairs of an experiment."""
    every = list(dict.fromkeys(each.pair for each in results))
    of_method = results.of(method, experiment)
    truth, decided = zip(*map(_names, of_method), strict=True)
    numbers = [np.full(len(each), every.index(each.pair)) for each in of_method]
    stamps = np.concatenate([each.stamps for each in of_method])
    return Pooled(
        np.concatenate(truth),
        np.concatenate(decided),
        _groups(of_method),
        np.stack([np.concatenate(numbers), stamps], axis=1),
    )


def shared(one: Pooled, other: Pooled) -> tuple[Pooled, Pooled]:
    """Return what both say of the samples that both have."""
    if np.array_equal(one.samples, other.samples):
        return one, other
    there = set(map(tuple, other.samples.tolist()))
    both = np.array([key for key in one.samples.tolist() if tuple(key) in there], dtype=np.int64)
    return one.at(both.reshape(-1, 2)), other.at(both.reshape(-1, 2))


def _names(result: Result) -> tuple[NDArray[Any], NDArray[Any]]:
    classes = np.array([*result.classes, ""])
    return classes[result.truth], classes[result.decided]


def _groups(results: Sequence[Result]) -> NDArray[np.int64]:
    """Return numbers of scenes over all recordings; one whose scenes are not known is a scene."""
    numbers: dict[tuple[str, str, int], int] = {}
    found = []
    for each in results:
        groups = each.groups if each.groups.size else np.full(len(each), -1)
        where = each.pair.world, _recording(each.pair.test)
        found += [numbers.setdefault((*where, int(group)), len(numbers)) for group in groups]
    return np.array(found, dtype=np.int64)


def _recording(test: str) -> str:
    """Return the recording of a part: scenes that folds cut through are one."""
    return test.rsplit(" fold ", 1)[0]
