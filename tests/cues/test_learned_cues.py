"""Fisher vectors and visual words: the mathematics, and what is learned from whom."""

import logging
from collections.abc import Callable

import numpy as np
import pytest
from sklearn.mixture import GaussianMixture

from pictures import observe, stripes
from placecue import Cue, DataError, Observation, UsageError
from placecue.components.manager import load_plugins
from placecue.storage.state import Decoder, Encoder
from placecue_classifiers.svm import SVM
from placecue_cues.bag_of_words import BagOfWords
from placecue_cues.descriptor_sample import descriptor_sample
from placecue_cues.fisher import Mixture, power_normalised
from placecue_cues.fisher_vector import FisherVector
from placecue_cues.sift import SIFT
from placecue_kernels.chi2 import Chi2
from placecue_kernels.linear import Linear

REGISTRY = load_plugins(built_ins_only=True).registry
ROOMS = {"corridor": 0.0, "kitchen": 0.8, "lab": 1.6, "office": 2.4}


def fisher(**parameters: object) -> FisherVector:
    return FisherVector(**{"components": 12, "gaussians": 6, "sample": 3000, **parameters})


def words(**parameters: object) -> BagOfWords:
    return BagOfWords(**{"words": 16, "sample": 3000, **parameters})


def views(count: int, seed: int) -> tuple[list[Observation], np.ndarray]:
    labels = np.repeat(list(ROOMS), count)
    images = [stripes(9, ROOMS[name], seed + i) for i, name in enumerate(labels)]
    return [observe(image) for image in images], labels


def test_fisher_vector_is_the_gradient_of_the_log_likelihood() -> None:
    rng = np.random.default_rng(0)
    x = rng.normal(size=(40, 3)).astype(np.float32)
    weights, means = np.array([0.2, 0.5, 0.3]), rng.normal(size=(3, 3))
    deviations = rng.uniform(0.5, 1.5, (3, 3))

    def likelihood(means: np.ndarray, deviations: np.ndarray) -> float:
        model = GaussianMixture(3, covariance_type="diag")
        model.weights_, model.means_ = weights, means
        model.covariances_, model.precisions_cholesky_ = deviations**2, 1 / deviations
        return float(model.score(x.astype(np.float64)))

    wanted, step = [], 1e-6
    for which, factor in ((0, 1.0), (1, 0.5)):
        for k in range(3):
            for d in range(3):
                up, down = ([means.copy(), deviations.copy()] for _ in range(2))
                up[which][k, d] += step
                down[which][k, d] -= step
                slope = (likelihood(*up) - likelihood(*down)) / (2 * step)
                wanted.append(slope * deviations[k, d] * np.sqrt(factor / weights[k]))
    mixture = Mixture(weights, means, deviations**2)
    found = mixture.fisher_vector(x, mixture.posteriors(x))
    np.testing.assert_allclose(found, wanted, atol=1e-4)


def test_posteriors_equal_scikit_learn() -> None:
    x = np.random.default_rng(1).normal(size=(300, 5)).astype(np.float32)
    model = GaussianMixture(4, covariance_type="diag", random_state=0).fit(x)
    mixture = Mixture(model.weights_, model.means_, model.covariances_)
    np.testing.assert_allclose(mixture.posteriors(x), model.predict_proba(x), atol=1e-4)


def test_power_normalisation() -> None:
    found = power_normalised(np.array([4.0, -9.0, 0.0], np.float32))
    np.testing.assert_allclose(found, np.array([2, -3, 0]) / np.sqrt(13), atol=1e-6)
    np.testing.assert_array_equal(power_normalised(np.zeros(2, np.float32)), [0, 0])


@pytest.mark.parametrize(
    ("cue", "kernel"), [(fisher(), Linear()), (words(), Chi2(1.0))], ids=["fisher", "words"]
)
def test_tells_four_rooms_apart(cue: Cue, kernel: Linear | Chi2) -> None:
    training, labels = views(6, 0)
    asked, truth = views(4, 100)
    model = SVM(kernel=kernel).fit(cue.fit(training).transform(training), labels)
    assert np.mean(model.scores(cue.transform(asked)).decide().labels == truth) > 0.9


@pytest.mark.parametrize("cue", [fisher(), words()], ids=["fisher", "words"])
def test_learning_is_repeatable_and_is_stored_as_arrays(cue: Cue) -> None:
    training, _ = views(2, 0)
    asked = observe(stripes(7, 1.1, 50))
    first = cue.fit(training).features(asked)
    np.testing.assert_array_equal(cue.fit(iter(training)).features(asked), first)
    encoder = Encoder(REGISTRY)
    state = encoder.state(cue, "cue")
    again = type(cue)(**cue.get_params())
    Decoder(REGISTRY, encoder.arrays).restore(again, state)
    np.testing.assert_array_equal(again.features(asked), first)


