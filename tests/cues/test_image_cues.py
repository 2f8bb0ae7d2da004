"""What every image cue owes: one vector whatever the image's form, clear errors, cloning."""

from functools import lru_cache

import numpy as np
import pytest
from sklearn.base import clone

from pictures import grey_photograph, in_every_form, observe, stripes
from placecue import Cue, Observation, UnusableObservation, UsageError
from placecue_cues.bag_of_words import BagOfWords
from placecue_cues.color_histogram import ColorHistogram
from placecue_cues.crfh import CRFH
from placecue_cues.dense_sift import DenseSift
from placecue_cues.fisher_vector import FisherVector
from placecue_cues.gist import Gist
from placecue_cues.laser import LaserGeometry
from placecue_cues.sift import SIFT

NAMES = ("crfh", "sift", "dense_sift", "gist", "color_histogram", "fisher_vector", "bag_of_words")


@lru_cache
def cue(name: str) -> Cue:
    made: dict[str, Cue] = {
        "crfh": CRFH(),
        "sift": SIFT(),
        "dense_sift": DenseSift(step=16, cells=(6,)),
        "gist": Gist(),
        "color_histogram": ColorHistogram(),
        "fisher_vector": FisherVector(components=8, gaussians=4, sample=800),
        "bag_of_words": BagOfWords(words=10, sample=800),
    }
    training = [observe(stripes(8, 0.3 * i, i)) for i in range(6)]
    return made[name].fit(training)


def dense(features: object) -> np.ndarray:
    return features.toarray() if hasattr(features, "toarray") else np.asarray(features)


@pytest.mark.parametrize("name", NAMES)
def test_grey_colour_and_sixteen_bits_agree(name: str) -> None:
    first, *others = (cue(name).features(observe(i)) for i in in_every_form(grey_photograph()))
    for other in others:
        if name == "crfh":
            assert (first != other).nnz == 0
        else:
            np.testing.assert_allclose(dense(other), dense(first), atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_images_of_another_size_fit_one_batch(name: str) -> None:
    images = [stripes(8, 1.0, 1, side) for side in (64, 96, 150)]
    batch = cue(name).transform(map(observe, images))
    assert batch.shape[0] == 3


@pytest.mark.parametrize("name", NAMES)
def test_a_bare_wall_has_finite_features(name: str) -> None:
    for level in (0, 200):
        features = cue(name).features(observe(np.full((120, 160), level, np.uint8)))
        values = features.data if hasattr(features, "nnz") else features
        assert np.isfinite(values).all()


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros((50, 50)), "takes 8-bit RGB .* got float64"),
        (np.zeros((50, 50, 4), np.uint8), r"takes 8-bit RGB .* \(50, 50, 4\)"),
        (np.zeros((0, 40), np.uint8), "pixels"),
        (np.zeros((40, 0, 3), np.uint8), "pixels"),
    ],
)
@pytest.mark.parametrize("name", NAMES)
def test_unusable_images(name: str, image: np.ndarray, message: str) -> None:
    with pytest.raises(UnusableObservation, match=f"{name}.*{message}|{message}"):
        cue(name).features(observe(image))


@pytest.mark.parametrize("name", NAMES)
def test_missing_image_and_cloning(name: str) -> None:
    with pytest.raises(UnusableObservation, match="no image at stamp 0"):
        cue(name).features(Observation(0))
    assert clone(cue(name)).get_params() == cue(name).get_params()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (SIFT(keypoints=0), "above 0, got keypoints=0"),
        (SIFT(sigma=-1.0, octave_layers=0), "octave_layers=0, sigma=-1.0"),
        (Gist([]), "orientations >= 1"),
        (Gist(size=130), "grid divides, got 130 and 4"),
        (Gist(prefilter=-1.0), "prefilter >= 0"),
        (ColorHistogram([4, 4]), "three numbers of bins"),
        (ColorHistogram(chroma_limit=0.0), "chroma_limit > 0"),
        (DenseSift(step=0), "dense_sift needs longest_side, step and cells"),
        (FisherVector(descriptors=DenseSift(cells=[])), "dense_sift needs longest_side, step and"),
        (BagOfWords(descriptors=DenseSift(contrast=-1.0)), "contrast >= 0"),
        (FisherVector(descriptors=BagOfWords()), "by a cue that learns nothing, .* got BagOfWords"),
        (BagOfWords(descriptors=LaserGeometry()), "descriptors of images .* got LaserGeometry"),
        (
            BagOfWords(descriptors=Gist()),
            "of local descriptors, .*; Gist gives one vector an image",
        ),
        (
            FisherVector(descriptors=Gist(), pyramid=[1, 2]),
            r"Gist does not say where its descriptors are, so pyramid must be \[1\], got \[1, 2\]",
        ),
        (FisherVector(pyramid=[0]), "pyramid levels >= 1"),
        (FisherVector(components=129), "up to 128"),
        (FisherVector(gaussians=0), "gaussians and iterations >= 1"),
        (FisherVector(sample=10), "a sample larger than"),
        (BagOfWords(words=0), "words >= 1"),
        (BagOfWords(words=9, sample=8), "a sample of as many"),
        (BagOfWords(pyramid=[]), "pyramid levels >= 1"),
    ],
)
def test_wrong_parameters(wrong: Cue, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        wrong.fit([observe(stripes(8, 1.0, 1))]).features(observe(stripes(8, 1.0, 1)))
