"""The path of an observation, and training on scores that nobody has seen."""

import gc
import logging

import numpy as np
import pytest

from placecue import (
    DataError,
    InterleavedChunks,
    LaserScan,
    Observation,
    ObservedEvidence,
    Pipeline,
    UnusableObservation,
    UsageError,
)
from placecue.cue_model import CueModel
from placecue.learning.collecting import collect
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import PLACES, SECOND, Beams, Brightness, Walk, pipeline


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


def test_it_recognises_the_places_of_another_walk(fitted: Pipeline) -> None:
    walk = list(Walk(seed=1))
    beliefs = list(fitted.beliefs(walk))
    right = [b.label == o.label for o, b in zip(walk, beliefs, strict=True)]
    assert np.mean(right) > 0.9
    assert fitted.classes == PLACES
    assert beliefs[0].cues_used == ("beams", "brightness")
    assert beliefs[0].stamp == walk[0].stamp


def test_beliefs_do_not_depend_on_the_batch(fitted: Pipeline) -> None:
    walk = list(Walk(rounds=1, seed=1))
    for one, many in zip(fitted.beliefs(walk), fitted.beliefs(walk, batch=7), strict=True):
        assert one.label == many.label
        assert one.scores.values == pytest.approx(many.scores.values, abs=1e-9)


def test_evidence_extracts_only_what_is_asked_for(fitted: Pipeline) -> None:
    walk = [Walk().at(number) for number in range(5)]
    evidence = ObservedEvidence(walk, fitted.cues)
    assert evidence.layout("brightness").classes == PLACES
    some = evidence.take(np.array([1, 3]))
    assert len(some.scores("beams")) == 2
    assert [evidence.used(row) for row in range(4)] == [(), ("beams",), (), ("beams",)]
    assert some.used(0) == ("beams",)
    assert all(observation._decoded is None for observation in walk)
    evidence.take([2]).scores("brightness")
    assert evidence.used(2) == ("brightness",)
    with pytest.raises(UsageError, match="did you mean 'beams'"):
        evidence.scores("beam")


def test_out_of_fold_scores_come_from_models_that_have_not_seen_the_sample() -> None:
    seen: list[set[int]] = []

    class Watched(Brightness):
        def fit(self, observations, labels=None):  # type: ignore[no-untyped-def]
            kept = list(observations)
            seen.append({observation.stamp for observation in kept})
            return super().fit(kept, labels)

    model = CueModel(Watched(), SVM(kernel=RBF(gamma=0.001)))
    samples = collect(Walk(), {"brightness": model.cue})
    labels, stamps = samples.labels, samples.stamps
    training = samples.training_set("brightness", model.cue)
    model.fit(training)
    folds = InterleavedChunks()
    seen.clear()
    scores = model.held_out(training, folds)
    assert len(scores) == len(samples)
    for (_, held_out), stamps_seen in zip(folds.split(labels, stamps), seen, strict=True):
        assert not stamps_seen & set(stamps[held_out].tolist())


def test_the_integrator_may_be_fitted_on_another_sequence() -> None:
    two = pipeline().fit(Walk(), integration=Walk(seed=2))
    out_of_fold = pipeline().fit(Walk())
    beliefs = [list(each.beliefs(Walk(seed=1))) for each in (two, out_of_fold)]
    assert (
        np.mean([b.label == o.label for o, b in zip(Walk(seed=1), beliefs[0], strict=True)]) > 0.9
    )
    different = [a.scores.values != b.scores.values for a, b in zip(*beliefs, strict=True)]
    assert np.any(different)


def test_one_cue_needs_no_integrator() -> None:
    single = Pipeline({"beams": (Beams(), SVM(kernel=RBF(gamma=0.1)))}).fit(Walk())
    assert {belief.cues_used for belief in single.beliefs(Walk(rounds=1))} == {("beams",)}


def test_several_cues_need_an_integrator() -> None:
    cues = pipeline().cues
    with pytest.raises(UsageError, match=r"2 cues .* and no integrator"):
        Pipeline(cues)
    with pytest.raises(UsageError, match="a cue or more"):
        Pipeline({})


