"""Folds that share a Gram matrix give what copies fitted in each fold give."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from placecue import (
    Blocks,
    DescriptorSets,
    FeatureBatch,
    InterleavedChunks,
    Kernel,
    QuantileScaling,
)
from placecue.classifier import Classifier
from placecue.evidence import OutOfFold
from placecue.learning.samples import CueSamples
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.svm import SVM
from placecue_kernels.chi2 import Chi2
from placecue_kernels.combined import Sum
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.match import Match
from placecue_kernels.rbf import RBF

Samples = tuple[np.ndarray, np.ndarray]


def histograms(features: np.ndarray) -> np.ndarray:
    positive = np.exp(features / 5)
    return positive / positive.sum(axis=1, keepdims=True)


def descriptors(features: np.ndarray) -> DescriptorSets:
    """Three descriptors a sample, two of its features each."""
    values = features.reshape(-1, 2).astype(np.float32)
    values /= np.linalg.norm(values, axis=1, keepdims=True)
    return DescriptorSets(values, np.arange(0, len(values) + 1, 3))


def both_ways(svm: SVM, features: FeatureBatch, labels: np.ndarray) -> tuple[np.ndarray, ...]:
    """Out-of-fold scores by the SVM's own way and by that of any classifier."""
    stamps = np.arange(len(labels)) * 10**9
    splits = list(Blocks(n_folds=4).split(labels, stamps))
    found = []
    for way in (svm.out_of_fold, super(SVM, svm).out_of_fold):
        values = np.full((len(labels), len(svm.layout_.columns)), np.nan)
        for held_out, scores in way(features, labels, stamps, splits):
            values[held_out] = scores
        assert np.isfinite(values).all()
        found.append(values)
    return tuple(found)


@pytest.mark.parametrize("multiclass", ["oaa", "oao", "modified_oaa"])
@pytest.mark.parametrize(
    ("kernel", "prepare"),
    [
        (RBF(0.01), np.asarray),
        (Chi2(3.0), histograms),
        (HistogramIntersection(), histograms),
        (Match(1.0), descriptors),
        (Sum([RBF(0.01), Linear()]), np.asarray),
    ],
    ids=["rbf", "chi2", "hi", "match", "sum"],
)
def test_equals_copies_fitted_in_each_fold(
    seen: Samples, kernel: Kernel, prepare: Any, multiclass: str
) -> None:
    features, labels = prepare(seen[0]), seen[1]
    svm = SVM(kernel=kernel, C=10.0, multiclass=multiclass).fit(features, labels)
    shared, anew = both_ways(svm, features, labels)
    # LIBSVM stops each machine at a tolerance; the match kernel is single precision.
    np.testing.assert_allclose(shared, anew, rtol=0, atol=1e-4)


@pytest.mark.parametrize("probability", ["sigmoid", "isotonic"])
def test_probabilities_are_calibrated_inside_each_fold(seen: Samples, probability: str) -> None:
    features, labels = seen
    folds = Blocks(n_folds=3)
    svm = SVM(kernel=RBF(0.01), probability=probability, folds=folds).fit(features, labels)
    shared, anew = both_ways(svm, features, labels)
    np.testing.assert_allclose(shared, anew, rtol=0, atol=1e-4)
    np.testing.assert_allclose(shared.sum(axis=1), 1)


def test_what_the_search_chose_is_used(seen: Samples) -> None:
    search = {"C": [0.1, 10.0], "gamma": [1e-5, 0.01], "multiclass": ["oao", "oaa"]}
    svm = SVM(kernel=RBF(), search=search).fit(*seen)
    plain = SVM(
        kernel=RBF(svm.chosen_["gamma"]), C=svm.chosen_["C"], multiclass=svm.chosen_["multiclass"]
    ).fit(*seen)
    np.testing.assert_allclose(both_ways(svm, *seen)[0], both_ways(plain, *seen)[1], atol=1e-6)


class Counting(RBF):
    """Counts its distances."""

    calls = 0

    def distances(self, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        Counting.calls += 1
        return super().distances(a, b)


def test_the_gram_matrix_is_computed_once_for_all_folds(seen: Samples) -> None:
    features, labels = seen
    svm = SVM(kernel=Counting(0.01)).fit(features, labels)
    Counting.calls = 0
    OutOfFold(InterleavedChunks()).scores(svm, CueSamples(features), labels)
    assert Counting.calls == 1


@pytest.mark.parametrize(
    "svm",
    [
        SVM(kernel=RBF(0.01), scaling=QuantileScaling()),
        SVM(kernel=HistogramIntersection()),
        SVM(kernel=Sum([RBF(0.01), HistogramIntersection()])),
    ],
    ids=["scaling", "shift", "shift in a sum"],
)
def test_what_learns_from_training_samples_never_sees_the_others(svm: SVM, seen: Samples) -> None:
    features, labels = seen
    svm.fit(features, labels)
    shared, anew = both_ways(svm, features, labels)
    assert np.array_equal(shared, anew)


def test_any_classifier_is_fitted_on_the_other_folds(seen: Samples) -> None:
    features, labels = seen
    classifier: Classifier = AdaBoost(rounds=5).fit(features, labels)
    splits = list(Blocks(n_folds=4).split(labels))
    scored = OutOfFold(Blocks(n_folds=4)).scores(classifier, CueSamples(features), labels)
    for training, held_out in splits:
        copy = AdaBoost(rounds=5).fit(features[training], labels[training])
        expected = copy.scores(features[held_out]).values
        np.testing.assert_array_equal(scored.values[held_out], expected)
