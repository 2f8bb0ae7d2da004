"""How training samples are cut into folds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError

Rows = NDArray[np.int64]
NANOSECONDS = 1_000_000_000


@dataclass(frozen=True, slots=True)
class FoldScheme(ABC):
    """A way of cutting samples into folds.

    Parameters
    ----------
    n_folds : int
        Number of folds.
    """

    n_folds: int = 5

    @abstractmethod
    def assign(self, labels: ArrayLike, stamps: ArrayLike | None = None) -> NDArray[np.int64]:
        """Return the fold of each sample, shape (n,).

        Parameters
        ----------
        labels : array of str, shape (n,)
            Class of each sample.
        stamps : array of int, shape (n,), optional
            Time of each sample, ns. Without it samples count as one every 0.2 s.
        """

    def split(
        self, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Iterator[tuple[Rows, Rows]]:
        """Yield (training rows, held-out rows) for each fold.

        Every class is in the training rows of every fold: a fold that would take away the whole
        of a class leaves that class's samples in training and does not score them.

        Raises
        ------
        DataError
            If a class has one sample only.
        """
        labels = np.asarray(labels)
        classes, counts = np.unique(labels, return_counts=True)
        if counts.min(initial=2) < 2:
            alone = classes[counts.argmin()]
            raise DataError(
                f"class '{alone}' has one sample only; cross-validation needs two or more of each "
                "class: record more of it, or drop it"
            )
        fold = self.assign(labels, stamps)
        rows = np.arange(len(labels))
        for number in range(self.n_folds):
            held_out = fold == number
            for name in classes:
                of_class = labels == name
                if held_out[of_class].all():
                    held_out &= ~of_class
            if held_out.any():
                yield rows[~held_out], rows[held_out]


@dataclass(frozen=True, slots=True)
class InterleavedChunks(FoldScheme):
    """Chunks of a few seconds, cut within each class and dealt to the folds in turn.

    Neighbouring frames are near-copies, so shuffling them flatters; a contiguous fifth takes away
    places that the robot passes only once.

    Parameters
    ----------
    n_folds : int
        Number of folds.
    seconds : float
        Length of a chunk, s.
    """

    seconds: float = 2.0

    def assign(  # noqa: D102
        self, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> NDArray[np.int64]:
        labels = np.asarray(labels)
        length = int(self.seconds * NANOSECONDS)
        times = _times(len(labels), stamps)
        fold = np.empty(len(labels), dtype=np.int64)
        for name in np.unique(labels):
            rows = np.flatnonzero(labels == name)
            # A chunk ends when it is long enough, when the robot left the class, or at a new log.
            step = np.diff(times[rows], prepend=times[rows[0]])
            chunk, started = 0, times[rows[0]]
            for row, passed in zip(rows, step, strict=True):
                if passed < 0 or passed > length or times[row] - started >= length:
                    chunk, started = chunk + 1, times[row]
                fold[row] = chunk
            # A class of a single chunk is cut into n_folds pieces instead, to be scored at all.
            if chunk + 1 < 2:
                fold[rows] = np.arange(len(rows)) * self.n_folds // len(rows)
        return fold % self.n_folds


@dataclass(frozen=True, slots=True)
class Blocks(FoldScheme):
    """Contiguous fractions of each class, in the order of the samples."""

    def assign(  # noqa: D102
        self, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> NDArray[np.int64]:
        labels = np.asarray(labels)
        fold = np.empty(len(labels), dtype=np.int64)
        for name in np.unique(labels):
            rows = np.flatnonzero(labels == name)
            fold[rows] = np.arange(len(rows)) * self.n_folds // len(rows)
        return fold


FOLD_SCHEMES: dict[str, type[FoldScheme]] = {"interleaved": InterleavedChunks, "blocks": Blocks}


def _times(n: int, stamps: ArrayLike | None) -> NDArray[np.int64]:
    if stamps is None:
        return np.arange(n, dtype=np.int64) * (NANOSECONDS // 5)
    return np.asarray(stamps, dtype=np.int64)
