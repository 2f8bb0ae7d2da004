"""What no classifier can learn from or score: said in one line, by every classifier alike."""

import numpy as np
import pytest
from scipy import sparse
from sklearn.base import clone

from placecue import Classifier, Cue, DataError, DescriptorSets, Observation, Pipeline, UsageError
from placecue.errors import ContractError
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.match import Match
from placecue_kernels.rbf import RBF

Blobs = tuple[np.ndarray, np.ndarray]
ROOMS = ("corridor", "kitchen", "lab", "office")
DENSE = [
    SVM(kernel=RBF(0.05)),
    SVM(kernel=RBF(0.05), search={"C": [1, 10]}, probability="sigmoid"),
    AdaBoost(rounds=3),
    ScikitLearn("sklearn.naive_bayes.GaussianNB"),
]
each_classifier = pytest.mark.parametrize("classifier", DENSE, ids=str)


@each_classifier
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_spoilt_features(classifier: Classifier, bad: float, seen: Blobs) -> None:
    features, labels = seen
    spoilt = features.copy()
    spoilt[7, 2] = bad
    with pytest.raises(DataError, match=r"1 of 175 samples hold NaN .* the first is number 7$"):
        clone(classifier).fit(spoilt, labels)
    fitted = clone(classifier).fit(features, labels)
    with pytest.raises(DataError, match=r"1 of 9 samples hold NaN .* the first is number 7$"):
        fitted.scores(spoilt[:9])


def test_spoilt_descriptors_and_histograms() -> None:
    values = np.random.default_rng(0).random((24, 5)).astype(np.float32)
    values[13, 1] = np.nan
    sets, labels = DescriptorSets(values, np.arange(0, 25, 2)), np.repeat(ROOMS, 3)
    with pytest.raises(DataError, match=r"1 of 12 samples hold NaN .* number 6$"):
        SVM(kernel=Match()).fit(sets, labels)
    histograms = sparse.csr_array(values[:12])
    histograms.data[7 * 5 + 2] = np.inf
    with pytest.raises(DataError, match=r"1 of 12 samples hold NaN .* number 7$"):
        ScikitLearn("sklearn.naive_bayes.MultinomialNB").fit(histograms, labels)


@each_classifier
def test_one_class(classifier: Classifier, seen: Blobs) -> None:
    with pytest.raises(DataError, match=r"of one class only \('lab', 175 of them\)"):
        clone(classifier).fit(seen[0], np.repeat("lab", 175))


@each_classifier
def test_features_of_a_wrong_kind(classifier: Classifier, seen: Blobs) -> None:
    sets = DescriptorSets(np.ones((175, 2)), np.arange(176))
    with pytest.raises(UsageError, match=r"takes .*, got set of local descriptors: choose another"):
        clone(classifier).fit(sets, seen[1])


@each_classifier
def test_fewer_samples_than_folds(classifier: Classifier) -> None:
    features = np.random.default_rng(0).normal(size=(8, 3))
    labels = np.repeat(ROOMS, 2)
    fitted = clone(classifier).fit(features, labels)
    assert np.isfinite(fitted.scores(features).values).all()


class Pixels(Cue):
    """Every pixel: features whose number is that of the image's pixels."""

    requires = ("image",)

    def extract(self, observation: Observation) -> np.ndarray:
        return np.asarray(observation.image, dtype=np.float64).ravel()


def pictures(height: int, width: int) -> list[Observation]:
    def picture(room: int, number: int) -> np.ndarray:
        noise = np.random.default_rng((room, number)).integers(0, 9, (height, width))
        return (50 * room + noise).astype(np.uint8)

    return [
        Observation(number, image=picture(room, number), label=name)
        for room, name in enumerate(ROOMS)
        for number in range(5)
    ]


@each_classifier
def test_images_of_another_size_for_a_cue_of_fixed_size(classifier: Classifier) -> None:
    pipeline = Pipeline({"pixels": (Pixels(), clone(classifier))}).fit(pictures(6, 8))
    assert len(list(pipeline.beliefs(pictures(6, 8)))) == 20
    with pytest.raises(DataError, match=r"has 72 features, .* is expecting 48 .*another size"):
        list(pipeline.beliefs(pictures(8, 9)))
    with pytest.raises(ContractError, match="of width 72 after a dense vector of width 48"):
        Pipeline({"pixels": (Pixels(), clone(classifier))}).fit(pictures(6, 8) + pictures(8, 9))
