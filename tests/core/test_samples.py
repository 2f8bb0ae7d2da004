"""Augmented copies of observations are trained on, and never scored."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import ClassVar

import numpy as np
import pytest

import toys
from placecue import (
    Cue,
    InterleavedChunks,
    LaserScan,
    Observation,
    OneAgainstAll,
    Pipeline,
    Scores,
    UsageError,
)
from placecue.classifier import Classifier
from placecue.cue_model import CueModel
from placecue.errors import ContractError
from placecue.learning.collecting import collect
from placecue.scaling import RangeScaling
from placecue_classifiers.svm import SVM
from placecue_cues.laser import LaserGeometry
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import Walk


def scaled(observation: Observation, factor: float) -> Observation:
    assert observation.scan is not None
    return observation.altered(f"times {factor}", scan=observation.scan.scaled(factor))


class Doubled(toys.Beams):
    """Training also sees everything at half and twice the size."""

    def augmentations(self) -> list[partial[Observation]]:
        return [partial(scaled, factor=factor) for factor in (0.5, 2.0)]


class Unsaid(toys.Beams):
    """Its copies look like what was recorded."""

    def augmentations(self) -> list[object]:
        return [self._halved]

    @staticmethod
    def _halved(each: Observation) -> Observation:
        return Observation(each.stamp, scan=each.scan.scaled(0.5), origin=each.origin)


def test_a_copy_that_does_not_say_what_it_is_is_refused() -> None:
    """Kept features of what was recorded would be taken for its own."""
    refused = "augmentation returned other parts as if they were recorded.* at stamp 0 of walk 0$"
    with pytest.raises(ContractError, match=refused):
        collect(Walk(rounds=1), {"beams": Unsaid()})


class Namesakes(toys.Beams):
    """Two augmentations of one name."""

    def augmentations(self) -> list[partial[Observation]]:
        return [partial(self._scaled, factor=factor) for factor in (0.5, 2.0)]

    @staticmethod
    def _scaled(each: Observation, factor: float) -> Observation:
        return each.altered("scaled", scan=each.scan.scaled(factor))


class LearningNamesakes(Namesakes):
    """Likewise, and learns."""

    learns = True


@pytest.mark.parametrize("cue", [Namesakes(), LearningNamesakes()])
def test_augmentations_of_one_name_are_refused(cue: Cue) -> None:
    """Kept features of one would be taken for those of the other."""
    pipeline = Pipeline({"beams": (cue, SVM(RBF()))})
    with pytest.raises(ContractError, match="2 augmentations call their copies 'scaled'"):
        pipeline.fit(Walk(rounds=1))


class LearningDoubled(toys.Brightness):
    """An image cue that learns, and doubles its samples."""

    def augmentations(self) -> list[object]:
        return [lambda each: each.altered("negative", image=255 - each.image)]


class Noting(Classifier):
    """Notes what it is trained on and asked about."""

    trained: ClassVar[list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = []
    asked: ClassVar[list[np.ndarray]] = []

    def fit(self, features, labels, stamps=None):  # type: ignore[no-untyped-def]
        self.trained.append((features, labels, stamps))
        self.layout_ = OneAgainstAll(tuple(np.unique(labels)))
        return self

    def scores(self, features):  # type: ignore[no-untyped-def]
        self.asked.append(features)
        return Scores(np.zeros((len(features), len(self.layout_.classes))), self.layout_)

    def best(self) -> Noting:
        return Noting()


@pytest.fixture
def noting() -> Noting:
    Noting.trained, Noting.asked = [], []
    return Noting()


def by_hand(observations: Iterable[Observation], factors: tuple[float, ...]) -> np.ndarray:
    """Each scan followed by its copies, written without the cue."""
    rows = []
    for each in observations:
        assert each.scan is not None
        rows += [np.minimum(each.scan.ranges * factor, 20.0)[:4] for factor in factors]
    return np.array(rows)


def test_each_sample_is_followed_by_its_copies(noting: Noting) -> None:
    Pipeline({"beams": (Doubled(), noting)}).fit(Walk())
    [(features, labels, stamps)] = noting.trained
    np.testing.assert_allclose(features, by_hand(Walk(), (1.0, 0.5, 2.0)))
    assert labels.tolist() == [each.label for each in Walk() for _ in range(3)]
    assert stamps.tolist() == [each.stamp for each in Walk() for _ in range(3)]


def test_held_out_samples_are_scored_as_recorded(noting: Noting) -> None:
    samples = collect(Walk(), {"beams": Doubled()})
    folds, model = InterleavedChunks(), CueModel(Doubled(), noting)
    model.fit(samples.training_set("beams", model.cue))
    Noting.trained.clear()
    model.held_out(samples.training_set("beams", model.cue), folds)
    every = list(Walk())
    splits = folds.split(samples.labels, samples.stamps)
    for (training, held_out), (features, _, _), asked in zip(
        splits, noting.trained, noting.asked, strict=True
    ):
        recorded = by_hand((every[row] for row in held_out), (1.0,))
        np.testing.assert_allclose(asked, recorded)
        copies = by_hand((every[row] for row in training), (1.0, 0.5, 2.0))
        np.testing.assert_allclose(features, copies)


def test_copies_of_a_cue_that_learns(noting: Noting) -> None:
    Pipeline({"brightness": (LearningDoubled(), noting)}).fit(Walk())
    [(features, _, _)] = noting.trained
    means = np.array([each.image.mean(axis=(0, 1)) for each in Walk()])
    # It learns from what was recorded alone.
    np.testing.assert_allclose(features[::2], means - means.mean(axis=0))
    np.testing.assert_allclose(features[1::2], 255 - means - means.mean(axis=0))


def test_a_scan_scaled() -> None:
    scan = LaserScan(np.linspace(-1, 1, 5), np.array([1.0, 9.0, np.nan, 12.0, 0.3]), 0.25, 10.0)
    larger, smaller = scan.scaled(1.25), scan.scaled(0.8)
    # 11.25 m is out of reach; what was no echo stays none.
    np.testing.assert_allclose(larger.filled(), [1.25, 10.0, 10.0, 10.0, 0.375])
    np.testing.assert_allclose(smaller.filled(), [0.8, 7.2, 10.0, 10.0, 0.25], atol=1e-6)
    assert (larger.range_min, larger.range_max) == (0.25, 10.0)


def test_the_laser_cue_sees_rooms_of_other_sizes(noting: Noting) -> None:
    angles = np.radians(np.linspace(-90, 90, 181))
    rooms = [
        Observation(
            number * toys.SECOND,
            scan=LaserScan(angles, 1.0 + number % 4 + 0.1 * np.cos(angles), 0.0, 30.0),
            label=toys.PLACES[number % 4],
        )
        for number in range(16)
    ]
    cue = LaserGeometry("full", scales=[0.8, 1, 1.25])
    Pipeline({"laser": (cue, noting)}).fit(rooms)
    [(features, _, _)] = noting.trained
    assert features.shape == (48, len(cue.feature_names))
    mean = next(name for name in cue.feature_names if "mean" in name and "range" in name)
    column = cue.feature_names.index(mean)
    np.testing.assert_allclose(features[1::3, column], 0.8 * features[::3, column], rtol=1e-6)
    np.testing.assert_allclose(features[2::3, column], 1.25 * features[::3, column], rtol=1e-6)
    plain = LaserGeometry("full").transform(rooms)
    # Extracted in a batch of another size, which BLAS may sum in another order.
    np.testing.assert_allclose(features[::3], plain, rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(cue.transform(rooms), plain)


@pytest.mark.parametrize("wrong", [0.0, -1.0])
def test_a_scale_that_cannot_be(wrong: float) -> None:
    with pytest.raises(UsageError, match="laser scales must be above 0"):
        Pipeline({"laser": (LaserGeometry(scales=[1, wrong]), SVM(kernel=RBF()))}).fit(Walk())


def test_two_cues_one_of_which_has_copies() -> None:
    cues: dict[str, tuple[Cue, Classifier]] = {
        "beams": (Doubled(), SVM(kernel=RBF(gamma=0.1), search={"C": [1, 10]})),
        "brightness": (toys.Brightness(), SVM(kernel=RBF(gamma=0.001), scaling=RangeScaling())),
    }
    pipeline = Pipeline(cues, SVMDAS(SVM(kernel=RBF(gamma=0.3), multiclass="oao"))).fit(Walk())
    beliefs = list(pipeline.beliefs(Walk(seed=1)))
    right = [b.label == o.label for b, o in zip(beliefs, Walk(seed=1), strict=True)]
    assert np.mean(right) > 0.9


class InFamilies(toys.Beams):
    """The first few beams, the first two of which are alike."""

    families = ("near", "near", "far", "far")


class InTooFew(toys.Beams):
    """Names the families of some of its features."""

    families = ("near", "far")


def test_a_training_set_knows_the_families_of_its_features() -> None:
    cues = {"families": InFamilies(), "plain": toys.Beams()}
    samples = collect(Walk(rounds=1), cues)
    assert samples.training_set("families", cues["families"]).families == InFamilies.families
    assert samples.training_set("plain", cues["plain"]).families is None


class LearningFamilies(toys.Brightness):
    """Learns, and says what its features are."""

    families = ("red", "green", "blue")


def test_a_fold_of_a_cue_that_learns_is_in_the_same_families() -> None:
    cue = LearningFamilies()
    training = collect(Walk(rounds=1), {"colour": cue}).training_set("colour", cue)
    assert training.families == LearningFamilies.families
    assert training.relearned(np.arange(40)).families == LearningFamilies.families


def test_families_are_as_many_as_features() -> None:
    refused = r"^cue InTooFew \(.*\): families names 2 columns of 4$"
    with pytest.raises(ContractError, match=refused):
        Pipeline({"beams": (InTooFew(), SVM(RBF()))}).fit(Walk(rounds=1))
