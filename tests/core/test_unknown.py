"""A pipeline says "unknown" below a threshold chosen on samples that no part of it has seen."""

from __future__ import annotations

import numpy as np
import pytest
from placecue.learning.held_out import HeldOut
from sklearn.base import clone

from placecue import (
    ByLog,
    DataError,
    InterleavedChunks,
    LaserScan,
    Observation,
    Pipeline,
    Unknown,
    UsageError,
)
from placecue.components.pipelines import build_pipeline, describe_pipeline
from placecue.evaluation.tally import Tally
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import SECOND, Beams, Walk, pipeline, registry

NOISY = {"noise": 1.2}


def one_cue(rate: float, **options: object) -> Pipeline:
    classifier = SVM(kernel=RBF(gamma=0.1), **options)  # type: ignore[arg-type]
    return Pipeline({"beams": (Beams(), classifier)}, unknown=Unknown(rate))


def two_cues(rate: float) -> Pipeline:
    """Beams twice, so that noise in the scans leaves errors."""
    cues = {
        "beams": (Beams(3), SVM(kernel=RBF(gamma=0.1), multiclass="oao")),
        "few": (Beams(2), SVM(kernel=RBF(gamma=0.1))),
    }
    integrator = SVMDAS(classifier=SVM(kernel=RBF(), search={"C": [1, 10], "gamma": [0.1, 0.3]}))
    return Pipeline(cues, integrator, unknown=Unknown(rate))


def accepted_errors(confidence: np.ndarray, right: np.ndarray, threshold: float) -> float:
    return float((confidence[~right] >= threshold).mean())


def held_out_decisions(trained: Pipeline) -> tuple[np.ndarray, np.ndarray]:
    """Fit the integrator by hand in each fold; what was searched stays as it was chosen."""
    held_out = trained.held_out_
    assert held_out is not None
    joined = np.hstack([held_out.evidence.scores(cue).values for cue in trained.cues])
    confidence, right = np.full(len(joined), np.nan), np.zeros(len(joined), dtype=bool)
    svm = trained.integrator.classifier_
    for train, test in InterleavedChunks().split(held_out.labels, held_out.stamps):
        low, high = joined[train].min(axis=0), joined[train].max(axis=0)
        scaled = 2 * (joined - low) / (high - low) - 1
        machine = SVM(kernel=RBF(gamma=svm.kernel_.gamma), C=svm.C_)
        decision = machine.fit(scaled[train], held_out.labels[train]).scores(scaled[test]).decide()
        confidence[test] = decision.confidence
        right[test] = decision.labels == held_out.labels[test]
    assert not np.isnan(confidence).any()
    return confidence, right


def test_the_rate_on_held_out_samples_is_what_was_asked_for() -> None:
    trained = two_cues(0.1).fit(Walk(rounds=6, **NOISY))
    found = trained.rejection_
    assert found is not None
    confidence, right = held_out_decisions(trained)
    n_wrong = int((~right).sum())
    assert n_wrong > 30
    # Equal, though computed another way: no sample lies on the threshold.
    assert accepted_errors(confidence, right, found.threshold) == found.false_accept_rate
    assert 0.1 - 1 / n_wrong <= found.false_accept_rate <= 0.1
    assert (confidence[right] >= found.threshold).mean() == found.accept_rate
    assert (found.n_wrong, found.n_right) == (n_wrong, right.sum())


def test_the_rate_holds_on_another_walk() -> None:
    for trained in (one_cue(0.1), two_cues(0.1)):
        trained.fit(Walk(rounds=6, **NOISY))
        assert trained.rejection_ is not None
        walk = list(Walk(rounds=6, seed=5, **NOISY))
        beliefs = list(trained.beliefs(walk, batch=50))
        right = np.array(
            [b.scores.decide().labels[0] == o.label for b, o in zip(beliefs, walk, strict=True)]
        )
        accepted = np.array([b.label != "unknown" for b in beliefs])
        assert accepted[~right].mean() < 0.2
        assert accepted[right].mean() > 2 * accepted[~right].mean()


