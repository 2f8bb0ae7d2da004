"""An SVM on features in parts: scaled part by part, and taught by each fold's own samples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse

from placecue import Blocks, FeatureParts, Scores, TrainingSet, UsageError
from placecue.scaling import QuantileScaling, RangeScaling, StandardScaling, UnitSpread
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.chi2 import Chi2
from placecue_kernels.mkl import MKL
from placecue_kernels.parts import Parts
from placecue_kernels.rbf import RBF

N, CLASSES = 60, np.array(["corridor", "kitchen", "lab", "office", "printer area"])
LABELS = CLASSES[np.arange(N) % 5]


def features(seed: int = 0) -> FeatureParts:
    """A sparse histogram and two dense parts of very different sizes, all some help."""
    generator = np.random.default_rng(seed)
    codes = np.arange(N) % 5
    histogram = generator.random((N, 6)) * (generator.random((N, 6)) < 0.7)
    histogram[np.arange(N), codes] += 1
    near = np.random.default_rng(7).normal(size=(5, 3))[codes] + generator.normal(size=(N, 3))
    far = 1000 * (near[:, :2] + generator.normal(size=(N, 2)))
    return FeatureParts({"histogram": sparse.csr_array(histogram), "near": near, "far": far})


def test_parts_of_one_spread_have_the_same_say() -> None:
    training, asked = features(), features(1)
    svm = SVM(RBF(0.2), C=10.0, scaling=UnitSpread(StandardScaling())).fit(training, LABELS)

    def joined(batch: FeatureParts) -> np.ndarray:
        """The joined vector, each part by itself, by numpy."""
        parts = []
        for name in ("histogram", "near", "far"):
            seen = training.parts[name]
            seen, new = (
                m.toarray() if sparse.issparse(m) else m for m in (seen, batch.parts[name])
            )
            if name != "histogram":
                new = (new - seen.mean(axis=0)) / seen.std(axis=0)
                seen = (seen - seen.mean(axis=0)) / seen.std(axis=0)
            parts.append(new / np.sqrt(seen.var(axis=0).sum()))
        return np.hstack(parts)

    alone = SVM(RBF(0.2), C=10.0).fit(joined(training), LABELS)
    expected = alone.scores(joined(asked)).values
    np.testing.assert_allclose(svm.scores(asked).values, expected, atol=1e-6)
    support = svm.support_features_
    assert isinstance(support, FeatureParts)
    assert sparse.issparse(support.parts["histogram"])
    # A histogram alone, in one piece.
    histogram = training.parts["histogram"]
    scaled = histogram / np.sqrt(histogram.toarray().var(axis=0).sum())
    one = SVM(RBF(0.2), C=10.0, scaling=UnitSpread()).fit(histogram, LABELS)
    other = SVM(RBF(0.2), C=10.0).fit(scaled, LABELS)
    np.testing.assert_allclose(one.scores(histogram).values, other.scores(scaled).values, atol=1e-6)


@pytest.mark.parametrize("scaling", [RangeScaling(), StandardScaling(), QuantileScaling(9)])
def test_each_dense_part_is_scaled_by_itself(scaling: Any) -> None:
    training, asked = features(), features(1)

    def scaled(batch: FeatureParts) -> np.ndarray:
        """The joined vector, with its dense parts scaled one by one."""
        dense = [
            type(scaling)(**scaling.get_params())
            .fit(training.parts[name])
            .transform(batch.parts[name])
            for name in ("near", "far")
        ]
        return np.hstack([batch.parts["histogram"].toarray(), *dense])

    for kernel in (RBF(0.2), Parts({n: RBF(0.2) for n in training.parts}, join="product")):
        svm = SVM(kernel, C=10.0, scaling=scaling).fit(training, LABELS)
        alone = SVM(RBF(0.2), C=10.0).fit(scaled(training), LABELS)
        expected = alone.scores(scaled(asked)).values
        np.testing.assert_allclose(svm.scores(asked).values, expected, atol=1e-6)
        assert isinstance(svm.scaling_, dict)
        assert list(svm.scaling_) == ["near", "far"]
    support = svm.support_features_
    assert isinstance(support, FeatureParts)
    assert sparse.issparse(support.parts["histogram"])
    known = training.parts["histogram"][svm.support_]
    assert (support.parts["histogram"] != known).nnz == 0


class Watched(MKL):
    """Keeps what it has learned its weights from."""

    SEEN: list[tuple[list[float], list[Any]]] = []  # noqa: RUF012

    def fit(self, features: Any, labels: Any = None) -> Watched:
        self.SEEN.append((features.parts["near"][:, 0].tolist(), list(labels)))
        super().fit(features, labels)
        return self


def test_weights_are_learned_from_the_training_rows_of_each_fold() -> None:
    whole, folds = features(), Blocks(n_folds=3)
    near = np.asarray(whole.parts["near"])[:, 0]
    training = TrainingSet(whole, LABELS, np.arange(N), folds=folds)
    rows = [training_rows for training_rows, _ in training.split()]
    expected = [near[each].tolist() for each in rows]
    svm = SVM(Watched(), search={"C": [1.0, 10.0]})
    Watched.SEEN.clear()
    svm.train(training)
    # Once for all to train on in the end, once in each fold of the search.
    seen = sorted(Watched.SEEN, key=lambda each: len(each[0]))
    assert sorted(each for each, _ in seen[:-1]) == sorted(expected)
    assert seen[-1] == (near.tolist(), LABELS.tolist())
    Watched.SEEN.clear()
    held_out = list(svm.out_of_fold(training, training.split()))
    assert sorted(each for each, _ in Watched.SEEN) == sorted(expected)
    # What is held out is scored as by a machine that was trained on the rest alone.
    for (training_rows, held), (same, scores) in zip(training.split(), held_out, strict=True):
        assert same.tolist() == held.tolist()
        alone = SVM(MKL(), C=svm.C_).fit(whole[training_rows], LABELS[training_rows])
        assert scores.values == pytest.approx(alone.scores(whole[held]).values)


def test_learned_weights_are_in_use() -> None:
    svm = SVM(MKL(), scaling=StandardScaling()).fit(features(), LABELS)
    assert isinstance(svm.kernel_, MKL)
    assert set(svm.kernel_.weights_) == {"histogram", "near", "far"}
    scaled = {n: s.transform(features().parts[n]) for n, s in svm.scaling_.items()}  # type: ignore[union-attr]
    batch = FeatureParts({**features().parts, **scaled})
    kernels = {"histogram": Chi2(), "near": RBF(1 / 3), "far": RBF(1 / 2)}
    given = SVM(Parts(kernels, svm.kernel_.weights_)).fit(batch, LABELS)
    expected = given.scores(batch).values
    np.testing.assert_allclose(svm.scores(features()).values, expected, atol=1e-6)


def test_parameters_of_a_part_are_searched() -> None:
    kernels = {"histogram": Chi2(), "near": RBF(), "far": RBF()}
    search = {"kernel__kernels__near__gamma": [1e-9, 0.3], "kernel__join": ["sum", "product"]}
    for kernel in (Parts(kernels), MKL(kernels)):
        tried = dict(search) if isinstance(kernel, Parts) else {**search, "kernel__join": None}
        given = {name: each for name, each in tried.items() if each}
        svm = SVM(kernel, scaling=RangeScaling(), search=given).fit(features(), LABELS)
        assert len(svm.search_["balanced_accuracy"]) == 2 * len(given)
        gamma = svm.chosen_["kernel__kernels__near__gamma"]
        assert svm.kernel_.kernels_["near"].gamma == gamma  # type: ignore[attr-defined]


def test_other_parts_than_in_training_are_refused() -> None:
    svm = SVM(RBF()).fit(features(), LABELS)
    parts = dict(features().parts)
    narrow = FeatureParts({**parts, "far": np.zeros((N, 1))})
    for other in (narrow, FeatureParts({"near": parts["near"]}), np.zeros((N, 11))):
        with pytest.raises(
            ValueError, match=r"SVM was trained on a dense vector of width 2 as far"
        ):
            svm.scores(other)
    dense = SVM(RBF()).fit(np.asarray(parts["near"]), LABELS)
    with pytest.raises(ValueError, match="SVM was trained on features in one piece, got a dense"):
        dense.scores(features())
    # One and the same object may be fitted on others.
    assert isinstance(svm.fit(parts["near"], LABELS).scores(parts["near"]), Scores)


def test_bad_samples_are_named() -> None:
    spoilt = FeatureParts({**features().parts, "far": np.full((N, 2), np.inf)})
    with pytest.raises(ValueError, match="60 of 60 samples hold NaN or infinite"):
        SVM(RBF()).fit(spoilt, LABELS)
    with pytest.raises(ValueError, match="60 samples and 59 labels: give one a sample"):
        SVM(RBF()).fit(features(), LABELS[1:])
    with pytest.raises(UsageError, match=r"kernel Chi2 takes .*, got features in parts: choose"):
        SVM(Chi2()).fit(features(), LABELS)
    with pytest.raises(UsageError, match="search cannot vary 'gamma' of this SVM and kernel"):
        SVM(MKL(), search={"gamma": [1.0]}).fit(features(), LABELS)


@pytest.mark.parametrize("classifier", [AdaBoost(), ScikitLearn("sklearn.naive_bayes.GaussianNB")])
def test_classifiers_of_vectors_refuse_parts(classifier: Any) -> None:
    with pytest.raises(UsageError, match=r"takes dense vectors.*, got features in parts: choose"):
        classifier.fit(features(), LABELS)
