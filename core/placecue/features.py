"""The kinds of features that a cue may give, and batches of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.errors import UsageError


class FeatureKind(StrEnum):
    """What the features of one observation look like."""

    DENSE = "dense vector"
    SPARSE = "sparse histogram"
    DESCRIPTORS = "set of local descriptors"
    PARTS = "features in parts"


@dataclass(frozen=True, slots=True, weakref_slot=True)
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


#: Features of n observations in one piece: (n, d) array, (n, bins) CSR, or n descriptor sets.
OnePart: TypeAlias = NDArray[np.floating] | sparse.csr_array | DescriptorSets


@dataclass(frozen=True, slots=True, weakref_slot=True)
class FeatureParts:
    """A batch of features that come in named parts, each of a kind of its own.

    Parameters
    ----------
    parts : mapping of str to batch of n samples
        Each dense, sparse or descriptor sets; one or more, and the same n samples in all.
    """

    parts: Mapping[str, OnePart]

    @property
    def shape(self) -> tuple[int, int]:
        """Number of samples, and the widths of all parts together."""
        shapes = [part.shape for part in self.parts.values()]
        return int(shapes[0][0]), sum(int(shape[1]) for shape in shapes)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, rows: NDArray[np.integer] | NDArray[np.bool_]) -> FeatureParts:
        return FeatureParts({name: part[rows] for name, part in self.parts.items()})

    def copy(self) -> FeatureParts:
        """Return the same with arrays of its own."""
        return self[np.arange(len(self))]


#: Features of one observation; those in parts are a batch of one.
Features: TypeAlias = NDArray[np.floating] | sparse.csr_array | FeatureParts
#: Features of n observations, in one piece or in parts.
FeatureBatch: TypeAlias = OnePart | FeatureParts
#: The family of each of d features; of features in parts, by the parts of which it is known.
Families: TypeAlias = Sequence[str] | Mapping[str, Sequence[str]]


def kind_of(batch: FeatureBatch) -> FeatureKind:
    """Return the kind of a batch of features."""
    if isinstance(batch, FeatureParts):
        return FeatureKind.PARTS
    if isinstance(batch, DescriptorSets):
        return FeatureKind.DESCRIPTORS
    return FeatureKind.SPARSE if sparse.issparse(batch) else FeatureKind.DENSE


def n_samples(batch: FeatureBatch) -> int:
    """Return the number of samples in a batch."""
    return int(batch.shape[0])


def form(batch: FeatureBatch) -> str:
    """Return in words what features of one cue must have in common: kind, width and parts."""
    if isinstance(batch, FeatureParts):
        return " with ".join(
            f"{form(part)} as {name}" for name, part in sorted(batch.parts.items())
        )
    return f"a {kind_of(batch)} of width {batch.shape[1]}"


def stack(features: Sequence[Features]) -> FeatureBatch:
    """Join the features of single observations into a batch.

    Parameters
    ----------
    features : sequence of ndarray or csr_array
        Vectors of shape (d,), CSR rows of shape (1, bins), descriptor sets of shape (k, d), or
        parts of one sample each.

    Returns
    -------
    ndarray of shape (n, d), csr_array of shape (n, bins), or DescriptorSets or FeatureParts of n

    Raises
    ------
    UsageError
        If there is nothing to stack, or the features do not fit one another.
    """
    if not features:
        raise UsageError("no features to stack: give at least one observation")
    first = features[0]
    try:
        if sparse.issparse(first) or isinstance(first, FeatureParts):
            return join(features)
        dense = [np.asarray(f) for f in features]
        if dense[0].ndim == 1:
            return np.stack(dense)
        return _stack_descriptors(dense, dense[0].shape[1])
    except ValueError as error:
        shapes = sorted(
            {form(f) if isinstance(f, FeatureParts) else str(f.shape) for f in features}
        )
        raise UsageError(
            f"features of different shapes in one batch: {', '.join(shapes)}"
        ) from error


def single(batch: FeatureBatch, row: int) -> Features:
    """Return the features of one sample of a batch, as :func:`stack` took them in."""
    if isinstance(batch, DescriptorSets):
        return batch.values[batch.offsets[row] : batch.offsets[row + 1]]
    if isinstance(batch, FeatureParts):
        return batch[np.array([row])]
    return batch[[row]] if sparse.issparse(batch) else batch[row]


def join(batches: Sequence[FeatureBatch]) -> FeatureBatch:
    """Return batches of one kind, one after the other."""
    first = batches[0]
    if isinstance(first, FeatureParts):
        return _join_parts(batches)
    if isinstance(first, DescriptorSets):
        sets: list[Any] = [single(each, row) for each in batches for row in range(n_samples(each))]
        return _stack_descriptors(sets, first.values.shape[1])
    if sparse.issparse(first):
        return sparse.csr_array(sparse.vstack(batches, format="csr"))
    return np.concatenate(batches)  # type: ignore[arg-type]


def take(batch: FeatureBatch, rows: NDArray[np.integer] | NDArray[np.bool_]) -> FeatureBatch:
    """Return the given rows of a batch, by index or mask."""
    return batch[rows]


def spoilt_rows(features: FeatureBatch) -> NDArray[np.int64]:
    """Return the samples that hold a NaN or infinite number, shape (k,), sorted."""
    if isinstance(features, FeatureParts):
        spoilt = [spoilt_rows(part) for part in features.parts.values()]
        return np.unique(np.concatenate(spoilt)).astype(np.int64)
    if isinstance(features, DescriptorSets):
        starts = features.offsets
        places = np.flatnonzero(~np.isfinite(features.values).all(axis=1))
    elif sparse.issparse(features):
        csr = sparse.csr_array(features)
        starts, places = csr.indptr, np.flatnonzero(~np.isfinite(csr.data))
    else:
        return np.flatnonzero(~np.isfinite(features).all(axis=1))
    return np.unique(np.searchsorted(starts, places, side="right") - 1)


def _join_parts(batches: Sequence[FeatureBatch]) -> FeatureParts:
    first, *others = [each.parts for each in batches if isinstance(each, FeatureParts)]
    if len(others) + 1 < len(batches) or any(each.keys() != first.keys() for each in others):
        raise ValueError("features in other parts")
    every = (first, *others)
    return FeatureParts({name: _one(join([each[name] for each in every])) for name in first})


def _one(batch: FeatureBatch) -> OnePart:
    assert not isinstance(batch, FeatureParts)
    return batch


def _stack_descriptors(sets: Sequence[NDArray[np.floating]], d: int) -> DescriptorSets:
    offsets = np.concatenate([[0], np.cumsum([len(s) for s in sets])]).astype(np.int64)
    dtype = sets[0].dtype if sets else np.float32
    return DescriptorSets(np.concatenate([np.empty((0, d), dtype), *sets]), offsets)