def test_one_cue_s_threshold_is_chosen_on_its_out_of_fold_scores() -> None:
    trained = one_cue(0.1).fit(Walk(rounds=6, **NOISY))
    walk = list(Walk(rounds=6, **NOISY))
    labels = np.array([each.label for each in walk])
    beams = np.stack([Beams().extract(each) for each in walk])
    confidence, right = np.empty(len(walk)), np.empty(len(walk), dtype=bool)
    stamps = [each.stamp for each in walk]
    for train, test in InterleavedChunks().split(labels, stamps):
        machine = SVM(kernel=RBF(gamma=0.1)).fit(beams[train], labels[train])
        decision = machine.scores(beams[test]).decide()
        confidence[test], right[test] = decision.confidence, decision.labels == labels[test]
    found = trained.rejection_
    assert found is not None
    assert accepted_errors(confidence, right, found.threshold) == found.false_accept_rate
    assert found.false_accept_rate == pytest.approx(0.1, abs=1 / (~right).sum())


def test_beliefs_below_the_threshold_are_unknown_and_keep_scores_and_confidence() -> None:
    trained = one_cue(0.05).fit(Walk(rounds=6, **NOISY))
    plain = Pipeline(trained.cues).fit(Walk(rounds=6, **NOISY))
    assert plain.rejection_ is None
    assert trained.rejection_ is not None
    walk = list(Walk(seed=1, **NOISY))
    kinds = set()
    for ours, named in zip(trained.beliefs(walk), plain.beliefs(walk), strict=True):
        assert ours.confidence == named.confidence
        assert (ours.scores.values == named.scores.values).all()
        sure = ours.confidence >= trained.rejection_.threshold
        assert ours.label == (named.label if sure else "unknown")
        kinds.add(sure)
    assert kinds == {True, False}


def elsewhere(number: int) -> Observation:
    """A scan with walls much farther away than in any of the four places."""
    generator = np.random.default_rng(number)
    scan = LaserScan(np.linspace(-1, 1, 6), 14 + generator.random(6), 0.0, 20.0)
    return Observation(number * SECOND, scan=scan, label="garden")


@pytest.mark.parametrize("options", [{}, {"multiclass": "oao"}, {"probability": "sigmoid"}])
def test_a_place_that_is_none_of_the_classes_comes_out_unknown(options: dict[str, str]) -> None:
    trained = one_cue(0.2, **options).fit(Walk(rounds=6, noise=0.5))
    tally = Tally()
    for log in (Walk(seed=1, noise=0.5), [elsewhere(number) for number in range(40)]):
        for observation, belief in trained.follow(log, batch=40):
            tally.observe(observation, belief, None)
    shares = {name: tally.unknown("integrated", name) for name in tally.classes()}
    garden = shares.pop("garden")
    assert garden is not None
    assert garden > 0.9
    assert all(share is not None and share < garden - 0.2 for share in shares.values())


def test_an_integration_log_has_the_held_out_samples() -> None:
    other = Walk(rounds=3, seed=2, **NOISY)
    trained = two_cues(0.1).fit(Walk(rounds=6, **NOISY), integration=other)
    held_out = trained.held_out_
    assert held_out is not None
    assert held_out.stamps.tolist() == [each.stamp for each in other]
    evidence = {}
    for name, (cue, classifier) in trained.cues.items():
        features = np.stack([cue.extract(each) for each in other])
        evidence[name] = classifier.scores(features).values
        assert (held_out.evidence.scores(name).values == evidence[name]).all()
    confidence, right = held_out_decisions(trained)
    found = trained.rejection_
    assert found is not None
    assert accepted_errors(confidence, right, found.threshold) == found.false_accept_rate
    assert found.n_wrong + found.n_right == other.count()


def test_an_integration_log_serves_one_cue_too() -> None:
    # Decisions about a place that is none of the classes are never right.
    other = [*Walk(seed=2), *(elsewhere(number) for number in range(400, 440))]
    trained = one_cue(0.0).fit(Walk(rounds=6), integration=other)
    assert trained.rejection_ is not None
    assert trained.rejection_.n_wrong >= 40
    assert {b.label for b in trained.beliefs([elsewhere(n) for n in range(40)])} == {"unknown"}


def test_folds_of_whole_logs_cut_one_held_out_log_in_chunks() -> None:
    first, second = list(Walk(**NOISY)), list(Walk(seed=3, **NOISY))
    trained = one_cue(0.1)
    trained.folds = ByLog(only_last=True)
    trained.fit([*first, *second])
    assert trained.held_out_ is not None
    assert trained.rejection_ is not None
    assert len(trained.held_out_.labels) == len(second)
    assert trained.rejection_.n_wrong + trained.rejection_.n_right == len(second)


