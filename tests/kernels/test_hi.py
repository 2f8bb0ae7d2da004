"""Histogram intersection equals its definition and the group's values, however it is stored."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from sklearn.base import clone

from placecue import DataError, DescriptorSets, UsageError
from placecue_kernels.hi import HistogramIntersection


def vectors(n: int, seed: int, d: int = 30, low: float = 0.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    values = rng.uniform(low, 1, (n, d))
    return np.where(rng.random((n, d)) < 0.5, values, 0)


def by_definition(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.minimum(x[:, None], y).sum(axis=2)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 10**6))
def test_equals_definition(n: int, m: int, seed: int) -> None:
    x, y = vectors(n, seed), vectors(m, seed + 1)
    wanted = by_definition(x, y)
    stored = [(x, y), (sparse.csr_array(x), sparse.csr_array(y)), (sparse.csr_array(x), y)]
    for a, b in stored:
        found = HistogramIntersection().gram(a, b)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12)
    for a in (x, sparse.csr_array(x)):
        gram = HistogramIntersection().gram(a)
        np.testing.assert_allclose(gram, by_definition(x, x), rtol=0, atol=1e-12)
        assert np.linalg.eigvalsh(gram).min() > -1e-10


@settings(max_examples=25, deadline=None)
@given(st.integers(2, 12), st.integers(1, 12), st.integers(0, 10**6))
def test_negative_inputs_are_shifted_by_the_training_minimum(n: int, m: int, seed: int) -> None:
    training, asked = vectors(n, seed, low=-1), vectors(m, seed + 1, low=-1)
    kernel = HistogramIntersection().fit(training)
    shift = np.minimum(training.min(axis=0), 0)
    wanted = by_definition(np.maximum(asked - shift, 0), training - shift)
    np.testing.assert_allclose(kernel.gram(asked, training), wanted, rtol=0, atol=1e-12)
    every = np.concatenate([training, asked])
    gram = kernel.gram(every)
    np.testing.assert_allclose(gram[n:, :n], wanted, rtol=0, atol=1e-12)
    assert np.linalg.eigvalsh(gram).min() > -1e-10


def test_histograms_are_not_shifted() -> None:
    x = vectors(6, 0) + 0.5
    kernel = HistogramIntersection().fit(x)
    np.testing.assert_allclose(kernel.gram(x), by_definition(x, x), atol=1e-12)
    assert not hasattr(HistogramIntersection().fit(sparse.csr_array(x)), "minimum_")


def test_reference_values(
    reference_histograms: sparse.csr_array, reference_kernels: dict[str, np.ndarray]
) -> None:
    found = HistogramIntersection().gram(reference_histograms)
    wanted = reference_kernels["hist_intersection"]
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12)


@pytest.mark.parametrize("bad", [-0.1, np.nan])
def test_what_cannot_be_intersected(bad: float) -> None:
    good, wrong = vectors(2, 0), vectors(2, 1)
    wrong[1, 3] = bad
    for batches in ((wrong, None), (good, wrong), (wrong, good)):
        with pytest.raises(DataError, match="hi kernel intersects histograms"):
            HistogramIntersection(shift=False).fit(good).gram(*batches)


def test_wrong_kinds_and_widths() -> None:
    sets = DescriptorSets(np.zeros((3, 2)), np.array([0, 1, 3]))
    for call in (HistogramIntersection().fit, HistogramIntersection().gram):
        with pytest.raises(UsageError, match=r"takes dense vector or .* or sparse histogram"):
            call(sets)
    with pytest.raises(UsageError, match="30 and of 31 columns"):
        HistogramIntersection().gram(vectors(2, 0), vectors(2, 0, 31))
    fitted = HistogramIntersection().fit(vectors(3, 0, low=-1))
    with pytest.raises(UsageError, match="31 and of 30 columns"):
        fitted.gram(vectors(2, 0, 31))


def test_cloning() -> None:
    assert clone(HistogramIntersection(shift=False)).get_params() == {"shift": False}
