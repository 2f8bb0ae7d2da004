"""RBF and Linear equal scikit-learn's and plain definitions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from sklearn.base import clone
from sklearn.metrics.pairwise import linear_kernel, rbf_kernel

from placecue import UsageError
from placecue_kernels.chi2 import Chi2
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF


def vectors(n: int, seed: int, d: int = 9) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, d))


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.floats(1e-4, 100), st.integers(0, 10**6))
def test_rbf(n: int, m: int, gamma: float, seed: int) -> None:
    x, y = vectors(n, seed), vectors(m, seed + 1)
    gram = RBF(gamma).gram(x, y)
    np.testing.assert_allclose(gram, rbf_kernel(x, y, gamma=gamma), rtol=0, atol=1e-12)
    wanted = np.exp(-gamma * ((x[:, None] - y) ** 2).sum(axis=2))
    np.testing.assert_allclose(gram, wanted, rtol=0, atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 15), st.floats(1e-4, 100), st.integers(0, 10**6))
def test_rbf_gram_matrix(n: int, gamma: float, seed: int) -> None:
    x = vectors(n, seed)
    gram = RBF(gamma).gram(x)
    np.testing.assert_array_equal(np.diag(gram), 1)
    np.testing.assert_allclose(gram, gram.T, rtol=0, atol=1e-14)
    assert np.linalg.eigvalsh(gram).min() > -1e-10
    half = n // 2
    np.testing.assert_allclose(
        RBF(gamma).gram(x[:half], x[half:]) if half else gram[:0, half:],
        gram[:half, half:],
        rtol=0,
        atol=1e-12,
    )


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 10**6))
def test_linear(n: int, m: int, seed: int) -> None:
    x, y = vectors(n, seed), vectors(m, seed + 1)
    x[x < 0.3], y[y < 0.3] = 0, 0
    wanted = linear_kernel(x, y)
    for a in (x, sparse.csr_array(x)):
        for b in (y, sparse.csr_array(y)):
            gram = Linear().gram(a, b)
            assert isinstance(gram, np.ndarray)
            np.testing.assert_allclose(gram, wanted, rtol=0, atol=1e-12)
        np.testing.assert_allclose(Linear().gram(a), linear_kernel(x), rtol=0, atol=1e-12)


def test_linear_over_the_columns_of_a_receptive_field_histogram() -> None:
    def rows(keys: list[int]) -> sparse.csr_array:
        return sparse.csr_array(([1.0, 2.0], keys, [0, 2]), shape=(1, 28**6))

    assert Linear().gram(rows([5, 28**6 - 1]), rows([7, 28**6 - 1])) == [[4.0]]
    assert Linear().gram(rows([5, 9]), rows([7, 8])) == [[0.0]]


@pytest.mark.parametrize("kernel", [RBF(), Linear(), Chi2()])
def test_wrong_widths(kernel: RBF | Linear | Chi2) -> None:
    with pytest.raises(UsageError, match="4 and of 5 columns"):
        kernel.gram(np.ones((2, 4)), np.ones((3, 5)))


def test_rbf_of_sparse_histograms() -> None:
    values = np.eye(3)
    values[1, 2] = 2.0
    # 1 + 1 between the first and the last; 1 + 1 + 4 and 4 - 4 + 1 + 1 from the one in between.
    squared = np.array([[0, 6, 2], [6, 0, 2], [2, 2, 0]])
    found = RBF(0.3).gram(sparse.csr_array(values))
    np.testing.assert_allclose(found, np.exp(-0.3 * squared), rtol=1e-14)
    one_by_one = [RBF(0.3).gram(sparse.csr_array(values), row[None]) for row in values]
    np.testing.assert_allclose(np.hstack(one_by_one), found, rtol=1e-14)


@pytest.mark.parametrize("kernel", [RBF(0.3), Linear(), Chi2(0.7)])
def test_cloning(kernel: RBF | Linear | Chi2) -> None:
    assert clone(kernel).get_params() == kernel.get_params()
