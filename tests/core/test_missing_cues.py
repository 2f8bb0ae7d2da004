"""Where a cue is missing the others go on without it, in training and afterwards."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from placecue import (
    Classifier,
    Cue,
    DataError,
    EncodedImage,
    HeldOut,
    Integrator,
    Observation,
    OneAgainstAll,
    OneAgainstOne,
    Pipeline,
    Probabilities,
    Scores,
    Source,
    UnusableObservation,
    UsageError,
)
from placecue.errors import ContractError
from placecue.storage.model import load_model, save_model
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Brightness, Walk, pipeline, registry


class Altered(Source):
    """A walk on which something happens to some observations."""

    def __init__(self, walk: Walk, happens: Callable[[int, Observation], Observation]) -> None:
        self.walk, self.happens = walk, happens
        self.name = f"altered {walk.name}"

    def __iter__(self) -> Iterator[Observation]:
        for number, each in enumerate(self.walk):
            yield self.happens(number, each)

    def digest(self) -> str:
        return f"altered-{self.walk.digest()}"


def blind(each: Observation) -> Observation:
    return Observation(each.stamp, scan=each.scan, pose=each.pose, label=each.label)


def deaf(each: Observation) -> Observation:
    return Observation(each.stamp, image=each.image, pose=each.pose, label=each.label)


def half_the_scans_lost(number: int, each: Observation) -> Observation:
    return deaf(each) if number % 2 else each


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


def test_every_single_cue_model_is_trained_on_all_samples_that_have_its_cue() -> None:
    made = pipeline()
    samples = made.collect(Altered(Walk(), half_the_scans_lost))
    assert len(samples) == 320
    beams, brightness = (made.cues[name].cue for name in ("beams", "brightness"))
    training = samples.training_set("beams", beams)
    assert training.stamps.tolist() == [each.stamp for each in Walk()][::2]
    assert len(samples.training_set("brightness", brightness)) == 320
    assert brightness.seen_ == 320
    made.fit(Altered(Walk(), half_the_scans_lost))
    assert made.held_out_ is not None
    known = made.held_out_.evidence.known()
    assert known[:, 1].all()
    assert known[:, 0].tolist() == [number % 2 == 0 for number in range(320)]


def test_rows_of_a_cue_that_is_missing_at_some_stand_where_they_belong() -> None:
    """A fold of samples with gaps holds for each cue what it has of them."""
    samples = pipeline().collect(Altered(Walk(rounds=1), half_the_scans_lost))
    some = samples.take(np.array([0, 3, 4, 5, 10]))
    assert some.extracted["beams"].rows.tolist() == [0, 2, 4]
    wanted = [each.scan.filled()[:4] for n, each in enumerate(Walk(rounds=1)) if n in (0, 4, 10)]
    np.testing.assert_array_equal(some.extracted["beams"].features[0], wanted)
    assert some.extracted["brightness"].rows.tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("batch", [1, 16])
def test_the_camera_is_off_from_the_middle_on(
    fitted: Pipeline, batch: int, caplog: pytest.LogCaptureFixture
) -> None:
    log = Altered(Walk(seed=1), lambda number, each: blind(each) if number >= 160 else each)
    with caplog.at_level(logging.WARNING):
        beliefs = list(fitted.beliefs(log, batch))
    assert [each.cues_used for each in beliefs[:160]] == [("beams", "brightness")] * 160
    assert [each.cues_used for each in beliefs[160:]] == [("beams",)] * 160
    assert beliefs[160].cues_missing == ("brightness",)
    [record] = caplog.records
    assert record.message == (
        "cue brightness is missing at 160 of 320 observations, which go on without it; the first: "
        "no image at stamp 32000000000"
    )
    alone = Pipeline({"beams": (Beams(), SVM(kernel=RBF(gamma=0.1), multiclass="oao"))})
    of_beams = list(alone.fit(Walk()).beliefs(log, 16))[160:]
    assert [each.label for each in beliefs[160:]] == [each.label for each in of_beams]
    np.testing.assert_allclose(
        [each.confidence for each in beliefs[160:]], [each.confidence for each in of_beams]
    )


def test_an_image_that_does_not_decode_is_a_missing_cue(fitted: Pipeline) -> None:
    seen = Walk(seed=1).at(5)
    cut = Observation(seen.stamp, image=EncodedImage(b"\xff\xd8\xff\xe0cut"), scan=seen.scan)
    [belief] = fitted.believe([cut])
    assert belief.cues_used == ("beams",)
    assert belief.cues_missing == ("brightness",)
    assert belief.label == seen.label


class Spoilt(Beams):
    """NaN wherever the image is there."""

    requires = ("scan",)

    def extract(self, observation: Observation) -> np.ndarray:
        made = super().extract(observation)
        return made * np.nan if observation.has("image") else made


def test_a_nan_feature_is_a_missing_cue() -> None:
    log = Altered(Walk(), lambda number, each: each if number % 2 else blind(each))
    cues: dict[str, tuple[Cue, Classifier]] = {
        "beams": (Beams(), SVM(kernel=RBF(gamma=0.1))),
        "spoilt": (Spoilt(), SVM(kernel=RBF(gamma=0.1))),
    }
    made = Pipeline(cues, SVMDAS(SVM(kernel=RBF(gamma=0.3)))).fit(log)
    used = [belief.cues_used for belief in made.beliefs(log, 16)]
    assert used == [("beams", "spoilt"), ("beams",)] * 160
    with pytest.raises(UnusableObservation, match=r"NaN or infinite .* at stamp 200000000"):
        Pipeline({"spoilt": cues["spoilt"]}).fit(log).believe([Walk().at(1)])
    with pytest.raises(DataError, match=r"no sample has cue spoilt \(the first: cue Spoilt .*NaN"):
        Pipeline(cues, SVMDAS(SVM(kernel=RBF(gamma=0.3)))).fit(Walk())


def test_min_cues_refuses_what_has_fewer(fitted: Pipeline) -> None:
    log = Altered(Walk(seed=1), lambda number, each: blind(each) if number >= 160 else each)
    fitted.min_cues = 2
    try:
        pairs = list(fitted.follow(log, 16))
        assert [belief is not None for _, belief in pairs] == [True] * 160 + [False] * 160
        wanted = "1 of 2 cues, where min_cues asks for 2: no image at stamp 32000000000"
        with pytest.raises(UnusableObservation, match=wanted):
            fitted.believe([pairs[160][0]])
        assert len(fitted.collect(Altered(Walk(), half_the_scans_lost))) == 160
        for wrong, told in ((3, "there are 2 cues"), (0, "at least 1"), ("2", "whole number")):
            fitted.min_cues = wrong  # type: ignore[assignment]
            with pytest.raises(UsageError, match=f"min_cues is .*{told}"):
                fitted.believe([Walk().at(0)])
    finally:
        fitted.min_cues = 1


def test_a_model_keeps_its_schemes(fitted: Pipeline, tmp_path: Path) -> None:
    save_model(fitted, tmp_path / "model", registry())
    loaded = load_model(tmp_path / "model", registry())
    assert loaded.layout_ == fitted.layout_ == OneAgainstOne(PLACES)
    log = [deaf(each) if n % 3 else blind(each) for n, each in enumerate(Walk(seed=1))]
    for a, b in zip(fitted.beliefs(log, 16), loaded.beliefs(log, 7), strict=True):
        assert a.cues_used == b.cues_used
        np.testing.assert_array_equal(a.scores.values, b.scores.values)


def test_a_class_that_a_cue_never_saw_is_said() -> None:
    log = Altered(Walk(), lambda _, each: blind(each) if each.label == "kitchen" else each)
    with pytest.raises(
        DataError, match="cue brightness: none of the 240 samples that have it is of 'kitchen'"
    ):
        pipeline().fit(log)


def test_cues_that_are_never_there_together_cannot_be_joined() -> None:
    log = Altered(Walk(), lambda number, each: blind(each) if number % 2 else deaf(each))
    with pytest.raises(DataError, match=r"no sample has scores of all cues \(beams, brightness\)"):
        pipeline().fit(log)


class Fickle(Integrator):
    """Gives scores of another layout for two cues than for three."""

    def fit(self, evidence, labels, stamps=None):  # type: ignore[no-untyped-def]
        self.classes_ = tuple(np.unique(labels))
        return self

    def integrate(self, evidence):  # type: ignore[no-untyped-def]
        kind = OneAgainstAll if len(evidence.cues) > 2 else Probabilities
        return Scores(np.zeros((len(evidence), 4)), kind(PLACES))


def test_an_integrator_that_changes_its_layout_is_told() -> None:
    cues = {
        "beams": (Beams(), SVM(RBF(0.1))),
        "few": (Beams(2), SVM(RBF(0.1))),
        "bright": (Brightness(), SVM(RBF(0.001))),
    }
    made = Pipeline(cues, Fickle()).fit(Walk())
    log = Altered(Walk(rounds=1), lambda number, each: blind(each) if number % 2 else each)
    with pytest.raises(ContractError, match=r"^integrator Fickle .*: gives scores"):
        list(made.beliefs(log, 16))


def test_scores_that_were_trained_on_are_refused() -> None:
    with pytest.raises(UsageError, match=r"trained on 320 of the 320 samples .*another log"):
        pipeline().fit(Walk(), integration=Walk())
    log = list(Walk())
    with pytest.raises(UsageError, match="force_training_scores=true"):
        pipeline().fit(log, integration=log)
    pipeline().fit(Walk(), integration=Walk(), force_training_scores=True)
    pipeline().fit(Walk(), integration=Walk(seed=3))


def test_so_they_are_step_by_step() -> None:
    made = pipeline()
    samples = made.collect(Walk())
    made.fit_cues(samples)
    held_out = HeldOut(made.evidence_of(samples), samples.labels, samples.stamps)
    assert held_out.evidence.trained_on().all()
    with pytest.raises(UsageError, match="trained on 320 of the 320"):
        made.fit_integrator(held_out)
    made.fit_integrator(held_out, force_training_scores=True)
    other = Pipeline(made.cues, SVMDAS(SVM(RBF(0.3))))  # the same models
    again = HeldOut(other.evidence_of(samples), samples.labels, samples.stamps)
    with pytest.raises(UsageError, match="trained on 320 of the 320"):
        other.fit_integrator(again)
    made.fit_integrator(made.held_out(samples))
    others = made.collect(Walk(seed=3))
    assert not made.evidence_of(others).trained_on().any()
