"""A sparse histogram of beliefs over (x, y, theta): time is averaged, space is summed."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import floor
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
Key: TypeAlias = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class BinSums:
    """Scores summed over bins.

    Parameters
    ----------
    total : ndarray of float64, shape (V,), or () where there is nothing yet
        Sum of the bins' mean scores.
    bins : float
        How many bins they are worth.
    """

    total: Values = field(default_factory=lambda: np.zeros(()))
    bins: float = 0.0

    def limited(self, most: float) -> BinSums:
        """Return the sums scaled down to the weight of at most ``most`` bins."""
        if self.bins <= most:
            return self
        return BinSums(self.total * (most / self.bins), most)

    def mean(self) -> Values:
        """Return the sum divided by the number of bins, shape (V,); there must be a bin."""
        return self.total / self.bins

    def __add__(self, other: BinSums) -> BinSums:
        return BinSums(self.total + other.total, self.bins + other.bins)

    def __sub__(self, other: BinSums) -> BinSums:
        return BinSums(self.total - other.total, self.bins - other.bins)


@dataclass(slots=True)
class _Bin:
    total: Values
    count: int
    visit: int

    @property
    def mean(self) -> Values:
        return self.total / self.count


def bin_of(position: tuple[float, ...], sizes: tuple[float, ...]) -> Key:
    """Return the bin that a position is nearest to; halves go up."""
    return tuple(floor(p / size + 0.5) for p, size in zip(position, sizes, strict=True))


class ViewpointHistogram:
    """Beliefs along a trajectory, in bins that each are about one viewpoint.

    Scores that fall into one bin are averaged, so that standing still counts no more than passing
    by; over bins they are summed with equal weight. An update costs the same however long the
    robot has driven, and no more than ``forget_after`` + 1 bins are held.

    Parameters
    ----------
    forget_after : int or None
        Bins that were last visited more than this many viewpoints ago are dropped, because
        odometry drifts; a viewpoint is one entry into a bin, with scores or without. None keeps
        all.

    References
    ----------
    Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place classification,
    IJRR 29(2-3), 2010, section 5.
    """

    def __init__(self, forget_after: int | None = 30) -> None:
        self.forget_after = forget_after
        self.clear()

    def clear(self) -> None:
        """Forget every bin."""
        self._bins: OrderedDict[Key, _Bin] = OrderedDict()  # the last visited at the end
        self._here: Key | None = None
        self._visit = 0
        self._total: Values = np.zeros(())

    def visit(self, key: Key) -> None:
        """Say which bin the robot is in, whether or not there are scores to put into it."""
        if key == self._here:
            return
        self._here = key
        self._visit += 1
        if key in self._bins:
            self._bins[key].visit = self._visit
            self._bins.move_to_end(key)
        self._forget()

    def add(self, key: Key, values: Values) -> None:
        """Put scores into a bin, which the robot then is in.

        Parameters
        ----------
        key : tuple of int
            The bin; see :func:`bin_of`.
        values : ndarray of float64, shape (V,)
            Scores.
        """
        self.visit(key)
        known = self._bins.get(key)
        if known is None:
            self._bins[key] = _Bin(values.copy(), 1, self._visit)
            self._total = self._total + values
        else:
            before = known.mean
            known.total += values
            known.count += 1
            self._total = self._total + (known.mean - before)

    @property
    def visits(self) -> int:
        """How many viewpoints there were since it was last cleared."""
        return self._visit

    def keep_since(self, visit: int) -> None:
        """Forget the bins that were last visited before a viewpoint, counted by :attr:`visits`."""
        while self._bins and next(iter(self._bins.values())).visit < visit:
            self._drop()

    def _forget(self) -> None:
        while self.forget_after is not None and self._bins:
            oldest = next(iter(self._bins.values()))
            if self._visit - oldest.visit <= self.forget_after:
                return
            self._drop()

    def _drop(self) -> None:
        """Forget the bin that was not visited for the longest time."""
        _, oldest = self._bins.popitem(last=False)
        # Nothing is left of nothing, not even what rounding leaves.
        self._total = self._total - oldest.mean if self._bins else np.zeros(())

    def sums(self) -> BinSums:
        """Return the bins' means summed, and how many bins there are."""
        return BinSums(self._total, float(len(self._bins)))

    def part(self, keys: Iterable[Key]) -> BinSums:
        """Return the sums over some of the bins."""
        means = [self._bins[key].mean for key in keys]
        return BinSums(np.sum(means, axis=0), float(len(means))) if means else BinSums()

    def __iter__(self) -> Iterator[Key]:
        """Yield the bins that there are."""
        return iter(self._bins)

    def __len__(self) -> int:
        return len(self._bins)
