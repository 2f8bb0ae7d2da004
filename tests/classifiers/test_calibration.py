"""Probabilities of an SVM against scikit-learn's calibration, and a reliability diagram."""

import numpy as np
import pytest
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.calibration import CalibratedClassifierCV, calibration_curve
from sklearn.frozen import FrozenEstimator

from placecue import (
    DataError,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
    Scores,
    Shuffled,
    UsageError,
)
from placecue.evaluation.reliability import draw_reliability, reliability
from placecue.folds import InterleavedChunks
from placecue_classifiers.calibration import calibrators, coupled, probabilities
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF

Blobs = tuple[np.ndarray, np.ndarray]
CLASSES = ("corridor", "kitchen", "lab", "office")


class Given(ClassifierMixin, BaseEstimator):
    """Gives its input as its decision function."""

    def __init__(self, n_classes: int = 4) -> None:
        self.n_classes = n_classes
        self.classes_ = np.arange(n_classes)

    def fit(self, X, y):  # type: ignore[no-untyped-def]
        return self

    def decision_function(self, X):  # type: ignore[no-untyped-def]
        return X

    def predict(self, X):  # type: ignore[no-untyped-def]
        return X.argmax(axis=1)


@pytest.mark.parametrize("method", ["sigmoid", "isotonic"])
def test_one_against_all_equals_scikit_learn(method: str) -> None:
    generator = np.random.default_rng(0)
    codes = generator.integers(0, 4, 300)
    values = generator.normal(-0.5, 0.7, (300, 4)) + 1.2 * (codes[:, None] == np.arange(4))
    layout = OneAgainstAll(CLASSES)
    learned = calibrators(method, layout, values, codes)
    found = probabilities(method, learned, layout, values)
    peer = CalibratedClassifierCV(FrozenEstimator(Given()), method=method).fit(values, codes)
    assert found == pytest.approx(peer.predict_proba(values), abs=2e-4)
    assert found.sum(axis=1) == pytest.approx(1)


def test_coupling_recovers_probabilities_that_agree() -> None:
    wanted = np.array([[0.1, 0.2, 0.3, 0.4], [0.25, 0.25, 0.25, 0.25], [0.9, 0.05, 0.03, 0.02]])
    layout = OneAgainstOne(CLASSES)
    pairwise = np.stack([wanted[:, i] / (wanted[:, i] + wanted[:, j]) for i, j in layout.pairs], 1)
    assert coupled(layout, pairwise) == pytest.approx(wanted, abs=1e-9)


def test_coupling_bears_certainty() -> None:
    layout = OneAgainstOne(CLASSES)
    found = coupled(layout, np.ones((1, 6)))
    assert found.argmax() == 0
    assert found.sum() == pytest.approx(1)
    assert np.isfinite(found).all()


@pytest.mark.parametrize("multiclass", ["oaa", "oao", "modified_oaa"])
@pytest.mark.parametrize("method", ["sigmoid", "isotonic"])
def test_probabilities_are_calibrated_on_unseen_samples(
    seen: Blobs, unseen: Blobs, multiclass: str, method: str
) -> None:
    folds = Shuffled()
    svm = SVM(RBF(0.01), C=1.0, multiclass=multiclass, probability=method, folds=folds).fit(*seen)
    scores = svm.scores(unseen[0])
    assert isinstance(scores.layout, Probabilities)
    assert scores.values.sum(axis=1) == pytest.approx(1)
    measured = reliability(scores, unseen[1])
    assert measured.error < 0.12
    plain = SVM(RBF(0.01), C=1.0, multiclass=multiclass).fit(*seen)
    right = (svm.predict(unseen[0]) == unseen[1]).mean()
    assert right > (plain.predict(unseen[0]) == unseen[1]).mean() - 0.05


def test_calibration_learns_from_held_out_outputs_only(seen: Blobs) -> None:
    features, labels = seen
    svm = SVM(RBF(0.01), C=1.0, probability="sigmoid").fit(features, labels)
    values, codes = [], []
    for training, held_out in InterleavedChunks().split(labels):
        part = SVM(RBF(0.01), C=1.0).fit(features[training], labels[training])
        values.append(part.scores(features[held_out]).values)
        codes.append(np.unique(labels, return_inverse=True)[1][held_out])
    layout = OneAgainstAll(tuple(np.unique(labels)))
    expected = calibrators("sigmoid", layout, np.concatenate(values), np.concatenate(codes))
    assert np.array(svm.calibrators_) == pytest.approx(np.array(expected), rel=1e-5)


def test_reliability_equals_scikit_learn_s_curve() -> None:
    generator = np.random.default_rng(1)
    values = generator.dirichlet(np.ones(4), 500)
    labels = np.array(CLASSES)[generator.integers(0, 4, 500)]
    measured = reliability(Scores(values, Probabilities(CLASSES)), labels, bins=8)
    right = np.array(CLASSES)[values.argmax(axis=1)] == labels
    accuracy, probability = calibration_curve(right, values.max(axis=1), n_bins=8)
    filled = measured.counts > 0
    assert measured.accuracy[filled] == pytest.approx(accuracy)
    assert measured.probability[filled] == pytest.approx(probability)
    expected = np.average(np.abs(accuracy - probability), weights=measured.counts[filled])
    assert measured.error == pytest.approx(expected)


def test_the_diagram_is_drawn(seen: Blobs, tmp_path) -> None:  # type: ignore[no-untyped-def]
    svm = SVM(RBF(0.01), C=1.0, probability="sigmoid").fit(*seen)
    measured = reliability(svm.scores(seen[0]), seen[1])
    path = draw_reliability({"crfh": measured, "laser": measured}, tmp_path / "r.svg", title="t")
    assert "crfh" in path.read_text() or path.stat().st_size > 1000
    with pytest.raises(UsageError, match="no picture file"):
        draw_reliability({"crfh": measured}, tmp_path / "r.txt")


def test_only_probabilities_have_a_diagram() -> None:
    with pytest.raises(UsageError, match="needs probabilities, got one_against_all"):
        reliability(Scores(np.zeros((1, 4)), OneAgainstAll(CLASSES)), ["lab"])
    with pytest.raises(DataError, match="got none"):
        reliability(Scores(np.zeros((0, 4)), Probabilities(CLASSES)), [])
