"""Features are extracted once, however a run ends and whoever runs beside it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import toys
from caching import CALLS, REGISTRY, SAMPLES, Counting, Learning, Picky, extracted, same, shards
from placecue import Cue, Observation, UnusableObservation
from placecue.learning.collecting import collect
from placecue.storage.feature_cache import FeatureCache
from toys import Walk


@pytest.fixture(autouse=True)
def _nothing_counted() -> None:
    CALLS.clear()


@pytest.mark.parametrize("kind", ["dense", "sparse", "descriptors"])
def test_a_second_run_extracts_nothing(kind: str, tmp_path: Path) -> None:
    fresh = extracted(None, Counting(kind))
    CALLS.clear()
    first = extracted(tmp_path, Counting(kind))
    assert CALLS["extract"] == SAMPLES
    again = extracted(tmp_path, Counting(kind))
    assert CALLS["extract"] == SAMPLES
    assert same(fresh, first)
    assert same(fresh, again)


def test_neither_does_classifying_a_log_again(tmp_path: Path) -> None:
    pipeline = toys.pipeline().fit(Walk())
    plain = [belief.scores.values for belief in pipeline.beliefs(Walk(seed=1), batch=16)]
    for batch in (16, 7):
        with FeatureCache(tmp_path, REGISTRY) as pipeline.extraction:
            log = Walk(seed=1)
            beliefs = list(pipeline.beliefs(log, batch))
        values = [belief.scores.values for belief in beliefs]
        np.testing.assert_allclose(values, plain, rtol=0, atol=1e-12)
        # What would not come from the cache fails from now on.
        pipeline.cues["beams"].cue.extract = pipeline.cues["brightness"].cue.extract = None


def test_what_a_cue_learns_is_kept_for_every_fold(tmp_path: Path) -> None:
    folds = [np.arange(0, 200), np.arange(100, SAMPLES)]

    def learned() -> list[object]:
        with FeatureCache(tmp_path, REGISTRY) as cache:
            samples = collect(Walk(), {"cue": Learning()}, cache)
            return [samples.relearned(Learning(), rows).features for rows in folds]

    first = learned()
    assert CALLS == {"fit": 2, "extract": 2 * SAMPLES}
    again = learned()
    assert CALLS == {"fit": 2, "extract": 2 * SAMPLES}
    assert all(map(same, first, again))
    assert not same(*first)
    plain = collect(Walk(), {"cue": Learning()})
    assert same(first[0], plain.relearned(Learning(), folds[0]).features)


def test_another_version_parameter_or_log_is_extracted_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    extracted(tmp_path, Counting())
    doubled = extracted(tmp_path, Counting(factor=2.0))
    assert CALLS["extract"] == 2 * SAMPLES
    assert same(doubled, extracted(None, Counting(factor=2.0)))
    CALLS.clear()
    extracted(tmp_path, Counting(), Walk(seed=1))
    assert CALLS["extract"] == SAMPLES
    monkeypatch.setattr(Counting, "version", "2")
    extracted(tmp_path, Counting())
    assert CALLS["extract"] == 2 * SAMPLES


class Seeing(Cue):
    """The first pixel."""

    requires = ("image",)

    def extract(self, observation: Observation) -> np.ndarray:
        CALLS["extract"] += 1
        return observation.image[0, 0].astype(np.float64)


def test_another_opencv_is_asked_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for version, calls in (("4.0", 1), ("4.0", 1), ("5.0", 2)):
        monkeypatch.setattr(cv2, "__version__", version)
        extracted(tmp_path, Seeing())
        assert CALLS["extract"] == calls * SAMPLES
    # A laser scan does not come by OpenCV.
    CALLS.clear()
    for version in ("4.0", "5.0"):
        monkeypatch.setattr(cv2, "__version__", version)
        extracted(tmp_path, Counting())
    assert CALLS["extract"] == SAMPLES


class Doubled(Cue):
    """Twice another cue's features."""

    requires = ("scan",)

    def __init__(self, inner: Cue | list[Cue] | dict[str, Cue]) -> None:
        self.inner = inner

    def extract(self, observation: Observation) -> np.ndarray:
        [inner] = {list: list, dict: dict.values}.get(type(self.inner), lambda cue: [cue])(
            self.inner
        )
        return 2 * np.asarray(inner.extract(observation))


