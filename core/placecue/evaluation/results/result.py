"""What one method says of one recording when trained on others: the result of a pair."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Pair(NamedTuple):
    """Recordings that models are trained on, and one that they are tested on.

    Parameters
    ----------
    experiment : str
        What pairs are summed up by, such as ``Exp 1``.
    world : str
        What results are averaged within before they are averaged over, such as ``world 0``; empty
        where there is one.
    train : tuple of str
        Names of recordings, or parts of one.
    test : str
        Name of a recording, or a part of one.
    """

    experiment: str
    world: str
    train: tuple[str, ...]
    test: str

    def __str__(self) -> str:
        where = f"{self.world}: " if self.world else ""
        return f"{where}{' + '.join(self.train)} → {self.test}"


@dataclass(frozen=True)
class Result:
    """What one method says of the n labelled samples of a test recording.

    Parameters
    ----------
    pair : Pair
        What was trained and tested on.
    method : str
        The method's name in the experiment.
    classes : tuple of str
        Every class of the truth and of the model, sorted.
    truth, decided : ndarray of int16, shape (n,)
        Numbers of classes; -1 where nothing was decided.
    confidence : ndarray of float32, shape (n,)
        Of the decisions; NaN where there is none.
    stamps : ndarray of int64, shape (n,)
        Times of the samples, ns.
    groups : ndarray of int64, shape (n,) or (0,)
        The scene of each sample where a source knows scenes, else its log; empty if not known.
    used : mapping of str to ndarray of bool, shape (n,)
        For which samples each cue was asked.
    seconds : mapping of str to float
        What each step took: ``training``, ``fitting``, ``testing``; empty where it was shared.
    settings : mapping
        What a parameter search chose, by name.
    error : str
        Why there is no result, in one line; empty where there is one.
    digest : str
        Of all that decides the result.
    """

    pair: Pair
    method: str
    classes: tuple[str, ...]
    truth: NDArray[np.int16]
    decided: NDArray[np.int16]
    confidence: NDArray[np.float32]
    stamps: NDArray[np.int64]
    groups: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    used: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    error: str = ""
    digest: str = ""

    @classmethod
    def failed(cls, pair: Pair, method: str, error: str, digest: str = "") -> Result:
        """Return the result of a pair that came to nothing."""
        none = np.empty(0, dtype=np.int16)
        nothing = none.astype(np.float32), none.astype(np.int64)
        return cls(pair, method, (), none, none, *nothing, error=error, digest=digest)

    def __len__(self) -> int:
        return len(self.truth)

    @cached_property
    def confusion(self) -> NDArray[np.int64]:
        """How often each class (rows) was taken for which, shape (M, M + 1).

        The last column counts samples of which nothing was decided.
        """
        m = len(self.classes)
        counts = np.zeros((m, m + 1), dtype=np.int64)
        np.add.at(counts, (self.truth, np.where(self.decided < 0, m, self.decided)), 1)
        return counts

    @property
    def recalls(self) -> dict[str, float]:
        """The share of each class that was recognised; of classes that are there to be."""
        right, there = np.diagonal(self.confusion), self.confusion.sum(axis=1)
        return {
            name: float(right[at] / there[at]) for at, name in enumerate(self.classes) if there[at]
        }

    @property
    def absent(self) -> tuple[str, ...]:
        """Classes of the model of which the recording has no sample: their recall is undefined."""
        return tuple(name for name in self.classes if name not in self.recalls)

    @property
    def score(self) -> float:
        """The mean of the recalls (balanced accuracy), 0 to 1; NaN where there is no result.

        References
        ----------
        Pronobis et al., IJRR 29(2-3), 2010, section 6.1.
        """
        return float(np.mean(list(self.recalls.values()))) if self.recalls else float("nan")
