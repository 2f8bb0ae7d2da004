"""Chi2 equals scikit-learn's and the group's values, however the histograms are stored."""

import gc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from sklearn.metrics.pairwise import chi2_kernel

from placecue import DataError, DescriptorSets, UsageError
from placecue_kernels import inverted_index
from placecue_kernels.chi2 import Chi2


def histograms(n: int, seed: int, bins: int = 40) -> np.ndarray:
    rng = np.random.default_rng(seed)
    counts = rng.poisson(0.7, (n, bins)).astype(float)
    counts[:, 0] += 1
    return counts / counts.sum(axis=1, keepdims=True)


def by_definition(x: np.ndarray, y: np.ndarray, gamma: float) -> np.ndarray:
    above, below = (x[:, None] - y) ** 2, x[:, None] + y
    terms = np.divide(above, below, out=np.zeros_like(above), where=below > 0)
    return np.exp(-gamma * terms.sum(axis=2))


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.floats(1e-3, 31.6), st.integers(0, 10**6))
def test_equals_scikit_learn_and_definition(n: int, m: int, gamma: float, seed: int) -> None:
    x, y = histograms(n, seed), histograms(m, seed + 1)
    wanted = chi2_kernel(x, y, gamma=gamma)
    np.testing.assert_allclose(by_definition(x, y, gamma), wanted, atol=1e-12)
    stored = [(x, y), (sparse.csr_array(x), sparse.csr_array(y)), (sparse.csr_array(x), y)]
    for a, b in stored:
        np.testing.assert_allclose(Chi2(gamma).gram(a, b), wanted, rtol=0, atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 15), st.floats(1e-3, 31.6), st.integers(0, 10**6))
def test_gram_matrix_properties(n: int, gamma: float, seed: int) -> None:
    x = histograms(n, seed)
    gram = Chi2(gamma).gram(sparse.csr_array(x))
    np.testing.assert_array_equal(gram, gram.T)
    np.testing.assert_array_equal(np.diag(gram), 1)
    assert np.linalg.eigvalsh(gram).min() > -1e-10
    np.testing.assert_allclose(gram, chi2_kernel(x, gamma=gamma), rtol=0, atol=1e-12)


def test_blocks_equal_the_full_matrix() -> None:
    x = sparse.csr_array(histograms(20, 3))
    full = Chi2().gram(x)
    np.testing.assert_allclose(Chi2().gram(x[:7], x[7:]), full[:7, 7:], rtol=0, atol=1e-14)
    np.testing.assert_allclose(Chi2().gram(x, x), full, rtol=0, atol=1e-14)


def test_columns_beyond_32_bits() -> None:
    x, y = histograms(6, 1), histograms(5, 2)
    places = np.sort(np.random.default_rng(0).choice(2**40, x.shape[1], replace=False))

    def spread(dense: np.ndarray) -> sparse.csr_array:
        rows = sparse.csr_array(dense)
        return sparse.csr_array(
            (rows.data, places[rows.indices], rows.indptr), shape=(len(dense), 2**40)
        )

    wanted = chi2_kernel(x, y, gamma=2.0)
    np.testing.assert_allclose(Chi2().gram(spread(x), spread(y)), wanted, rtol=0, atol=1e-12)


def test_duplicates_zeros_order_and_precision_of_storage_do_not_matter() -> None:
    dense = np.array([[0.25, 0.0, 0.75], [0.5, 0.5, 0.0]])
    messy = sparse.csr_array(
        (np.array([0.5, 0.25, 0.25, 0.0, 0.5, 0.5], np.float32), [2, 0, 2, 1, 1, 0], [0, 4, 6]),
        shape=(2, 3),
    )
    wanted = by_definition(dense, dense, 2.0)
    np.testing.assert_allclose(Chi2().gram(messy), wanted, atol=1e-15)
    np.testing.assert_allclose(Chi2().gram(messy, dense), wanted, atol=1e-15)
    assert messy.nnz == 6


def test_not_normalised_and_empty_histograms() -> None:
    x = np.array([[3.0, 0, 1], [0, 0, 0], [2, 2, 0]])
    np.testing.assert_allclose(Chi2(0.5).gram(x), chi2_kernel(x, gamma=0.5), atol=1e-15)
    nothing = sparse.csr_array((0, 3))
    assert Chi2().gram(nothing, x).shape == (0, 3)
    assert Chi2().gram(x, nothing).shape == (3, 0)
    assert Chi2().gram(nothing).shape == (0, 0)


def test_each_gamma_costs_only_an_exponential() -> None:
    x = histograms(8, 4)
    distances = Chi2().shared(x)
    kept = distances.copy()
    for gamma in (0.1, 1.0, 10.0):
        wanted = chi2_kernel(x, gamma=gamma)
        np.testing.assert_allclose(Chi2(gamma).from_shared(distances), wanted, atol=1e-12)
    np.testing.assert_array_equal(distances, kept)


def test_reference_values(
    reference_histograms: sparse.csr_array, reference_kernels: dict[str, np.ndarray]
) -> None:
    batch, known = reference_histograms, reference_kernels
    np.testing.assert_allclose(Chi2().shared(batch), known["chi2"], atol=1e-12)
    np.testing.assert_allclose(Chi2(2.0).gram(batch), known["kernel_gamma2"], atol=1e-12)


@pytest.mark.parametrize("bad", [-0.1, np.nan])
def test_what_is_no_histogram(bad: float) -> None:
    good, wrong = histograms(2, 0), histograms(2, 1)
    wrong[1, 3] = bad
    for batches in ((wrong, None), (good, wrong), (wrong, good)):
        with pytest.raises(DataError, match="chi2 kernel compares histograms"):
            Chi2().gram(*batches)


def test_wrong_kinds_and_widths() -> None:
    sets = DescriptorSets(np.zeros((3, 2)), np.array([0, 1, 3]))
    with pytest.raises(UsageError, match="Chi2 takes dense vector or sparse histogram"):
        Chi2().gram(sets)
    with pytest.raises(UsageError, match="40 and of 41 columns"):
        Chi2().gram(histograms(2, 0), histograms(2, 0, bins=41))


def test_index_is_kept_only_while_the_batch_lives() -> None:
    gc.collect()  # batches of other tests
    batch = sparse.csr_array(histograms(4, 0))
    first = inverted_index.index_of(batch)
    assert inverted_index.index_of(batch) is first
    kept = len(inverted_index._remembered)
    del batch
    gc.collect()
    assert len(inverted_index._remembered) == kept - 1