def test_shapes_and_norms() -> None:
    training, _ = views(2, 0)
    asked = observe(stripes(7, 1.1, 50))
    found = fisher(pyramid=(1, 2)).fit(training).features(asked)
    assert found.shape == (2 * 12 * 6 * 5,)
    assert found.dtype == np.float32
    assert np.linalg.norm(found) == pytest.approx(1, abs=1e-5)
    levels = words(pyramid=(1, 2)).fit(training).features(asked)
    assert levels.shape == (16 * 5,)
    assert levels.sum() == pytest.approx(1)
    # The four quarters hold the words of the whole.
    np.testing.assert_allclose(levels[16:].reshape(4, 16).sum(axis=0), levels[:16])
    bare = observe(np.full((96, 96), 80, np.uint8))
    assert not fisher().fit(training).features(bare).any()
    assert not words().fit(training).features(bare).any()


@pytest.mark.parametrize("cue", [fisher(), words()], ids=["fisher", "words"])
def test_mistakes(cue: Cue) -> None:
    fresh = type(cue)(**cue.get_params())
    with pytest.raises(UsageError, match="fit it on training images first"):
        fresh.features(observe(stripes(7, 1.1, 50)))
    with pytest.raises(DataError, match="local descriptors or more, got 0 from 2"):
        fresh.fit([observe(np.full((96, 96), 80, np.uint8))] * 2)
    with pytest.raises(DataError, match="no usable observation: 1 of 1"):
        fresh.fit([Observation(0)])


def colours(image: np.ndarray) -> np.ndarray:
    """The colour of each quarter, written without a cue."""
    return np.array([part.mean() for row in np.split(image, 2) for part in np.split(row, 2, 1)])


class Quarters(Cue):
    """The grey level of each quarter as a local descriptor, from nobody knows where."""

    requires = ("image",)

    def extract(self, observation: Observation) -> np.ndarray:
        return colours(np.asarray(observation.image))[:, None]


def test_words_of_descriptors_of_ones_own() -> None:
    dark, light = (np.full((8, 8), level, np.uint8) for level in (10, 200))
    mixed = np.block([[dark, dark], [dark, light]])
    cue = BagOfWords(words=2, descriptors=Quarters(), sample=100)
    cue.fit([observe(each) for each in (dark, light, mixed)])
    assert sorted(np.round(cue.words_[:, 0]).tolist()) == [10, 200]
    first = int(cue.words_[0, 0] > 100)
    for image, wanted in ((dark, [1, 0]), (light, [0, 1]), (mixed, [0.75, 0.25])):
        found = cue.features(observe(image))
        np.testing.assert_allclose(found, wanted[::-1] if first else wanted)


@pytest.mark.parametrize("kind", [fisher, words])
def test_interest_points_in_quarters(kind: Callable[..., Cue]) -> None:
    points = SIFT(contrast_threshold=0.01)
    image = np.full((120, 160), 90, np.uint8)
    image[70:110, 90:150] = stripes(8, 1.0, 3)[:40, :60]  # all there is is down on the right
    places = points.patches(observe(image)).places
    assert len(places) > 5
    assert (places.min(axis=0) > 0.4).all()
    training = [observe(stripes(8, 0.3 * i, i)) for i in range(8)]
    small = {"components": 4, "gaussians": 2} if kind is fisher else {"words": 5}
    cue = kind(descriptors=points, pyramid=[2], sample=300, **small).fit(training)
    quarters = np.split(np.asarray(cue.features(observe(image))), 4)
    assert [bool(each.any()) for each in quarters][3]
    assert not quarters[0].any()


def described(observation: Observation) -> np.ndarray:
    observation.require(("image",))
    return np.repeat(np.asarray(observation.image)[0, :, None], 2, axis=1).astype(np.float32)


def numbers(first: int, count: int) -> Observation:
    return Observation(0, image=np.arange(first, first + count)[None])


def test_sample_of_few_is_all_of_them() -> None:
    found = descriptor_sample([numbers(0, 5), numbers(5, 3)], described, 10, 0, 1, "cue")
    np.testing.assert_array_equal(found[:, 0], np.arange(8))


def test_sample_is_uniform_over_descriptors() -> None:
    images = [numbers(0, 1000), *(numbers(1000 + 10 * i, 10) for i in range(300))]
    drawn = np.concatenate(
        [descriptor_sample(images, described, 200, seed, 1, "cue")[:, 0] for seed in range(20)]
    )
    assert len(drawn) == 4000
    # A quarter of all descriptors are of the first image; 5 standard deviations.
    assert np.mean(drawn < 1000) == pytest.approx(0.25, abs=0.034)
    assert np.mean(drawn > 2500) == pytest.approx(0.375, abs=0.038)


def test_unusable_images_are_passed_over_and_reported_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    images = [Observation(0), numbers(0, 5), Observation(1)]
    with caplog.at_level(logging.WARNING):
        found = descriptor_sample(images, described, 10, 0, 1, "cue")
    assert len(found) == 5
    assert len(caplog.records) == 1
    assert "2 of 3 observations passed over" in caplog.text
