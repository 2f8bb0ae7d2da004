"""SVM-DAS joins outputs of any layout; five classes, so that layouts differ in width."""

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import MinMaxScaler
from sklearn.svm import SVC

from placecue import (
    DataError,
    Kernel,
    OneAgainstAll,
    OneAgainstOne,
    Scores,
    StoredEvidence,
    UsageError,
)
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF

CLASSES = ("corridor", "kitchen", "lab", "office", "printer")


@pytest.fixture(scope="module")
def labelled() -> tuple[StoredEvidence, np.ndarray]:
    """Two cues, each sure of other classes: one-against-all and one-against-one outputs."""
    generator = np.random.default_rng(7)
    codes = np.repeat(np.arange(5), 40)
    first = generator.normal(size=(200, 5))
    first[np.arange(200), codes] += np.where(codes < 2, 3.0, 0.5)
    layout = OneAgainstOne(CLASSES)
    second = generator.normal(scale=5.0, size=(200, 10))
    for column, (i, j) in enumerate(layout.pairs):
        second[:, column] += 12.0 * ((codes == i) * 1.0 - (codes == j)) * (codes >= 2)
    scores = {
        "vision": Scores(first, OneAgainstAll(CLASSES)),
        "laser": Scores(second, layout),
    }
    return StoredEvidence(scores), np.array(CLASSES)[codes]


def test_it_equals_an_svm_on_the_scaled_and_joined_outputs(
    labelled: tuple[StoredEvidence, np.ndarray],
) -> None:
    evidence, labels = labelled
    das = SVMDAS(classifier=SVM(kernel=RBF(gamma=0.1), C=5.0)).fit(evidence, labels)
    joined = np.hstack([evidence.scores(cue).values for cue in ("vision", "laser")])
    for code, name in enumerate(CLASSES):
        peer = make_pipeline(
            MinMaxScaler((-1, 1)), SVC(gamma=0.1, C=5.0, class_weight="balanced")
        ).fit(joined, labels == name)
        found = das.integrate(evidence).values[:, code]
        assert found == pytest.approx(peer.decision_function(joined), abs=1e-6)


def test_together_is_better_than_either_cue(
    labelled: tuple[StoredEvidence, np.ndarray],
) -> None:
    evidence, labels = labelled
    fit, test = np.arange(0, 200, 2), np.arange(1, 200, 2)
    half = evidence.take(fit)
    das = SVMDAS(classifier=SVM(kernel=Linear(), C=1.0, multiclass="oao")).fit(half, labels[fit])
    integrated = np.mean(das.integrate(evidence.take(test)).decide().labels == labels[test])
    alone = [
        np.mean(evidence.scores(cue)[test].decide().labels == labels[test]) for cue in evidence.cues
    ]
    assert integrated > max(alone)


def test_cues_are_joined_in_the_order_of_fitting(
    labelled: tuple[StoredEvidence, np.ndarray],
) -> None:
    evidence, labels = labelled
    das = SVMDAS(classifier=SVM(kernel=RBF(gamma=0.1))).fit(evidence, labels)
    turned = StoredEvidence({cue: evidence.scores(cue) for cue in ("laser", "vision")})
    assert (das.integrate(turned).values == das.integrate(evidence).values).all()


@pytest.mark.parametrize("kernel", [RBF(gamma=0.1), Linear(), HistogramIntersection()])
@pytest.mark.parametrize("multiclass", ["oao", "oaa", "modified_oaa"])
def test_one_cue_and_gaps(
    labelled: tuple[StoredEvidence, np.ndarray], kernel: Kernel, multiclass: str
) -> None:
    evidence, labels = labelled
    values = evidence.scores("laser").values.copy()
    values[::7] = np.nan
    one = StoredEvidence({"laser": Scores(values, evidence.layout("laser"))})
    das = SVMDAS(classifier=SVM(kernel=kernel, multiclass=multiclass)).fit(one, labels)
    found = das.integrate(one)
    assert (found.available() == (np.arange(200) % 7 != 0)).all()
    there = found.available()
    assert np.mean(found[there].decide().labels == labels[there]) > 0.6
    # One at a time is the same as all at once.
    alone = np.concatenate([das.integrate(one.take([row])).values for row in range(30)])
    assert alone == pytest.approx(found.values[:30], abs=1e-9, nan_ok=True)


