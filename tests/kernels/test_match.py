"""The match kernel equals its definition in double precision, in every way it is computed."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.base import clone

from placecue import DataError, DescriptorSets, UsageError
from placecue_classifiers.svm import SVM
from placecue_kernels.match import Match


def sets_of(sizes: list[int], seed: int, d: int = 16, length: float = 1.0) -> DescriptorSets:
    """Descriptors of one length, not negative, as SIFT's are."""
    values = np.random.default_rng(seed).random((sum(sizes), d))
    values *= length / np.linalg.norm(values, axis=1, keepdims=True)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    return DescriptorSets(values.astype(np.float32), offsets)


def of(batch: DescriptorSets, i: int) -> np.ndarray:
    return batch.values[batch.offsets[i] : batch.offsets[i + 1]].astype(np.float64)


def by_definition(
    a: DescriptorSets, b: DescriptorSets, gamma: float, within: bool = False
) -> np.ndarray:
    gram = np.zeros((len(a), len(b)))
    for i in range(len(a)):
        for j in range(len(b)):
            x, y = of(a, i), of(b, j)
            if within and i == j:
                gram[i, j] = 1
            elif len(x) and len(y):
                likeness = np.exp(-gamma * ((x[:, None] - y) ** 2).sum(axis=2))
                gram[i, j] = (likeness.max(axis=1).mean() + likeness.max(axis=0).mean()) / 2
    return gram


SIZES = st.lists(st.integers(0, 7), min_size=1, max_size=9)


@settings(max_examples=40, deadline=None)
@given(SIZES, SIZES, st.floats(0.05, 3), st.integers(0, 10**6))
def test_equals_definition(a: list[int], b: list[int], gamma: float, seed: int) -> None:
    x, y = sets_of(a, seed), sets_of(b, seed + 1)
    kernel = Match(gamma)
    for other in (y, None):
        wanted = by_definition(x, x if other is None else other, gamma, other is None)
        for found in (kernel.gram(x, other), kernel.from_shared(kernel.shared(x, other))):
            assert found.dtype == np.float64
            np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-5)
            if other is None:
                np.testing.assert_array_equal(found, found.T)
                np.testing.assert_array_equal(np.diag(found), 1)


def test_many_blocks_of_large_sets() -> None:
    a = sets_of([300, 0, 1, 1500, 40, 0], 0)
    b = sets_of([700, 700, 0, 0, 900, 1200, 3], 1)
    for other in (b, None):
        wanted = by_definition(a, a if other is None else other, 0.7, other is None)
        np.testing.assert_allclose(Match(0.7).gram(a, other), wanted, rtol=0, atol=1e-5)


@pytest.mark.parametrize("parameters", [{"memory": 0.0}, {"n_jobs": 2}])
def test_files_and_threads_change_nothing(parameters: dict[str, float]) -> None:
    a, b = sets_of([5, 0, 9, 30], 2), sets_of([7, 3, 0], 3)
    kernel = Match(0.5, **parameters)
    for other in (b, None):
        kept = kernel.shared(a, other)
        assert isinstance(kept.from_a, np.memmap) == ("memory" in parameters)
        plain = Match(0.5).gram(a, other)
        np.testing.assert_allclose(kernel.from_shared(kept), plain, rtol=0, atol=1e-7)
        np.testing.assert_allclose(kernel.gram(a, other), plain, rtol=0, atol=1e-7)


def test_threads_share_the_samples_that_one_image_is_matched_with() -> None:
    one, others = sets_of([40], 1), sets_of([30, 0, 700, 600, 20, 500], 2)
    threaded = Match(0.5, n_jobs=3)
    np.testing.assert_allclose(threaded.gram(one, others), by_definition(one, others, 0.5), 1e-5)
    assert np.array_equal(threaded.gram(one, others), Match(0.5).gram(one, others))


def test_each_gamma_costs_only_exponentials() -> None:
    x = sets_of([4, 8, 2, 6], 4)
    kept = Match().shared(x)
    for gamma in (0.1, 1.0, 10.0):
        wanted = by_definition(x, x, gamma, within=True)
        np.testing.assert_allclose(Match(gamma).from_shared(kept), wanted, atol=1e-5)


def test_descriptors_of_opencv_length() -> None:
    a, b = sets_of([20, 30], 5, 128, 512), sets_of([25, 10], 6, 128, 512)
    a, b = (DescriptorSets(np.rint(each.values), each.offsets) for each in (a, b))
    wanted = by_definition(a, b, 1e-5)
    np.testing.assert_allclose(Match(1e-5).gram(a, b), wanted, rtol=0, atol=1e-5)


def test_nearest_distances_equal_those_of_opencv() -> None:
    a, b = sets_of([40], 7), sets_of([60], 8)
    found = Match().shared(a, b)
    matcher = cv2.BFMatcher(cv2.NORM_L2)
    for one, other, ours in ((a, b, found.from_a), (b, a, found.from_b)):
        theirs = [match.distance**2 for match in matcher.match(one.values, other.values)]
        np.testing.assert_allclose(ours[0], theirs, atol=1e-5)


def test_double_precision_and_strided_descriptors() -> None:
    x = sets_of([4, 3], 9)
    wide = np.zeros((7, 32))
    wide[:, ::2] = x.values
    strided = DescriptorSets(wide[:, ::2], x.offsets)
    np.testing.assert_allclose(Match().gram(strided), Match().gram(x), atol=1e-7)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_spoilt_descriptors(bad: float) -> None:
    good, wrong = sets_of([3, 4], 10), sets_of([3, 4], 11)
    wrong.values[5, 2] = bad
    for batches in ((wrong, None), (good, wrong), (wrong, good)):
        with pytest.raises(DataError, match="1 of 7 local descriptors hold NaN or infinite"):
            Match().gram(*batches)


def test_wrong_kinds_widths_and_parameters() -> None:
    sets = sets_of([2, 3], 12)
    with pytest.raises(UsageError, match="Match takes set of local descriptors, got dense"):
        Match().gram(np.eye(3))
    with pytest.raises(UsageError, match="16 and of 8 columns"):
        Match().gram(sets, sets_of([2], 0, 8))
    for kernel in (Match(0.0), Match(float("nan")), Match(memory=-1)):
        with pytest.raises(UsageError, match="match needs gamma > 0 and memory >= 0"):
            kernel.shared(sets)


def test_an_svm_searches_gamma_over_four_rooms() -> None:
    rng = np.random.default_rng(13)
    rooms = rng.random((4, 12, 16))
    labels = np.repeat(["corridor", "kitchen", "lab", "office"], 20)
    values, sizes = [], []
    for i, _ in enumerate(labels):
        size = 0 if i % 20 == 7 else int(rng.integers(4, 10))
        seen = rooms[i // 20][rng.integers(0, 12, size)] + 0.1 * rng.normal(size=(size, 16))
        values.append(seen.astype(np.float32))
        sizes.append(size)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    batch = DescriptorSets(np.concatenate(values), offsets)
    model = SVM(kernel=Match(), search={"C": [1, 10], "gamma": [0.1, 1]}).fit(
        batch[::2], labels[::2]
    )
    predicted = model.scores(batch[1::2]).decide().labels
    seen = np.diff(batch[1::2].offsets) > 0
    assert np.mean(predicted[seen] == labels[1::2][seen]) > 0.9


def test_says_that_it_is_not_positive_definite_and_clones() -> None:
    assert not Match.positive_definite
    kernel = Match(0.3, memory=1.0, n_jobs=2)
    assert clone(kernel).get_params() == kernel.get_params()
