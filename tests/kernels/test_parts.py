"""Kernels on features in parts, against the same kernels on the vectors that these are parts of."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from placecue import DataError, DescriptorSets, FeatureParts, Kernel, UsageError, clone
from placecue_kernels.chi2 import Chi2
from placecue_kernels.combined import Sum
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.match import Match
from placecue_kernels.parts import Parts
from placecue_kernels.rbf import RBF


def values(n: int, seed: int) -> np.ndarray:
    """Samples of seven columns, the last four of which may be negative; the first are often 0."""
    generator = np.random.default_rng(seed)
    found = generator.random((n, 7))
    found[:, 3:] -= 0.5
    found[:, :3] *= generator.random((n, 3)) < 0.5
    return found


def parted(whole: np.ndarray) -> FeatureParts:
    """The same samples as a sparse and two dense parts."""
    return FeatureParts(
        {"first": sparse.csr_array(whole[:, :3]), "second": whole[:, 3:5], "third": whole[:, 5:]}
    )


A, B = values(9, 0), values(6, 1)


@pytest.mark.parametrize(
    "kernel", [RBF(0.7), Linear(), HistogramIntersection(), Sum([RBF(), Linear()])]
)
def test_parts_are_one_joined_vector(kernel: Kernel) -> None:
    on_parts, on_vectors = clone(kernel).fit(parted(A)), clone(kernel).fit(A)
    for other in (None, B):
        found = on_parts.gram(parted(A), None if other is None else parted(other))
        np.testing.assert_allclose(found, on_vectors.gram(A, other), rtol=1e-12, atol=1e-12)


def test_sparse_parts_stay_sparse() -> None:
    """A dense row of these histograms would take 3.8 GB."""

    def histograms(keys: list[list[int]]) -> sparse.csr_array:
        indptr = np.cumsum([0, *map(len, keys)])
        data = np.full(sum(map(len, keys)), 0.5)
        return sparse.csr_array((data, np.concatenate(keys), indptr), shape=(len(keys), 28**6))

    last = 28**6 - 1
    batch = FeatureParts({"h": histograms([[3, last], [3, 9]]), "v": np.array([[1.0], [3.0]])})
    # Histograms: 0.5**2 + 0.5**2 apart, 0.25 in common as a product, 0.5 as an intersection.
    assert RBF(1.0).shared(batch)[0, 1] == pytest.approx(0.5 + 4)
    assert Linear().gram(batch)[0, 1] == pytest.approx(0.25 + 3)
    assert HistogramIntersection().gram(batch)[0, 1] == pytest.approx(0.5 + 1)


def test_a_product_of_rbf_is_rbf_with_a_gamma_a_part() -> None:
    gammas = {"first": 0.3, "second": 1.1, "third": 0.05}
    kernel = Parts({name: RBF(gamma) for name, gamma in gammas.items()}, join="product")
    by_column = np.sqrt([0.3] * 3 + [1.1] * 2 + [0.05] * 2)
    expected = RBF(1.0).gram(A * by_column, B * by_column)
    np.testing.assert_allclose(kernel.gram(parted(A), parted(B)), expected, rtol=1e-12)
    # Powers multiply gamma.
    powers = {name: gamma / 0.1 for name, gamma in gammas.items()}
    same = Parts({name: RBF(0.1) for name in gammas}, powers, "product")
    np.testing.assert_allclose(same.gram(parted(A), parted(B)), expected, rtol=1e-12)
    assert same.positive_definite


def test_a_weighted_sum() -> None:
    kernels = {"first": Chi2(0.9), "second": RBF(0.4), "third": HistogramIntersection()}
    weights = {"third": 0.25, "first": 2.0, "second": 0.0}
    found = Parts(kernels, weights).fit(parted(A)).gram(parted(A), parted(B))
    expected = 2 * Chi2(0.9).gram(A[:, :3], B[:, :3])
    expected += 0.25 * HistogramIntersection().fit(A[:, 5:]).gram(A[:, 5:], B[:, 5:])
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_what_is_shared_serves_every_light_parameter() -> None:
    kernel = Parts({"first": Chi2(), "second": RBF(), "third": Linear()}).fit(parted(A))
    assert kernel.light_parameters == ("weights", "kernels__first__gamma", "kernels__second__gamma")
    shared = kernel.shared(parted(A), parted(B))
    weights = {"first": 1.0, "second": 3.0, "third": 0.5}
    kernel.set_params(kernels__second__gamma=0.2, kernels__first__gamma=4.0, weights=weights)
    anew = Parts({"first": Chi2(4.0), "second": RBF(0.2), "third": Linear()}, weights)
    np.testing.assert_allclose(kernel.from_shared(shared), anew.gram(parted(A), parted(B)))
    assert kernel.get_params()["kernels__second__gamma"] == 0.2
    assert clone(kernel).kernels["first"].gamma == 4.0  # type: ignore[index]
    with pytest.raises(ValueError, match="Parts has no 'kernels__fourth__gamma'"):
        kernel.set_params(kernels__fourth__gamma=1.0)


def test_kernels_by_kind() -> None:
    sets = DescriptorSets(B.astype(np.float32), np.array([0, 2, 6]))
    batch = FeatureParts({"h": sparse.csr_array(A[:2, :3]), "v": A[:2, 3:], "points": sets})
    kernel = Parts().fit(batch)
    assert {name: type(each) for name, each in kernel.kernels_.items()} == {
        "h": Chi2,
        "v": RBF,
        "points": Match,
    }
    # The variance of two numbers is a quarter of their squared difference.
    gamma = 4 / float(((A[0, 3:] - A[1, 3:]) ** 2).sum())
    assert kernel.gammas_ == {"v": pytest.approx(gamma)}
    expected = Chi2().gram(A[:2, :3]) + RBF(gamma).gram(A[:2, 3:]) + Match().gram(sets)
    np.testing.assert_allclose(kernel.gram(batch), expected)
    assert not kernel.positive_definite
    with pytest.raises(UsageError, match="chooses its kernels in training: fit it first, or give"):
        Parts().gram(batch)


def test_other_parts_than_kernels() -> None:
    kernel = Parts({"first": Chi2(), "other": RBF()})
    said = (
        "kernels for the parts first, other, and the features have the parts first, second, third"
    )
    for asked in (kernel.check, kernel.fit, kernel.gram, kernel.shared):
        with pytest.raises(UsageError, match=said):
            asked(parted(A))
    with pytest.raises(UsageError, match="Parts takes features in parts, got dense vector: choose"):
        kernel.gram(A)


def test_a_kernel_that_cannot_take_its_part() -> None:
    kernel = Parts({"first": Match(), "second": RBF(), "third": RBF()})
    said = "part 'first': kernel Match takes set of local descriptors, got sparse histogram"
    with pytest.raises(UsageError, match=said):
        kernel.fit(parted(A))
    sets = DescriptorSets(B, np.array([0, 2, 6]))
    for each in (RBF(), Linear(), HistogramIntersection()):
        with pytest.raises(UsageError, match="got set of local descriptors in part 'points'"):
            each.gram(FeatureParts({"v": A[:2], "points": sets}))
    with pytest.raises(UsageError, match=r"Chi2 takes .*, got features in parts: choose another"):
        Chi2().gram(parted(A))


@pytest.mark.parametrize("kernel", [RBF(), Linear(), HistogramIntersection()])
def test_batches_of_other_parts(kernel: Kernel) -> None:
    parts = parted(B).parts
    with pytest.raises(UsageError, match="the parts first, second, third and of first:"):
        kernel.gram(parted(A), FeatureParts({"first": parts["first"]}))
    with pytest.raises(UsageError, match="third and of a dense vector in one piece"):
        kernel.gram(parted(A), B)
    with pytest.raises(UsageError, match="samples of 3 and of 2 columns"):
        kernel.gram(parted(A), FeatureParts({**parts, "first": B[:, :2]}))
    spoilt = FeatureParts({**parted(A).parts, "third": A[:, 5:] * np.nan})
    with pytest.raises(DataError, match=r"NaN|value nan"):
        kernel.fit(parted(A)).gram(spoilt)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"join": "mean"}, "kernel.join"),
        ({"kernels": {"a": RBF()}, "weights": {"b": 1.0}}, "parts a, and weights for b: give one"),
        ({"kernels": {"a": RBF()}, "weights": {"a": -1.0}}, "none negative, got"),
        ({"kernels": {"a": 3}}, "takes kernels by the names of parts, .*, got 3 for 'a'"),
        ({"kernels": {"a__b": RBF()}}, "for 'a__b'"),
    ],
)
def test_wrong_parameters(parameters: dict, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        Parts(**parameters).check_parameters()