def test_histogram_intersection_is_of_scores_less_their_minimum(
    labelled: tuple[StoredEvidence, np.ndarray],
) -> None:
    evidence, labels = labelled
    svm = SVM(kernel=HistogramIntersection(), C=5.0, multiclass="oaa")
    das = SVMDAS(classifier=svm).fit(evidence, labels)
    joined = np.hstack([evidence.scores(cue).values for cue in ("vision", "laser")])
    scaled = MinMaxScaler((-1, 1)).fit_transform(joined) + 1  # the minimum of each is -1
    gram = np.minimum(scaled[:, None], scaled[None]).sum(axis=2)
    for code, name in enumerate(CLASSES):
        peer = SVC(kernel="precomputed", C=5.0, class_weight="balanced").fit(gram, labels == name)
        found = das.integrate(evidence).values[:, code]
        assert found == pytest.approx(peer.decision_function(gram), abs=1e-6)


def test_a_boosted_list_and_an_svm_are_joined() -> None:
    generator = np.random.default_rng(9)
    codes = np.repeat(np.arange(5), 30)
    features = generator.normal(size=(150, 5)) + 3 * np.eye(5)[codes]
    labels = np.array(CLASSES)[codes]
    fit, held_out = np.arange(0, 150, 2), np.arange(1, 150, 2)
    models = {
        "boosted": AdaBoost(rounds=10).fit(features[fit], labels[fit]),
        "svm": SVM(kernel=RBF(), multiclass="oao").fit(features[fit], labels[fit]),
    }
    evidence = StoredEvidence({n: each.scores(features[held_out]) for n, each in models.items()})
    assert evidence.layout("boosted").name == "decision_list"
    das = SVMDAS(classifier=SVM(kernel=RBF(), multiclass="oao")).fit(evidence, labels[held_out])
    assert das.integrate(evidence).layout == OneAgainstOne(CLASSES)
    assert np.mean(das.integrate(evidence).decide().labels == labels[held_out]) > 0.9


def test_a_class_without_a_complete_sample_is_told(
    labelled: tuple[StoredEvidence, np.ndarray],
) -> None:
    evidence, labels = labelled
    values = evidence.scores("laser").values.copy()
    values[labels == "lab"] = np.nan
    gap = StoredEvidence(
        {
            "vision": evidence.scores("vision"),
            "laser": Scores(values, evidence.layout("laser")),
        }
    )
    with pytest.raises(DataError, match=r"no sample of lab has scores of all cues \(vision, las"):
        SVMDAS(classifier=SVM(kernel=RBF())).fit(gap, labels)
    values[:] = np.nan
    with pytest.raises(DataError, match="no sample has scores of all cues"):
        SVMDAS(classifier=SVM(kernel=RBF())).fit(gap, labels)


def test_scikit_learn_contract() -> None:
    das = SVMDAS(classifier=SVM(kernel=RBF(gamma=0.1)))
    assert clone(das).get_params()["classifier__kernel__gamma"] == 0.1
    assert das.set_params(classifier__C=7.0).classifier.C == 7.0


def test_a_classifier_is_needed(labelled: tuple[StoredEvidence, np.ndarray]) -> None:
    with pytest.raises(UsageError, match="svm_das needs a classifier"):
        SVMDAS().fit(*labelled)


def test_evidence_must_be_of_the_same_observations() -> None:
    with pytest.raises(UsageError, match=r"'a': 3, 'b': 2"):
        StoredEvidence(
            {
                "a": Scores(np.zeros((3, 5)), OneAgainstAll(CLASSES)),
                "b": Scores(np.zeros((2, 5)), OneAgainstAll(CLASSES)),
            }
        )
