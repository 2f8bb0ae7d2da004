"""The match kernel between sets of local descriptors."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from tempfile import TemporaryFile
from typing import Any, ClassVar, cast

import joblib
import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from placecue.errors import UsageError
from placecue.features import DescriptorSets, FeatureBatch, FeatureKind
from placecue.kernel import DistanceKernel, Gram

from .columns import check_same_width
from .nearest import Block, Offsets, Single, block, blocks, nearest, prepared

#: Descriptors matched at a time: their products with one sample's stay in the cache.
_BLOCK = 1024
_GIGA = 1e9


@dataclass(frozen=True, slots=True)
class MatchedDistances:
    """Squared distances from each descriptor to the nearest one in each sample of the other batch.

    Parameters
    ----------
    from_a : ndarray of float32, shape (m, descriptors of a)
    from_b : ndarray of float32, shape (n, descriptors of b)
        The very array ``from_a`` where a batch is matched with itself.
    a, b : ndarray of int64
        Where each sample's descriptors start, and the end.
    """

    from_a: Single
    from_b: Single
    a: Offsets
    b: Offsets


class Match(DistanceKernel):
    """How well the local descriptors of two images find counterparts in one another.

    K(x, y) is the mean of two averages: over the descriptors f of x, of the largest
    exp(-gamma ||f - g||**2) with g in y; and the same from y to x. A sample without descriptors
    has K = 0 with every other and 1 with itself (a batch given once is matched with itself).

    The kernel is not positive definite in general; LIBSVM copes. Distances are computed in single
    precision through BLAS, for which descriptors should not lie far from zero compared with their
    distances. A search over gamma keeps the nearest distances, four bytes for each descriptor and
    sample, so that each gamma costs one exponential for each of them.

    Parameters
    ----------
    gamma : float
        How fast likeness falls with distance: 0.1 to 2 on descriptors of unit length; 10 and more
        is chance.
    memory : float
        Nearest distances that take more than this are kept in a temporary file, GB.
    n_jobs : int, optional
        Threads that match side by side; by default what joblib's backend is set to, or else as
        many as BLAS may use (``OMP_NUM_THREADS``).

    References
    ----------
    Wallraven, Caputo and Graf, Recognition with local features: the kernel recipe, ICCV 2003.
    """

    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.DESCRIPTORS})
    positive_definite: ClassVar[bool] = False

    def __init__(self, gamma: float = 1.0, memory: float = 2.0, n_jobs: int | None = None) -> None:
        super().__init__(gamma)
        self.memory = memory
        self.n_jobs = n_jobs

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> MatchedDistances:
        """Return the nearest squared distances both ways.

        Raises
        ------
        UsageError
            If a batch holds no descriptor sets, or the lengths of descriptors differ.
        DataError
            If a descriptor holds NaN or infinity.
        """
        left, right = self._checked(a, b)
        from_b = self._array((len(left), len(right.values)))
        from_a = from_b if b is None else self._array((len(right), len(left.values)))

        def keep(one: Block, many: Block, found: tuple[Single, Single]) -> None:
            from_a[many.samples, one.rows], from_b[one.samples, many.rows] = found

        self._match(left, right, b is None, keep)
        return MatchedDistances(from_a, from_b, left.offsets, right.offsets)

    def from_shared(self, shared: MatchedDistances) -> Gram:
        """Return the kernel from the nearest distances, shape (n, m)."""
        within = shared.from_a is shared.from_b
        to_a = np.stack([self._average(row, shared.b) for row in shared.from_b])
        if within:
            return _finished(to_a / 2 + to_a.T / 2)
        to_b = np.stack([self._average(row, shared.a) for row in shared.from_a])
        return np.asarray((to_a + to_b.T) / 2)

    def gram(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel without keeping the nearest distances, shape (n, m).

        Raises
        ------
        UsageError, DataError
            As :meth:`shared`.
        """
        left, right = self._checked(a, b)
        gram = np.zeros((len(left), len(right)))

        def add(one: Block, many: Block, found: tuple[Single, Single]) -> None:
            size = len(one.norms)
            from_one = np.exp(-self.gamma * found[0]).sum(axis=1, dtype=np.float64) / max(size, 1)
            gram[one.samples, many.samples] = (from_one + self._average(found[1], many.starts)) / 2

        self._match(left, right, b is None, add)
        if b is not None:
            return gram
        lower = np.tril_indices(len(left), -1)
        gram[lower] = gram.T[lower]
        return _finished(gram)

    def _checked(
        self, a: FeatureBatch, b: FeatureBatch | None
    ) -> tuple[DescriptorSets, DescriptorSets]:
        self.check(a, b)
        if b is not None:
            check_same_width(a, b)
        if self.n_jobs == 0:
            raise UsageError("match needs n_jobs above 0, -1 for every core, or null, got 0")
        if not (self.gamma > 0 and self.memory >= 0):
            raise UsageError(
                f"match needs gamma > 0 and memory >= 0 GB, got {self.gamma} and {self.memory}"
            )
        return cast(DescriptorSets, a), cast(DescriptorSets, a if b is None else b)

    def _array(self, shape: tuple[int, int]) -> Single:
        """Return room for distances, in memory or, if that is too much, in a temporary file."""
        if 4 * shape[0] * shape[1] <= self.memory * _GIGA:
            return np.zeros(shape, np.float32)
        with TemporaryFile() as file:  # the map outlives the closed and nameless file
            return np.memmap(file, np.float32, "w+", shape=shape)

    def _match(
        self,
        a: DescriptorSets,
        b: DescriptorSets,
        within: bool,
        found: Callable[[Block, Block, tuple[Single, Single]], None],
    ) -> None:
        """Match each sample of ``a`` with all of ``b``, or with those from itself on."""

        def match(one: Block, others: Iterable[Block]) -> None:
            room = np.empty(len(one.norms) * _widest(b), np.float32)
            for many in others:
                found(one, many, nearest(one, many, room))

        prepared(b)
        firsts = range(len(a)) if within else [0] * len(a)
        queue = ((block(a, i, i + 1), blocks(b, first, _BLOCK)) for i, first in enumerate(firsts))
        n_jobs = self._threads()
        if n_jobs == 1:
            for each in queue:
                match(*each)
            return
        if len(a) == 1:  # a live robot's image: its threads share the other samples
            one, others = next(queue)
            listed = list(others)
            queue = ((one, iter(listed[job::n_jobs])) for job in range(n_jobs))
        # Not joblib, whose threads take longer to start than one image takes to match.
        with _blas().limit(limits=1), ThreadPoolExecutor(n_jobs) as threads:
            try:
                for done in [threads.submit(match, *each) for each in queue]:
                    done.result()
            except BaseException:
                threads.shutdown(wait=False, cancel_futures=True)
                raise

    def _threads(self) -> int:
        n_jobs: int = joblib.effective_n_jobs(self.n_jobs)
        if self.n_jobs is not None or n_jobs > 1:
            return n_jobs
        # Whole samples shared out among threads wait for one another less than BLAS's own do.
        return max((each.num_threads for each in _blas().lib_controllers), default=1)

    def _average(self, squared: NDArray[Any], offsets: Offsets) -> Gram:
        """Return the mean of exp(-gamma squared) over each sample's descriptors, 0 for none."""
        sizes = np.diff(offsets)
        likeness = np.exp(-self.gamma * squared)
        sums = np.add.reduceat(likeness, offsets[:-1][sizes > 0]) if len(likeness) else likeness
        means = np.zeros(len(sizes))
        means[sizes > 0] = sums / sizes[sizes > 0]
        return means


@cache
def _blas() -> ThreadpoolController:
    """Return what sets the threads of BLAS; finding the libraries takes milliseconds."""
    return ThreadpoolController().select(user_api="blas")


def _widest(batch: DescriptorSets) -> int:
    """Return the largest number of descriptors that a block of the batch may hold."""
    return max(_BLOCK, int(np.diff(batch.offsets).max(initial=0)))


def _finished(gram: Gram) -> Gram:
    """Set the kernel of each sample with itself to an exact 1."""
    np.fill_diagonal(gram, 1)
    return gram
