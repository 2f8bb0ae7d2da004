"""The squared distance from each local descriptor to the nearest one of every other sample."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.features import DescriptorSets

from .remembered import Remembered

Single = NDArray[np.float32]
Offsets = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Prepared:
    """Descriptors as BLAS wants them, in single precision.

    Parameters
    ----------
    values : ndarray of float32, shape (total, d)
        The descriptors.
    norms : ndarray of float32, shape (total,)
        Their squared lengths.
    """

    values: Single
    norms: Single

    @classmethod
    def of(cls, values: NDArray[np.floating]) -> Prepared:
        """Prepare descriptors; those that are ready are not copied.

        Raises
        ------
        DataError
            If one holds NaN or infinity.
        """
        single = np.ascontiguousarray(values, dtype=np.float32)
        norms = np.einsum("ij,ij->i", single, single)
        if not np.isfinite(norms).all():
            raise DataError(
                f"{int(np.sum(~np.isfinite(norms)))} of {len(norms)} local descriptors hold NaN or "
                "infinite numbers"
            )
        return cls(single, norms)


_prepared = Remembered(Prepared.of)


@dataclass(frozen=True, slots=True)
class Block:
    """Several whole samples of a batch.

    Parameters
    ----------
    samples : slice
        Which.
    rows : slice
        Which descriptors are theirs.
    values, norms : ndarray of float32
        Those descriptors, shape (k, d), and their squared lengths.
    starts : ndarray of int64
        Where in them each sample starts, and the end.
    """

    samples: slice
    rows: slice
    values: Single
    norms: Single
    starts: Offsets


def prepared(batch: DescriptorSets) -> Prepared:
    """Return a batch's descriptors prepared, once for as long as its array of values lives."""
    return _prepared(batch.values)


def block(batch: DescriptorSets, first: int, last: int) -> Block:
    """Return the samples from ``first`` up to, without, ``last``."""
    ready, offsets = prepared(batch), batch.offsets
    rows = slice(int(offsets[first]), int(offsets[last]))
    starts = offsets[first : last + 1] - offsets[first]
    return Block(slice(first, last), rows, ready.values[rows], ready.norms[rows], starts)


def blocks(batch: DescriptorSets, first: int, size: int) -> Iterator[Block]:
    """Yield the samples from ``first`` on in blocks of at most ``size`` descriptors, or of one."""
    while first < len(batch):
        end = batch.offsets[first] + size
        fitting = int(np.searchsorted(batch.offsets, end, side="right")) - 1
        last = max(fitting, first + 1)
        yield block(batch, first, last)
        first = last


def nearest(one: Block, many: Block, room: Single) -> tuple[Single, Single]:
    """Return both ways' squared distances to the nearest descriptor.

    Parameters
    ----------
    one : Block
        A single sample of p descriptors.
    many : Block
        m samples, of q descriptors in all.
    room : ndarray of float32, length p * q or more
        Is overwritten.

    Returns
    -------
    from_one : ndarray of float32, shape (m, p)
        From each descriptor of the one to the nearest of each sample; infinite where that has
        none.
    from_many : ndarray of float32, shape (q,)
        From each descriptor of the many to the nearest of the one.
    """
    p, q = len(one.values), len(many.values)
    products = room[: p * q].reshape(p, q)
    np.matmul(one.values, many.values.T, out=products)
    from_one = np.empty((len(many.starts) - 1, p), np.float32)
    from_many = np.full(q, np.inf, np.float32)
    _reduce(products, one.norms, many.norms, many.starts, from_one, from_many)
    return from_one, from_many


# fastmath lets the minimum run several at a time; infinities are only in what is overwritten.
@njit(cache=True, nogil=True, fastmath={"nsz", "nnan", "reassoc", "contract"})
def _reduce(
    products: NDArray[Any],
    one: NDArray[Any],
    many: NDArray[Any],
    starts: Offsets,
    from_one: NDArray[Any],
    from_many: NDArray[Any],
) -> None:
    """Take minima of |f|**2 + |g|**2 - 2 f g over the sets, both ways; rounding below 0 is cut."""
    zero, two = np.float32(0), np.float32(2)
    for s in range(len(starts) - 1):
        here = slice(starts[s], starts[s + 1])
        norms, back = many[here], from_many[here]
        for j in range(len(one)):
            row, norm, least = products[j, here], one[j], np.float32(np.inf)
            for c in range(len(norms)):
                partial = norms[c] - two * row[c]
                least = min(least, partial)
                back[c] = min(back[c], partial + norm)
            from_one[s, j] = max(least + norm, zero)
    for c in range(len(many)):
        from_many[c] = max(from_many[c], zero)