def test_the_integrator_s_copies_do_not_see_what_they_decide_on() -> None:
    seen: list[set[int]] = []

    class Watched(SVMDAS):
        def fit(self, evidence, labels, stamps=None):  # type: ignore[no-untyped-def]
            seen.append(set(np.asarray(stamps).tolist()))
            return super().fit(evidence, labels, stamps)

    template = two_cues(0.1)
    integrator = Watched(classifier=template.integrator.classifier)
    trained = Pipeline(template.cues, integrator, unknown=Unknown(0.1)).fit(Walk(rounds=6, **NOISY))
    everything, *copies = seen
    held_out = trained.held_out_
    assert held_out is not None
    assert everything == set(held_out.stamps.tolist())
    scored = held_out.integrated(clone_of(trained), InterleavedChunks())
    assert len(scored) == len(copies) == 5
    for (rows, _), learned in zip(scored, copies, strict=True):
        assert not learned & set(held_out.stamps[rows].tolist())
        assert learned | set(held_out.stamps[rows].tolist()) == everything
    assert np.concatenate([rows for rows, _ in scored]).size == len(everything)


def clone_of(trained: Pipeline) -> SVMDAS:
    """The integrator again, so that calls to it are not counted."""
    held_out = trained.held_out_
    assert held_out is not None
    chosen = trained.integrator.chosen()
    assert chosen.classifier.search is None
    assert chosen.classifier.C == trained.integrator.classifier_.C_
    again = SVMDAS(classifier=clone(chosen.classifier))
    return again.fit(held_out.evidence, held_out.labels, held_out.stamps)


def test_training_again_without_unknown_forgets_the_threshold() -> None:
    trained = one_cue(0.1).fit(Walk())
    trained.unknown = None
    assert trained.fit(Walk()).rejection_ is None
    assert trained.held_out_ is None


def test_probabilities_of_one_cue_are_held_out_where_a_diagram_is_wanted() -> None:
    svm = SVM(kernel=RBF(gamma=0.1), probability="sigmoid")
    trained = Pipeline({"beams": (Beams(), svm)})
    assert trained.fit(Walk()).held_out_ is None
    assert isinstance(trained.fit(Walk(), reliability=True).held_out_, HeldOut)
    margins = Pipeline({"beams": (Beams(), SVM(kernel=RBF(gamma=0.1)))})
    assert margins.fit(Walk(), reliability=True).held_out_ is None


def test_a_class_called_unknown_is_refused() -> None:
    walk = [each.relabelled("unknown") if each.label == "lab" else each for each in Walk()]
    with pytest.raises(DataError, match="samples of a class called 'unknown'"):
        one_cue(0.1).fit(walk)
    with pytest.raises(DataError, match="samples of a class called 'unknown'"):
        two_cues(0.1).fit(Walk(), integration=walk)
    assert "unknown" in pipeline().fit(walk).classes


def asked_for(config: object) -> Unknown | None:
    """What a pipeline asks for, whose config says so under ``unknown``."""
    known = registry()
    composition = describe_pipeline(pipeline(), known)
    return build_pipeline({**composition, "unknown": config}, known).unknown


@pytest.mark.parametrize(
    ("config", "said"),
    [
        (0.05, "unknown must be a mapping with 'false_accept_rate', or null, got 0.05; such as"),
        ({"rate": 0.1}, "unknown has no parameter 'rate'; available: false_accept_rate"),
        ({"false_accept_rate": "few"}, "unknown: false_accept_rate must be a number, got 'few'"),
        ({"false_accept_rate": True}, "false_accept_rate must be a number, got True"),
        ({"false_accept_rate": 5}, "false_accept_rate must be from 0 to 1, got 5"),
        ({"false_accept_rate": float("nan")}, "must be from 0 to 1, got nan"),
    ],
)
def test_a_wrong_config_is_answered_in_one_line(config: object, said: str) -> None:
    with pytest.raises(UsageError) as error:
        asked_for(config)
    assert said in str(error.value)


def test_null_asks_for_nothing() -> None:
    assert asked_for(None) is None
    assert asked_for({"false_accept_rate": None}) is None
    assert asked_for({"false_accept_rate": 0}) == Unknown(0)
