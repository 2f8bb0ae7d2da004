"""Confidence-based integration: a cue that is not needed is not extracted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from placecue import (
    Component,
    DataError,
    Evidence,
    HeldOut,
    InterleavedChunks,
    Observation,
    OneAgainstAll,
    Pipeline,
    Scores,
    Source,
    StoredEvidence,
    UsageError,
)
from placecue.integrator import Integrator
from placecue.storage.model import load_model, save_model
from placecue_classifiers.svm import SVM
from placecue_integrators.confidence import Confidence
from placecue_integrators.stages import ALWAYS, NEVER, Stages, balanced
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Walk, registry


class Sum(Integrator):
    """The sum of the scores, as they are."""

    def fit(self, evidence: Evidence, labels: Any, stamps: Any = None) -> Sum:
        self.fitted_ = list(evidence.cues)
        return self

    def integrate(self, evidence: Evidence) -> Scores:
        every = [evidence.scores(cue) for cue in evidence.cues]
        return Scores(sum(each.values for each in every), every[0].layout)


# ---------------------------------------------------------------------- thresholds


def by_ten_lines(right: np.ndarray, confidence: np.ndarray, labels: np.ndarray) -> list[float]:
    """The smallest thresholds, from the last stage but one back, that keep the highest rate."""

    def rate(correct: np.ndarray) -> float:
        return float(np.mean([correct[labels == name].mean() for name in np.unique(labels)]))

    later, found = right[-1], []
    for stage in range(len(right) - 2, -1, -1):
        tried = [-np.inf, *np.unique(confidence[stage]), np.inf]
        every = [np.where(confidence[stage] >= t, right[stage], later) for t in tried]
        best = next(n for n, d in enumerate(every) if rate(d) >= max(map(rate, every)) - 1e-12)
        later = every[best]
        found.insert(0, tried[best])
    return found


def test_thresholds_of_a_worked_example() -> None:
    # Two classes, three of each; after the first cue the sure ones are right.
    labels = np.array(["a", "a", "a", "b", "b", "b"])
    first, both = [1, 1, 0, 1, 0, 1], [1, 1, 1, 1, 1, 0]
    right = np.array([first, both], dtype=bool)
    confidence = np.array([[0.9, 0.5, 0.4, 0.8, 0.3, 0.1], [1.0] * 6])
    stages = Stages(right, confidence, balanced(labels), [2.0, 10.0])
    assert stages.rate([NEVER]) == pytest.approx(5 / 6)
    assert stages.rate([ALWAYS]) == pytest.approx(4 / 6)
    # Down to 0.5 all that is decided is right; to 0.4 one of class a would be lost, to 0.1 another
    # of class b, and only one of class b regained.
    assert stages.thresholds(5 / 6) == [0.5]
    assert stages.decided([0.5]).tolist() == [0, 0, 1, 0, 1, 1]
    assert stages.shares([0.5]).tolist() == [1.0, 0.5]
    assert stages.cost([0.5]) == pytest.approx(2 + 10 / 2)
    # For two thirds nothing but the first cue is needed.
    assert stages.thresholds(4 / 6) == [ALWAYS]


@given(st.integers(0, 10_000))
def test_thresholds_are_the_smallest(seed: int) -> None:
    generator = np.random.default_rng(seed)
    n = int(generator.integers(4, 40))
    labels = np.array(PLACES)[np.concatenate([np.arange(4), generator.integers(4, size=n - 4)])]
    confidence = generator.integers(0, 12, (3, n)) / 8  # with equal ones
    right = generator.random((3, n)) < np.array([[0.5], [0.7], [0.9]])
    stages = Stages(right, confidence, balanced(labels), [1, 1, 1])
    found = stages.thresholds()
    expected = by_ten_lines(right, confidence, labels)
    # What is decided counts: no confidence lies between a threshold and the next above it.
    for a, b, of_stage in zip(found, expected, confidence, strict=False):
        assert (of_stage >= a).tolist() == (of_stage >= b).tolist()
    assert stages.rate(found) >= stages.rate([NEVER, NEVER]) - 1e-9


# ---------------------------------------------------------------------- fitting


def scores_of(truth: np.ndarray, noise: float, generator: np.random.Generator) -> Scores:
    values = (truth[:, None] == np.arange(4)) + noise * generator.normal(size=(len(truth), 4))
    return Scores(values, OneAgainstAll(PLACES))


def some_evidence(n: int = 400, seed: int = 0, **noise: float) -> HeldOut:
    generator = np.random.default_rng(seed)
    truth = np.repeat(np.arange(4), n // 4)
    scores = {name: scores_of(truth, each, generator) for name, each in noise.items()}
    stamps = np.arange(n) * 1_000_000_000
    return HeldOut(StoredEvidence(scores), np.array(PLACES)[truth], stamps)


def costing(held_out: HeldOut, **costs: float) -> HeldOut:
    return HeldOut(held_out.evidence, held_out.labels, held_out.stamps, costs=costs)


def test_cues_are_asked_from_the_cheapest_on() -> None:
    held_out = some_evidence(sift=0.3, crfh=0.4, laser=0.5)
    made = Confidence(Sum()).train(costing(held_out, sift=80.0, crfh=9.0, laser=1.5))
    assert made.cues_ == ["laser", "crfh", "sift"]
    assert Confidence(Sum()).train(held_out).cues_ == ["sift", "crfh", "laser"]
    listed = Confidence(Sum(), order=["crfh", "sift", "laser"])
    assert listed.train(held_out).cues_ == ["crfh", "sift", "laser"]


def test_the_full_rate_is_kept_for_less() -> None:
    made = Confidence(Sum(), order=["laser", "crfh", "sift"])
    made.train(costing(some_evidence(laser=0.4, crfh=0.4, sift=0.4), laser=1, crfh=10, sift=80))
    unseen = some_evidence(seed=1, laser=0.4, crfh=0.4, sift=0.4)

    def rate(scores: Scores) -> float:
        right = scores.decide().labels == unseen.labels
        return float(np.mean([right[unseen.labels == name].mean() for name in PLACES]))

    every = Sum().integrate(unseen.evidence)
    assert rate(made.integrate(unseen.evidence)) > rate(every) - 0.02
    curve = made.trade_off_
    [at] = np.flatnonzero(curve["chosen"])
    assert curve["used laser"][at] == 1
    assert 0 < curve["used sift"][at] < curve["used crfh"][at] < 0.9
    used = [curve[f"used {cue}"][at] for cue in made.cues_]
    assert curve["cost"][at] == pytest.approx(float(np.dot(used, [1, 10, 80])))
    assert curve["cost"] == sorted(curve["cost"])
    # All cues for all samples is the dearest point.
    assert curve["cost"][-1] == pytest.approx(91)


def test_a_wanted_accuracy_and_a_budget() -> None:
    held_out = costing(some_evidence(laser=0.6, crfh=0.5, sift=0.4), laser=1, crfh=10, sift=80)

    def point(**wanted: float) -> tuple[float, float]:
        made = Confidence(Sum(), **wanted).train(held_out)  # type: ignore[arg-type]
        [at] = np.flatnonzero(made.trade_off_["chosen"])
        return made.trade_off_["cost"][at], made.trade_off_["balanced_accuracy"][at]

    full_cost, full_rate = point()
    cost, rate = point(accuracy=0.85)
    assert rate >= 0.85 - 1e-9
    assert cost < full_cost
    for budget in (60.0, 30.0, 12.0, 2.0):
        cost, rate = point(budget=budget)
        assert cost <= budget
        assert rate <= full_rate + 1e-9
    assert point(budget=30.0)[1] > point(budget=2.0)[1]


def test_a_rate_that_cannot_be_reached_is_told(caplog: pytest.LogCaptureFixture) -> None:
    held_out = some_evidence(laser=0.9, crfh=0.9)
    Confidence(Sum(), accuracy=0.999).train(held_out)
    assert "all cues together reach 0." in caplog.text


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"accuracy": 1.2}, "at most 1"),
        ({"accuracy": 0}, "above 0"),
        ({"budget": -3}, "above 0"),
        ({"accuracy": 0.9, "budget": 20}, "not both"),
        ({"order": ["laser"]}, "must name each of the cues once"),
        ({"order": ["laser", "crfh", "crfh"]}, "must name each of the cues once"),
        ({"order": ["laser", "crhf"]}, "names 'crhf'; did you mean 'crfh'"),
        ({"budget": 0.5}, "the first cue alone takes 1"),
    ],
)
def test_what_cannot_be(wrong: dict[str, Any], told: str) -> None:
    held_out = costing(some_evidence(laser=0.4, crfh=0.4), laser=1, crfh=10)
    with pytest.raises(UsageError, match=told):
        Confidence(Sum(), **wrong).train(held_out)


def test_a_budget_needs_costs_and_confidence_an_integrator() -> None:
    held_out = some_evidence(laser=0.4, crfh=0.4)
    with pytest.raises(UsageError, match="needs measured costs"):
        Confidence(Sum(), budget=20).train(held_out)
    with pytest.raises(UsageError, match="needs an integrator"):
        Confidence().train(held_out)


def test_one_cue_is_always_asked() -> None:
    held_out = some_evidence(laser=0.4)
    made = Confidence(Sum()).train(held_out)
    found = made.integrate(held_out.evidence)
    np.testing.assert_array_equal(found.values, held_out.evidence.scores("laser").values)


def test_no_sample_with_all_cues_is_an_error() -> None:
    held_out = some_evidence(40, laser=0.4, crfh=0.4)
    laser, crfh = (held_out.evidence.scores(cue).values.copy() for cue in ("laser", "crfh"))
    laser[::2], crfh[1::2] = np.nan, np.nan
    layout = OneAgainstAll(PLACES)
    gaps = StoredEvidence({"laser": Scores(laser, layout), "crfh": Scores(crfh, layout)})
    with pytest.raises(DataError, match="has scores of all cues"):
        Confidence(Sum()).fit(gaps, held_out.labels)


# ---------------------------------------------------------------------- gaps


def gappy(seed: int = 0) -> tuple[HeldOut, np.ndarray]:
    held_out = some_evidence(seed=seed, laser=0.5, crfh=0.4, sift=0.3)
    missing = np.random.default_rng(5).random((400, 3)) < 0.3
    scores = {}
    for number, cue in enumerate(held_out.evidence.cues):
        values = held_out.evidence.scores(cue).values.copy()
        values[missing[:, number]] = np.nan
        scores[cue] = Scores(values, OneAgainstAll(PLACES))
    return HeldOut(StoredEvidence(scores), held_out.labels, held_out.stamps), ~missing


def test_cues_that_are_missing_are_passed_over() -> None:
    """Every sample by itself, by the rule as it stands in the docstring."""
    held_out, there = gappy()
    made = Confidence(Sum(), order=["laser", "crfh", "sift"]).train(held_out)
    unseen, there = gappy(seed=1)
    found = made.integrate(unseen.evidence)
    for row in range(400):
        cues = [cue for cue, has in zip(made.cues_, there[row], strict=True) if has]
        if not cues:
            assert np.isnan(found.values[row]).all()
            continue
        thresholds = made.thresholds_[made.sets_.index(cues)]
        for asked in range(1, len(cues) + 1):
            so_far = Sum().integrate(unseen.evidence.take([row]).only(cues[:asked]))
            if asked == len(cues) or so_far.decide().confidence[0] >= thresholds[asked - 1]:
                break
        np.testing.assert_allclose(found.values[row], so_far.values[0])


# ---------------------------------------------------------------------- in a pipeline


class Counted(Beams):
    """Beams, of which each extraction is noted; fails at one stamp in four if so asked."""

    seen: ClassVar[dict[str, list[int]]] = {}

    def __init__(self, name: str = "", count: int = 4, fails: bool = False) -> None:
        super().__init__(count)
        self.name, self.fails = name, fails

    def extract(self, observation: Observation) -> np.ndarray:
        self.seen.setdefault(self.name, []).append(observation.stamp)
        made = super().extract(observation)
        return made * np.nan if self.fails and observation.stamp % 800_000_000 == 0 else made


def staged(log: Source, fails: bool = False) -> Pipeline:
    cues = {
        "first": (Counted("first", 2, fails), SVM(RBF(0.3), multiclass="oao")),
        "second": (Counted("second", 6), SVM(RBF(0.1), multiclass="oao")),
    }
    das = SVMDAS(SVM(RBF(0.3), multiclass="oao"))
    order = ["first", "second"]
    return Pipeline(cues, Confidence(das, order=order), folds=InterleavedChunks()).fit(log)


@pytest.mark.parametrize("batch", [1, 16])
def test_a_cue_that_is_not_needed_is_not_extracted(batch: int) -> None:
    made = staged(Walk(noise=0.8))
    Counted.seen.clear()
    log = Walk(seed=1, noise=0.8)
    beliefs = list(made.beliefs(log, batch))
    stamps = [each.stamp for each in log]
    assert Counted.seen["first"] == stamps
    needed = [b.stamp for b in beliefs if "second" in b.cues_used]
    assert sorted(Counted.seen["second"]) == needed
    assert 0 < len(needed) < len(stamps) * 0.9
    assert all(b.cues_missing == () for b in beliefs)


def test_a_first_cue_that_turns_out_spoilt() -> None:
    made = staged(Walk(noise=0.8), fails=True)
    beliefs = list(made.beliefs(Walk(seed=1, noise=0.8), 16))
    assert len(beliefs) == 320
    spoilt = [b for b in beliefs if b.stamp % 800_000_000 == 0]
    assert len(spoilt) == 80
    assert {b.cues_used for b in spoilt} == {("second",)}
    assert {b.cues_missing for b in spoilt} == {("first",)}


def test_costs_are_measured_and_a_model_is_the_same(tmp_path: Path) -> None:
    made = staged(Walk(noise=0.8))
    assert set(made.integrator.costs_) == {"first", "second"}
    assert all(0 < cost < 1000 for cost in made.integrator.costs_.values())
    known = registry()
    known.add([Component("cue", "counted", f"{__name__}:Counted")], "tests", "1")
    save_model(made, tmp_path / "model", known)
    loaded = load_model(tmp_path / "model", known)
    log = Walk(seed=1, noise=0.8)
    for a, b in zip(made.beliefs(log, 16), loaded.beliefs(log, 16), strict=True):
        assert a.cues_used == b.cues_used
        np.testing.assert_array_equal(a.scores.values, b.scores.values)


def test_five_cues_have_schemes_for_every_beginning() -> None:
    held_out = some_evidence(80, a=0.4, b=0.4, c=0.4, d=0.4, e=0.4)
    made = Confidence(Sum()).train(held_out)
    assert made.cues_ == list("abcde")
    assert list("abc") in made.sets_
    assert made.integrate(held_out.evidence).available().all()
    some = made.integrate(held_out.evidence.only(list("abcde")).take([0, 1]))
    assert some.available().all()


def test_where_no_cue_will_be_missing_only_what_is_asked_is_learned() -> None:
    held_out = some_evidence(laser=0.4, crfh=0.4, sift=0.4)
    order = ["laser", "crfh", "sift"]
    every = Confidence(Sum(), order=order).train(held_out)
    made = Confidence(Sum(), order=order).train(replace(held_out, whole=True))
    assert made.sets_ == [order, order[:2], order[:1]]
    unseen = some_evidence(seed=1, laser=0.4, crfh=0.4, sift=0.4).evidence
    np.testing.assert_array_equal(made.integrate(unseen).values, every.integrate(unseen).values)
    # One that is missing after all does not stop it.
    gaps, there = gappy()
    found = made.integrate(gaps.evidence).available()
    np.testing.assert_array_equal(found, there.any(axis=1))


def test_confidence_does_not_stand_inside_itself() -> None:
    with pytest.raises(UsageError, match="cannot stand inside itself"):
        Confidence(Confidence(Sum())).train(some_evidence(laser=0.4))


@pytest.mark.parametrize("part", ["labels", "stamps"])
def test_lengths_must_fit(part: str) -> None:
    held_out = some_evidence(laser=0.4, crfh=0.4)
    about = {"labels": held_out.labels, "stamps": held_out.stamps}
    assert about[part] is not None
    about[part] = about[part][:-5]
    with pytest.raises(DataError, match=f"395 {part} for the evidence of 400 samples"):
        Confidence(Sum()).fit(held_out.evidence, **about)


def test_the_curve_holds_what_is_worth_its_cost() -> None:
    held_out = costing(some_evidence(laser=0.5, crfh=0.5, sift=0.5), laser=1, crfh=10, sift=80)
    curve = Confidence(Sum(), order=["laser", "crfh", "sift"]).train(held_out).trade_off_
    assert sum(curve["chosen"]) == 1
    assert np.all(np.diff(curve["cost"]) > 0)
    assert np.all(np.diff(curve["balanced_accuracy"][:-1]) > 0)