@pytest.mark.parametrize("place", [lambda cue: cue, lambda cue: [cue], lambda cue: {"a": cue}])
def test_so_is_another_version_of_a_cue_inside(
    place: Callable[[Cue], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for version, calls in (("1", 1), ("1", 1), ("2", 2)):
        monkeypatch.setattr(Counting, "version", version)
        extracted(tmp_path, Doubled(place(Counting())))
        assert CALLS["extract"] == calls * SAMPLES


def test_a_digest_that_says_too_little_does_no_harm(tmp_path: Path) -> None:
    class Later(Walk):
        def at(self, number: int) -> Observation:
            each = super().at(number)
            return Observation(each.stamp + 1, scan=each.scan, label=each.label)

    extracted(tmp_path, Counting())
    extracted(tmp_path, Counting(), Later())
    assert CALLS["extract"] == 2 * SAMPLES


def test_what_was_unusable_stays_so(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    first = extracted(tmp_path, Picky())
    said = caplog.text
    assert "107 of 320 observations passed over; the first: nothing to see at 0" in said
    caplog.clear()
    assert same(first, extracted(tmp_path, Picky()))
    assert caplog.text == said
    assert CALLS["extract"] == SAMPLES


def test_an_interrupted_run_goes_on_where_it_was(tmp_path: Path) -> None:
    class Interrupted(Walk):
        def at(self, number: int) -> Observation:
            if number == 150:
                raise KeyboardInterrupt
            return super().at(number)

    with pytest.raises(KeyboardInterrupt):
        extracted(tmp_path, Counting(), Interrupted())
    assert CALLS["extract"] == 128  # in batches of 32
    extracted(tmp_path, Counting())
    assert CALLS["extract"] == SAMPLES


def test_a_folder_that_cannot_be_written_costs_a_warning(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file")
    with caplog.at_level(logging.WARNING):
        found = extracted(taken, Counting())
    assert same(found, extracted(None, Counting()))
    [record] = caplog.records
    assert f"the feature cache {taken} cannot be written" in record.message
    assert "cache.folder=null" in record.message


def test_observations_of_no_log_are_extracted_as_ever(tmp_path: Path) -> None:
    with FeatureCache(tmp_path, REGISTRY) as cache:
        for _ in range(2):
            collect(list(Walk()), {"cue": Counting()}, cache)
    assert CALLS["extract"] == 2 * SAMPLES
    assert not shards(tmp_path)


class Named(Walk):
    """A log whose digest is text, as a plugin's might be."""

    def digest(self) -> str:
        return f"../learned/simulated walk of a robot number {self.seed}"


def test_digests_that_begin_alike_are_told_apart(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    first, second = (extracted(cache, Counting(), Named(seed=seed)) for seed in (0, 1))
    assert CALLS["extract"] == 2 * SAMPLES
    assert not same(first, second)
    assert [path.name for path in tmp_path.iterdir()] == ["cache"]


def test_what_failed_in_reading_may_not_fail_again(tmp_path: Path) -> None:
    class Unreadable(Walk):
        broken = True

        def at(self, number: int) -> Observation:
            each = super().at(number)
            if not self.broken or number % 4:
                return each

            def fails() -> np.ndarray:
                raise UnusableObservation("Input/output error")

            return Observation(each.stamp, image=fails, scan=each.scan, label=each.label)

    def usable() -> int:
        cue = Learning()
        cue.learns, cue.center_ = False, np.zeros(3)  # type: ignore[misc]
        return len(extracted(tmp_path, cue, Unreadable()))

    assert usable() == SAMPLES * 3 // 4
    Unreadable.broken = False
    assert usable() == SAMPLES


def test_each_log_is_written_when_the_next_begins(tmp_path: Path) -> None:
    with FeatureCache(tmp_path, REGISTRY) as cache:
        for seed in range(3):
            log = Walk(rounds=1, stay=5, seed=seed)
            collect(log, {"cue": Counting()}, cache)
            assert len(shards(tmp_path)) == seed
    assert len(shards(tmp_path)) == 3


def test_a_cue_changed_in_place_is_another(tmp_path: Path) -> None:
    class Listed(Counting):
        def __init__(self, factors: list[float]) -> None:
            self.factors = factors

        def extract(self, observation: Observation) -> object:
            self.kind, self.factor = "dense", sum(self.factors)
            return super().extract(observation)

    with FeatureCache(tmp_path, REGISTRY) as cache:
        log, cue = Walk(), Listed([1.0])
        first = collect(log, {"cue": cue}, cache).extracted["cue"].features[0]
        cue.factors.append(1.0)
        second = collect(log, {"cue": cue}, cache).extracted["cue"].features[0]
    np.testing.assert_allclose(second, 2 * first)


def test_a_cue_that_no_key_can_be_made_of_is_not_kept(tmp_path: Path) -> None:
    cue = Counting(factor=1.0)
    cue.kind = lambda: None  # type: ignore[assignment]
    for _ in range(2):
        extracted(tmp_path, cue)
    assert CALLS["extract"] == 2 * SAMPLES
    assert not shards(tmp_path)
