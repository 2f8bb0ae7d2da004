"""Batches of the three kinds of features."""

import numpy as np
import pytest
from scipy import sparse

from placecue import DescriptorSets, FeatureKind, UsageError
from placecue.features import kind_of, n_samples, stack, take


def test_dense_vectors() -> None:
    batch = stack([np.array([1.0, 2.0]), np.array([3.0, 4.0])])
    assert kind_of(batch) is FeatureKind.DENSE
    assert take(batch, np.array([1])).tolist() == [[3.0, 4.0]]


def test_sparse_rows() -> None:
    rows = [sparse.csr_array([[0.0, 1.0, 0.0]]), sparse.csr_array([[2.0, 0.0, 0.0]])]
    batch = stack(rows)
    assert kind_of(batch) is FeatureKind.SPARSE
    assert take(batch, np.array([False, True])).toarray().tolist() == [[2.0, 0.0, 0.0]]


def test_descriptor_sets_may_be_empty() -> None:
    sets = [np.ones((2, 3)), np.empty((0, 3)), np.full((1, 3), 5.0)]
    batch = stack(sets)
    assert isinstance(batch, DescriptorSets)
    assert (kind_of(batch), n_samples(batch), batch.shape) == (FeatureKind.DESCRIPTORS, 3, (3, 3))
    taken = take(batch, np.array([2, 1]))
    assert isinstance(taken, DescriptorSets)
    assert taken.offsets.tolist() == [0, 1, 1]
    assert taken.values.tolist() == [[5.0, 5.0, 5.0]]


def test_features_that_do_not_fit_are_refused() -> None:
    with pytest.raises(UsageError, match="different shapes"):
        stack([np.zeros(3), np.zeros(4)])
    with pytest.raises(UsageError, match="no features"):
        stack([])
