"""Gram blocks are computed once where somebody keeps them."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest
from scipy import sparse

from placecue import FeatureBatch
from placecue.grams import KeptGrams, keeping
from placecue.scaling import RangeScaling
from placecue_classifiers.svm import SVM
from placecue_kernels.chi2 import Chi2
from placecue_kernels.combined import Sum
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF

MULTICLASS = ("oao", "oaa", "modified_oaa")


class Counted(Chi2):
    """Counts the blocks that it computes, by their shapes."""

    made: ClassVar[list[tuple[int, int]]] = []

    def shared(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        self.made.append((a.shape[0], a.shape[0] if b is None else b.shape[0]))
        return super().shared(a, b)


def histograms(n: int, seed: int) -> sparse.csr_array:
    generator = np.random.default_rng(seed)
    dense = generator.random((n, 30)) * (generator.random((n, 30)) > 0.5)
    dense[:, :5] += 4 * np.eye(5)[np.arange(n) % 5]
    return sparse.csr_array(dense / dense.sum(axis=1, keepdims=True))


@pytest.fixture
def labels() -> np.ndarray:
    return np.array([*"abcde"] * 12)


def test_a_second_log_is_scored_under_three_extensions_with_one_block(labels: np.ndarray) -> None:
    first, second = histograms(60, 0), histograms(35, 1)
    Counted.made.clear()
    with keeping(KeptGrams()):
        found = {
            (name, gamma): SVM(Counted(gamma), multiclass=name).fit(first, labels).scores(second)
            for gamma in (0.01, 0.1)
            for name in MULTICLASS
        }
    # Neither extensions, whose support vectors differ, nor gammas compute distances anew.
    assert Counted.made == [(60, 60), (35, 60)]
    for (name, gamma), scores in found.items():
        plain = SVM(Chi2(gamma), multiclass=name).fit(first, labels)
        assert len(plain.support_) < 60
        expected = plain.scores(second).values
        np.testing.assert_allclose(scores.values, expected, rtol=0, atol=1e-9)


def test_support_rows_are_those_of_the_training_samples(labels: np.ndarray) -> None:
    features = histograms(60, 0)
    svm = SVM(Chi2(1.0)).fit(features, labels)
    assert (svm.support_features_ != features[svm.support_]).nnz == 0
    assert svm.samples_ is None


def test_other_samples_and_kernels_have_blocks_of_their_own(labels: np.ndarray) -> None:
    first, other, asked = histograms(60, 0), histograms(60, 2), histograms(10, 1)
    for kernel in (Chi2(1.0), Sum([Chi2(1.0), Linear()]), Sum([Chi2(1.0), Chi2(0.1)])):
        with keeping(KeptGrams()):
            kept = [
                SVM(kernel).fit(each, labels).scores(asked).values for each in (first, other, first)
            ]
        plain = [SVM(kernel).fit(each, labels).scores(asked).values for each in (first, other)]
        for found, expected in zip(kept, [*plain, plain[0]], strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


def test_scaled_samples_are_other_samples(labels: np.ndarray) -> None:
    first, asked = histograms(60, 0).toarray(), histograms(10, 1).toarray()
    ways = [SVM(RBF(1.0)), SVM(RBF(1.0), scaling=RangeScaling())]
    with keeping(KeptGrams()):
        kept = [svm.fit(first, labels).scores(asked).values for svm in ways]
    for svm, found in zip(ways, kept, strict=True):
        expected = svm.fit(first, labels).scores(asked).values
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


def test_a_machine_of_elsewhere_is_asked_by_its_support_vectors(labels: np.ndarray) -> None:
    first, asked = histograms(60, 0), histograms(10, 1)
    svm = SVM(Counted(1.0)).fit(first, labels)
    Counted.made.clear()
    with keeping(KeptGrams()):
        svm.scores(asked)
    assert Counted.made == [(10, len(svm.support_))]


def test_no_more_blocks_are_kept_than_asked_for(labels: np.ndarray) -> None:
    svm = SVM(Counted(1.0)).fit(histograms(60, 0), labels)
    asked = [histograms(10 + number, number) for number in range(4)]
    with keeping(KeptGrams(most=2)):
        Counted.made.clear()
        for number in (0, 1, 0, 2, 0, 1):
            svm.scores(asked[number])
    # Batch 0 is asked for again before it is the oldest; 1 had to go for 2.
    assert [n for n, _ in Counted.made] == [10, 11, 12, 11]


def test_nobody_writes_into_what_is_kept(labels: np.ndarray) -> None:
    first = histograms(60, 0)
    with keeping(KeptGrams()) as grams:
        gram = grams.gram(Chi2(1.0), first)
        expected = gram.copy()
        gram[:] = 0
        assert np.array_equal(grams.gram(Chi2(1.0), first), expected)
