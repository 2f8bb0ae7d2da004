"""The three kinds of features that a cue may give, and batches of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.errors import UsageError


class FeatureKind(StrEnum):
    """What the features of one observation look like."""

    DENSE = "dense vector"
    SPARSE = "sparse histogram"
    DESCRIPTORS = "set of local descriptors"


@dataclass(frozen=True, slots=True)
class DescriptorSets:
    """A batch of sets of local descriptors, one set a sample, stored end to end.

    Parameters
    ----------
    values : ndarray, shape (total, d)
        All descriptors.
    offsets : ndarray of int64, shape (n + 1,)
        Sample i owns the rows ``offsets[i]`` to ``offsets[i + 1]``; a set may be empty.
    """

    values: NDArray[np.floating]
    offsets: NDArray[np.int64]

    @property
    def shape(self) -> tuple[int, int]:
        """Number of samples, and length of one descriptor."""
        return len(self.offsets) - 1, self.values.shape[1]

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, rows: NDArray[np.integer] | NDArray[np.bool_]) -> DescriptorSets:
        rows = np.arange(len(self))[rows]
        sets = [self.values[self.offsets[i] : self.offsets[i + 1]] for i in rows]
        return _stack_descriptors(sets, self.values.shape[1])


#: Features of one observation.
Features: TypeAlias = NDArray[np.floating] | sparse.csr_array
#: Features of n observations: (n, d) array, (n, bins) CSR, or n descriptor sets.
FeatureBatch: TypeAlias = NDArray[np.floating] | sparse.csr_array | DescriptorSets


def kind_of(batch: FeatureBatch) -> FeatureKind:
    """Return the kind of a batch of features."""
    if isinstance(batch, DescriptorSets):
        return FeatureKind.DESCRIPTORS
    return FeatureKind.SPARSE if sparse.issparse(batch) else FeatureKind.DENSE


def n_samples(batch: FeatureBatch) -> int:
    """Return the number of samples in a batch."""
    return int(batch.shape[0])


def stack(features: Sequence[Features]) -> FeatureBatch:
    """Join the features of single observations into a batch.

    Parameters
    ----------
    features : sequence of ndarray or csr_array
        Vectors of shape (d,), CSR rows of shape (1, bins), or descriptor sets of shape (k, d).

    Returns
    -------
    ndarray of shape (n, d), csr_array of shape (n, bins), or DescriptorSets of n sets

    Raises
    ------
    UsageError
        If there is nothing to stack, or the features do not fit one another.
    """
    if not features:
        raise UsageError("no features to stack: give at least one observation")
    first = features[0]
    try:
        if sparse.issparse(first):
            return sparse.csr_array(sparse.vstack(features, format="csr"))
        dense = [np.asarray(f) for f in features]
        if dense[0].ndim == 1:
            return np.stack(dense)
        return _stack_descriptors(dense, dense[0].shape[1])
    except ValueError as error:
        shapes = sorted({str(f.shape) for f in features})
        raise UsageError(
            f"features of different shapes in one batch: {', '.join(shapes)}"
        ) from error


def single(batch: FeatureBatch, row: int) -> Features:
    """Return the features of one sample of a batch, as :func:`stack` took them in."""
    if isinstance(batch, DescriptorSets):
        return batch.values[batch.offsets[row] : batch.offsets[row + 1]]
    return batch[[row]] if sparse.issparse(batch) else batch[row]


def join(batches: Sequence[FeatureBatch]) -> FeatureBatch:
    """Return batches of one kind, one after the other."""
    first = batches[0]
    if isinstance(first, DescriptorSets):
        sets = [single(batch, row) for batch in batches for row in range(n_samples(batch))]
        return _stack_descriptors(sets, first.values.shape[1])
    if sparse.issparse(first):
        return sparse.csr_array(sparse.vstack(batches, format="csr"))
    return np.concatenate(batches)  # type: ignore[arg-type]


def take(batch: FeatureBatch, rows: NDArray[np.integer] | NDArray[np.bool_]) -> FeatureBatch:
    """Return the given rows of a batch, by index or mask."""
    return batch[rows]


def spoilt_rows(features: FeatureBatch) -> NDArray[np.int64]:
    """Return the samples that hold a NaN or infinite number, shape (k,)."""
    if isinstance(features, DescriptorSets):
        starts = features.offsets
        places = np.flatnonzero(~np.isfinite(features.values).all(axis=1))
    elif sparse.issparse(features):
        csr = sparse.csr_array(features)
        starts, places = csr.indptr, np.flatnonzero(~np.isfinite(csr.data))
    else:
        return np.flatnonzero(~np.isfinite(features).all(axis=1))
    return np.unique(np.searchsorted(starts, places, side="right") - 1)


def _stack_descriptors(sets: Sequence[NDArray[np.floating]], d: int) -> DescriptorSets:
    offsets = np.concatenate([[0], np.cumsum([len(s) for s in sets])]).astype(np.int64)
    dtype = sets[0].dtype if sets else np.float32
    return DescriptorSets(np.concatenate([np.empty((0, d), dtype), *sets]), offsets)
