"""Training extracts a batch as a batch: a network looks at 32 images faster than 32 times at one.

What is written here as 32 is a promise to whoever writes a cue with a ``transform`` of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toys
from placecue import Component, Observation, Pipeline, UnusableObservation
from placecue.learning.collecting import collect
from placecue.storage.feature_cache import FeatureCache
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness, Walk

#: The sizes of the batches that each cue was asked for, in order.
SIZES: list[int] = []
#: Observations that nothing can be made of, by stamp.
SPOILT: set[int] = set()
#: A log of 80 observations: two batches, and a half.
WHOLE = [32, 32, 16]


@pytest.fixture(autouse=True)
def _nothing_seen() -> Iterator[None]:
    SIZES.clear()
    yield
    SPOILT.clear()


def noted(observations: Iterable[Observation]) -> list[Observation]:
    """The observations, once their number is noted and none is spoilt."""
    seen = list(observations)
    SIZES.append(len(seen))
    for each in seen:
        if each.stamp in SPOILT:
            raise UnusableObservation(f"spoilt at {each.stamp}")
    return seen


class Together(Beams):
    """The first beams of all observations at once."""

    def transform(self, observations: Iterable[Observation]) -> np.ndarray:
        return np.array([each.scan.filled()[: self.count] for each in noted(observations)])

    def extract(self, observation: Observation) -> Any:
        raise AssertionError("asked one by one")


class Mirrored(Together):
    """Training also sees each scan from right to left."""

    def augmentations(self) -> list[Any]:
        return [lambda each: each.altered("mirrored", scan=each.scan.scaled(0.5))]


class LearningTogether(Brightness):
    """The colours of all images at once, less what it learned."""

    def transform(self, observations: Iterable[Observation]) -> np.ndarray:
        return np.array([self._mean(each) - self.center_ for each in noted(observations)])

    def extract(self, observation: Observation) -> Any:
        raise AssertionError("asked one by one")


class LearningMirrored(LearningTogether):
    """Training also sees each image as a negative."""

    def augmentations(self) -> list[Any]:
        return [lambda each: each.altered("negative", image=255 - each.image)]


def registry() -> Any:
    found = toys.registry()
    made = (Together, Mirrored, LearningTogether, LearningMirrored)
    found.add(
        [Component("cue", kind.__name__.lower(), f"{__name__}:{kind.__name__}") for kind in made],
        "batches",
        "1.0",
    )
    return found


def fit(cue: Any, folder: Path | None = None) -> None:
    pipeline = Pipeline({"cue": (cue, SVM(kernel=RBF(gamma=0.01)))})
    if folder is None:
        pipeline.fit(Walk(rounds=1))
        return
    with FeatureCache(folder, registry()) as pipeline.extraction:
        pipeline.fit(Walk(rounds=1))


CUES = pytest.mark.parametrize(
    ("cue", "views"),
    [(Together, 1), (Mirrored, 2), (LearningTogether, 1), (LearningMirrored, 2)],
)


@CUES
@pytest.mark.parametrize("cached", [False, True], ids=["straight", "cached"])
def test_fit_asks_for_batches(cue: type, views: int, cached: bool, tmp_path: Path) -> None:
    fit(cue(), tmp_path if cached else None)
    assert sorted(SIZES) == sorted(WHOLE * views)
    SIZES.clear()
    fit(cue(), tmp_path if cached else None)
    assert sorted(SIZES) == ([] if cached else sorted(WHOLE * views))


@CUES
def test_what_is_kept_is_what_comes_straight(cue: type, views: int, tmp_path: Path) -> None:
    def views_of(extraction: Any) -> list[Any]:
        samples = collect(Walk(rounds=1), {"cue": cue()}, extraction)
        seen = samples.training_set("cue", cue())
        return [seen.features, *seen.augmented]

    plain = views_of(None)
    assert len(plain) == views
    for _ in range(2):
        with FeatureCache(tmp_path, registry()) as cache:
            for view, of_cache in zip(plain, views_of(cache), strict=True):
                np.testing.assert_array_equal(of_cache, view)


@pytest.mark.parametrize("cached", [False, True], ids=["straight", "cached"])
def test_folds_of_a_cue_that_learns_ask_for_batches(cached: bool, tmp_path: Path) -> None:
    extraction = FeatureCache(tmp_path, registry()) if cached else None
    samples = collect(Walk(rounds=1), {"cue": LearningMirrored()}, extraction)
    samples.training_set("cue", LearningMirrored())
    SIZES.clear()
    halves = np.arange(40), np.arange(40, 80)
    for rows in halves:
        seen = samples.relearned(LearningMirrored(), rows)
        means = np.array([each.image.mean(axis=(0, 1)) for each in Walk(rounds=1)])
        np.testing.assert_allclose(seen.features, means - means[rows].mean(axis=0))
    assert sorted(SIZES) == sorted(WHOLE * 2 * len(halves))


def test_held_out_scores_ask_for_batches() -> None:
    cues = {"cue": (LearningTogether(), SVM(kernel=RBF(gamma=0.01)))}
    cues["beams"] = (Beams(), SVM(kernel=RBF(gamma=0.1)))
    Pipeline(cues, SVMDAS(SVM(kernel=RBF(gamma=0.3)))).fit(Walk(rounds=1))
    assert len(SIZES) > len(WHOLE)  # the whole set, and each fold anew
    assert len(SIZES) % len(WHOLE) == 0
    assert sorted(SIZES) == sorted(WHOLE * (len(SIZES) // len(WHOLE)))


@pytest.mark.parametrize("cached", [False, True], ids=["straight", "cached"])
def test_a_spoilt_one_in_a_batch_costs_itself(cached: bool, tmp_path: Path) -> None:
    SPOILT.add(40 * toys.SECOND // 5)  # in the second batch
    log = list(Walk(rounds=1))
    extraction = FeatureCache(tmp_path, registry()) if cached else None
    samples = collect(Walk(rounds=1), {"cue": Together()}, extraction)
    assert samples.stamps.tolist() == [each.stamp for each in log if each.stamp not in SPOILT]
    wanted = [each.scan.filled()[:4] for each in log if each.stamp not in SPOILT]
    np.testing.assert_array_equal(samples.extracted["cue"].features[0], wanted)
    # The batch it lies in is asked for one by one, the others are not.
    assert sorted(SIZES) == sorted([*WHOLE, *[1] * 32])


def test_one_without_its_part_leaves_the_batch_a_batch() -> None:
    log = [
        Observation(each.stamp, label=each.label) if number == 40 else each
        for number, each in enumerate(Walk(rounds=1))
    ]
    samples = collect(log, {"cue": Together()})
    assert len(samples) == 79
    assert sorted(SIZES) == [16, 31, 32]
