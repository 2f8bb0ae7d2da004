"""How training samples are cut into folds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import partial
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError, UsageError, described
from placecue.estimator import Estimator
from placecue.guard import call, step

Rows = NDArray[np.int64]
NANOSECONDS = 1_000_000_000


class FoldScheme(Estimator, ABC):
    """A way of cutting samples into folds.

    Parameters
    ----------
    n_folds : int
        Number of folds, two or more.

    Attributes
    ----------
    keeps : {"scene", "log"}
        What :meth:`assign` is told as ``groups``: the scene of each sample where a source knows
        scenes, else its log; or always its log.
    """

    keeps: ClassVar[Literal["scene", "log"]] = "scene"

    def __init__(self, n_folds: int = 5) -> None:
        self.n_folds = n_folds

    def check_parameters(self) -> None:
        """Raise UsageError unless there are two folds or more."""
        if not isinstance(self.n_folds, int) or self.n_folds < 2:
            raise UsageError(f"folds.n_folds must be 2 or more, got {self.n_folds!r}")

    @abstractmethod
    def assign(
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> NDArray[np.int64]:
        """Return the fold of each sample, shape (n,); -1 for one that is never held out.

        Parameters
        ----------
        labels : array of str, shape (n,)
            Class of each sample.
        stamps : array of int, shape (n,), optional
            Time of each sample, ns. Without it samples count as one every 0.2 s.
        groups : array of int, shape (n,), optional
            What each sample is of, its log or its scene; see :attr:`keeps`.
        """

    def kept_together(self, groups: ArrayLike | None) -> NDArray[Any] | None:
        """Return what :meth:`assign` is told, shape (n,), of groups as a training set has them.

        Parameters
        ----------
        groups : array of int, shape (n,) or (n, 2), optional
            The log of each sample; or the log and the scene, these numbered over all logs.
        """
        if groups is None:
            return None
        known = np.asarray(groups)
        return known if known.ndim < 2 else known[:, 0 if self.keeps == "log" else -1]

    def split(
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> Iterator[tuple[Rows, Rows]]:
        """Yield (training rows, held-out rows) for each fold; see :meth:`assign`.

        Groups may have the columns log and scene; see :meth:`kept_together`.

        Every class is in the training rows of every fold: a fold that would take away the whole
        of a class leaves that class's samples in training and does not score them. Folds that
        hold nothing out, as of fewer samples than folds, are passed over.

        Raises
        ------
        UsageError
            If a parameter cannot be what it is.
        DataError
            If a class has one sample only, or no fold holds a sample out.
        """
        self.check_parameters()
        labels = np.asarray(labels)
        classes, counts = np.unique(labels, return_counts=True)
        if counts.min(initial=2) < 2:
            alone = classes[counts.argmin()]
            raise DataError(
                f"class '{alone}' has one sample only; cross-validation needs two or more of each "
                "class: record more of it, or drop it"
            )
        check = partial(promised, n=len(labels), n_folds=self.n_folds)
        fold = call(self, "assign", labels, stamps, self.kept_together(groups), check=check)
        rows = np.arange(len(labels))
        empty = True
        for number in range(self.n_folds):
            held_out = fold == number
            for name in classes:
                of_class = labels == name
                if held_out[of_class].all():
                    held_out &= ~of_class
            if held_out.any():
                empty = False
                yield rows[~held_out], rows[held_out]
        if empty:
            raise DataError(
                f"none of the {len(labels)} samples can be held out: no class is in two folds of "
                f"{type(self).__name__}; give more samples, or choose other folds"
            )


def cut(
    scheme: FoldScheme,
    labels: ArrayLike,
    stamps: ArrayLike | None = None,
    groups: ArrayLike | None = None,
    *,
    part: bool = False,
) -> list[tuple[Rows, Rows]]:
    """Return what :meth:`FoldScheme.split` of a scheme yields, checked.

    Parameters
    ----------
    scheme : FoldScheme
    labels, stamps, groups
        Of n samples; see :meth:`FoldScheme.split`.
    part : bool
        Whether they are what is left of some samples, in a fold, say. Where the scheme cannot cut
        that, it is cut into interleaved chunks: of two logs, each fold of ``by_log`` leaves one.
    """

    def split() -> list[Any]:
        return list(scheme.split(labels, stamps, scheme.kept_together(groups)))

    check = partial(parted, n=len(np.asarray(labels)))
    try:
        splits: list[tuple[Rows, Rows]] = step(scheme, "split", split, check=check)
    except DataError:
        if not part:
            raise
        return list(InterleavedChunks(scheme.n_folds).split(labels, stamps, groups))
    return splits


def parted(made: list[Any], n: int) -> str | None:
    """Check the folds of n samples: rows to train on and others to hold out."""
    for fold in made:
        if not isinstance(fold, tuple) or len(fold) != 2:
            return f"yielded {described(fold)}, not training rows and held-out rows"
        for rows in fold:
            if not isinstance(rows, np.ndarray) or rows.dtype.kind not in "iu" or rows.ndim != 1:
                return f"yielded {described(rows)} as rows, not an array of whole numbers"
            if not rows.size or rows.min() < 0 or rows.max() >= n:
                return f"yielded rows of which none, or not all, are of the {n} samples"
        if np.intersect1d(*fold).size:
            return "yielded a fold that holds out samples which it trains on"
    return None


def promised(made: Any, n: int, n_folds: int) -> str | None:
    """Check the fold of each of n samples: -1 (never held out) to ``n_folds`` - 1."""
    if not isinstance(made, np.ndarray) or made.dtype.kind not in "iu":
        what = f"an array of {made.dtype}" if isinstance(made, np.ndarray) else described(made)
        return f"returned {what}, not whole numbers, shape ({n},)"
    if made.shape != (n,):
        return f"returned an array of shape {made.shape}, not ({n},)"
    if n and (made.min() < -1 or made.max() >= n_folds):
        return f"returned folds {made.min()} to {made.max()}, not -1 to {n_folds - 1}"
    return None


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

    def __init__(self, n_folds: int = 5, seconds: float = 2.0) -> None:
        super().__init__(n_folds)
        self.seconds = seconds

    def check_parameters(self) -> None:  # noqa: D102
        super().check_parameters()
        if self.seconds <= 0:
            raise UsageError(f"folds.seconds must be above 0, got {self.seconds}")

    def assign(  # noqa: D102
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
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
                fold[rows] = _fractions(times[rows], self.n_folds)
        return fold % self.n_folds


class Blocks(FoldScheme):
    """Contiguous fractions of each class, in the order of the samples."""

    def assign(  # noqa: D102
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> NDArray[np.int64]:
        labels = np.asarray(labels)
        times = _times(len(labels), stamps)
        fold = np.empty(len(labels), dtype=np.int64)
        for name in np.unique(labels):
            rows = np.flatnonzero(labels == name)
            fold[rows] = _fractions(times[rows], self.n_folds)
        return fold


class Shuffled(FoldScheme):
    """Samples of each class dealt to the folds at random.

    Neighbouring frames of a sequence are near-copies, so this flatters; it is for samples that
    were taken one by one.

    Parameters
    ----------
    n_folds : int
        Number of folds.
    seed : int
        Of the random numbers.
    """

    def __init__(self, n_folds: int = 5, seed: int = 0) -> None:
        super().__init__(n_folds)
        self.seed = seed

    def assign(  # noqa: D102
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> NDArray[np.int64]:
        labels = np.asarray(labels)
        times = _times(len(labels), stamps)
        generator = np.random.default_rng(self.seed)
        fold = np.empty(len(labels), dtype=np.int64)
        for name in np.unique(labels):
            rows = np.flatnonzero(labels == name)
            moments = _moments(times[rows])
            count = moments[-1] + 1
            dealt = np.empty(count, dtype=np.int64)
            dealt[generator.permutation(count)] = np.arange(count) % self.n_folds
            fold[rows] = dealt[moments]
        return fold


class ByLog(FoldScheme):
    """Whole logs: train on the others, test on one.

    A new log begins where the group changes, where time goes back, or where nothing was recorded
    for a while.

    Parameters
    ----------
    n_folds : int
        Number of folds at most; logs are dealt to them in turn.
    gap : float
        Silence after which another log begins, s.
    only_last : bool
        Hold out the last log only (train on the first sequence, test on the second), or each in
        turn.
    """

    keeps: ClassVar[Literal["scene", "log"]] = "log"

    def __init__(self, n_folds: int = 5, gap: float = 60.0, only_last: bool = False) -> None:
        super().__init__(n_folds)
        self.gap = gap
        self.only_last = only_last

    def check_parameters(self) -> None:  # noqa: D102
        super().check_parameters()
        if self.gap <= 0:
            raise UsageError(f"folds.gap must be above 0, got {self.gap}")

    def assign(
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> NDArray[np.int64]:
        """Return the fold of each sample, shape (n,); see :meth:`FoldScheme.assign`.

        Raises
        ------
        DataError
            If the samples are of one log.
        """
        times = _times(len(np.asarray(labels)), stamps)
        step = np.diff(times, prepend=times[:1])
        new = (step < 0) | (step > self.gap * NANOSECONDS)
        if groups is not None:
            of = np.asarray(groups)
            new |= np.diff(of, prepend=of[:1]) != 0
        log = np.cumsum(new)
        last = int(log.max(initial=0))
        if last == 0:
            raise DataError(
                f"folds by_log need two logs or more, and the {len(log)} samples look "
                f"like one: no {self.gap:g} s without a sample; give another log, or choose other "
                "folds, such as interleaved"
            )
        if self.only_last:
            return np.where(log == last, 0, -1)
        return np.asarray(log % self.n_folds)


def _moments(times: NDArray[np.int64]) -> Rows:
    """Return the number of each sample's moment, 0, 1 ...; altered copies of one follow it."""
    moments = np.cumsum(np.diff(times, prepend=times[:1]) != 0)
    # Without any time between them the samples can only be told apart by their order.
    return moments if moments[-1] else np.arange(len(times))


def _fractions(times: NDArray[np.int64], n_folds: int) -> Rows:
    """Return the fold of each sample of a class where every fold is a contiguous fraction."""
    moments = _moments(times)
    return np.asarray(moments * n_folds // (moments[-1] + 1))


def _times(n: int, stamps: ArrayLike | None) -> NDArray[np.int64]:
    if stamps is None:
        return np.arange(n, dtype=np.int64) * (NANOSECONDS // 5)
    return np.asarray(stamps, dtype=np.int64)