def test_unusable_observations_are_passed_over_and_reported_once(
    fitted: Pipeline, caplog: pytest.LogCaptureFixture
) -> None:
    walk = list(Walk(rounds=1, seed=1))
    nothing = LaserScan(np.zeros(6), np.full(6, np.nan), 0.0, 20.0)
    walk[3] = Observation(walk[3].stamp, scan=nothing, label="lab")
    walk[9] = Observation(walk[9].stamp, label="lab")
    with caplog.at_level(logging.WARNING):
        pairs = list(fitted.follow(walk, batch=8))
    assert [number for number, (_, belief) in enumerate(pairs) if belief is None] == [3, 9]
    [record] = caplog.records
    assert "2 of 80 observations passed over" in record.message
    assert "none of the 6 beams" in record.message
    caplog.clear()
    pipeline().fit([*walk, *Walk()])
    assert "2 of 400 observations passed over" in caplog.text


def test_nothing_usable_is_an_error(fitted: Pipeline) -> None:
    walk = [Observation(n * SECOND, label=PLACES[n % 4]) for n in range(20)]
    with pytest.raises(DataError, match="no usable observation: 20 of 20"):
        list(fitted.beliefs(walk))
    with pytest.raises(DataError, match="no usable observation"):
        pipeline().fit(walk)
    with pytest.raises(DataError, match="holds no observation"):
        list(fitted.beliefs([]))
    with pytest.raises(UnusableObservation, match="no scan at stamp 0"):
        fitted.believe([Observation(0)])


def test_training_needs_labels_of_two_classes_with_two_samples_each() -> None:
    with pytest.raises(DataError, match="none of the 320 observations has a label"):
        pipeline().fit([each.relabelled(None) for each in Walk()])
    with pytest.raises(DataError, match="all 320 labelled observations are 'hall'"):
        pipeline().fit([each.relabelled("hall") for each in Walk()])
    odd = [*Walk(), Walk().at(0).relabelled("attic")]
    with pytest.raises(DataError, match="class 'attic' has one sample only"):
        pipeline().fit(odd)


def test_a_cue_that_learns_cannot_read_a_generator() -> None:
    with pytest.raises(UsageError, match="brightness learns"):
        pipeline().fit(iter(Walk()))


def test_no_more_than_a_batch_is_held(fitted: Pipeline) -> None:
    def held() -> int:
        return sum(isinstance(each, Observation) for each in gc.get_objects())

    before = held()
    most = max(held() for _ in fitted.beliefs(Walk(rounds=1, stay=4), batch=4))
    assert most - before <= 4 + 1


class Without(Walk):
    """A walk without one of the places."""

    def at(self, number: int) -> Observation:
        each = super().at(number)
        return each.relabelled(None) if each.label == "lab" else each


class Elsewhere(Walk):
    """A walk in which one place is another."""

    def at(self, number: int) -> Observation:
        each = super().at(number)
        return each.relabelled("stairs") if number % 9 == 0 else each


def test_an_integration_log_must_have_every_class() -> None:
    with pytest.raises(DataError, match="the integration log has no sample of lab"):
        pipeline().fit(Walk(), integration=Without(seed=2))


def test_a_class_of_the_integration_log_alone_is_left_out(
    caplog: pytest.LogCaptureFixture,
) -> None:
    fitted = pipeline().fit(Walk(), integration=Elsewhere(seed=2))
    assert "36 samples of the integration log are left out: stairs is no class" in caplog.text
    assert {belief.label for belief in fitted.beliefs(Walk(seed=1))} <= set(fitted.classes)


def test_an_integration_log_without_a_use_is_said(caplog: pytest.LogCaptureFixture) -> None:
    one = Pipeline({"beams": (Beams(), SVM(kernel=RBF(gamma=0.1)))})
    one.fit(Walk(), integration=Walk(seed=2))
    assert "the integration log is not used" in caplog.text
    assert one.held_out_ is None
