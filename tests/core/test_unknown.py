"""A pipeline says "unknown" below a threshold chosen on samples that no part of it has seen."""

from __future__ import annotations

import numpy as np
import pytest

from placecue import (
    ByLog,
    DataError,
    Decision,
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


def decided(
    joined: np.ndarray, labels: np.ndarray, stamps: np.ndarray, asked: np.ndarray
) -> Decision:
    """What SVM-DAS says of outputs, written out: scaled to [-1, 1], then an SVM with its search."""
    low, high = joined.min(axis=0), joined.max(axis=0)
    machine = SVM(kernel=RBF(), search={"C": [1, 10], "gamma": [0.1, 0.3]})
    machine.fit(2 * (joined - low) / (high - low) - 1, labels, stamps)
    return machine.scores(2 * (asked - low) / (high - low) - 1).decide()


def held_out_decisions(walk: Walk) -> tuple[np.ndarray, np.ndarray]:
    """Decisions about samples that no cue, search or integrator has seen, written out."""
    every = list(walk)
    labels, stamps = (np.array([getattr(each, n) for each in every]) for n in ("label", "stamp"))
    beams = np.stack([Beams(3).extract(each) for each in every])
    folds = InterleavedChunks()
    confidence, right = np.full(len(every), np.nan), np.zeros(len(every), dtype=bool)

    def outputs(rows: np.ndarray, asked: np.ndarray) -> np.ndarray:
        ways = SVM(kernel=RBF(gamma=0.1), multiclass="oao"), SVM(kernel=RBF(gamma=0.1))
        parts = zip(ways, (beams, beams[:, :2]), strict=True)
        each = [m.fit(x[rows], labels[rows]).scores(x[asked]).values for m, x in parts]
        return np.hstack(each)

    for train, test in folds.split(labels, stamps):
        joined = np.full((len(train), 6 + 4), np.nan)
        for rows, unseen in folds.split(labels[train], stamps[train]):
            joined[unseen] = outputs(train[rows], train[unseen])
        known = ~np.isnan(joined).any(axis=1)
        given = joined[known], labels[train][known], stamps[train][known]
        decision = decided(*given, outputs(train, test))
        confidence[test] = decision.confidence
        right[test] = decision.labels == labels[test]
    assert not np.isnan(confidence).any()
    return confidence, right


def test_the_rate_on_held_out_samples_is_what_was_asked_for() -> None:
    trained = two_cues(0.1).fit(Walk(rounds=4, **NOISY))
    found = trained.rejection_
    assert found is not None
    confidence, right = held_out_decisions(Walk(rounds=4, **NOISY))
    n_wrong = int((~right).sum())
    assert n_wrong > 30
    # Equal, though computed another way: no sample lies on the threshold.
    assert accepted_errors(confidence, right, found.threshold) == found.false_accept_rate
    assert 0.1 - 1 / n_wrong <= found.false_accept_rate <= 0.1
    assert (confidence[right] >= found.threshold).mean() == found.accept_rate
    assert (found.n_wrong, found.n_right) == (n_wrong, right.sum())


def test_the_rate_holds_on_another_walk() -> None:
    for trained in (one_cue(0.1), two_cues(0.1)):
        trained.fit(Walk(rounds=4, **NOISY))
        assert trained.rejection_ is not None
        walk = list(Walk(rounds=4, seed=5, **NOISY))
        beliefs = list(trained.beliefs(walk, batch=50))
        right = np.array(
            [b.scores.decide().labels[0] == o.label for b, o in zip(beliefs, walk, strict=True)]
        )
        accepted = np.array([b.label != "unknown" for b in beliefs])
        assert accepted[~right].mean() < 0.2
        assert accepted[right].mean() > 2 * accepted[~right].mean()


def test_one_cue_s_threshold_is_chosen_on_its_out_of_fold_scores() -> None:
    trained = one_cue(0.1).fit(Walk(rounds=4, **NOISY))
    walk = list(Walk(rounds=4, **NOISY))
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
    trained = one_cue(0.05).fit(Walk(rounds=4, **NOISY))
    plain = Pipeline(trained.cues).fit(Walk(rounds=4, **NOISY))
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
    trained = one_cue(0.2, **options).fit(Walk(rounds=4, noise=0.5))
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
    trained = two_cues(0.1).fit(Walk(rounds=4, **NOISY), integration=other)
    held_out = trained.held_out_
    assert held_out is not None
    assert held_out.stamps.tolist() == [each.stamp for each in other]
    for name, model in trained.cues.items():
        features = np.stack([model.cue.extract(each) for each in other])
        expected = model.classifier.scores(features).values
        np.testing.assert_allclose(held_out.evidence.scores(name).values, expected, atol=1e-9)
    joined = np.hstack([held_out.evidence.scores(name).values for name in trained.cues])
    confidence, right = np.full(len(joined), np.nan), np.zeros(len(joined), dtype=bool)
    labels, stamps = held_out.labels, held_out.stamps
    for train, test in InterleavedChunks().split(labels, stamps):
        decision = decided(joined[train], labels[train], stamps[train], joined[test])
        confidence[test], right[test] = decision.confidence, decision.labels == labels[test]
    found = trained.rejection_
    assert found is not None
    assert accepted_errors(confidence, right, found.threshold) == found.false_accept_rate
    assert found.n_wrong + found.n_right == other.count()


def test_an_integration_log_serves_one_cue_too() -> None:
    # Decisions about a place that is none of the classes are never right.
    other = [*Walk(seed=2), *(elsewhere(number) for number in range(400, 440))]
    trained = one_cue(0.0).fit(Walk(rounds=4), integration=other)
    assert trained.rejection_ is not None
    assert trained.rejection_.n_wrong >= 40
    assert {b.label for b in trained.beliefs([elsewhere(n) for n in range(40)])} == {"unknown"}


def test_folds_of_whole_logs_cut_one_held_out_log_in_chunks() -> None:
    first, second = list(Walk(**NOISY)), list(Walk(seed=3, **NOISY))
    trained = one_cue(0.1)
    trained.folds = ByLog(only_last=True)
    trained.fit([*first, *second])
    assert trained.judged_ is not None
    assert trained.rejection_ is not None
    assert [len(each.labels) for each in trained.judged_] == [len(second)]
    assert trained.rejection_.n_wrong + trained.rejection_.n_right == len(second)


def test_training_again_without_unknown_forgets_the_threshold() -> None:
    trained = one_cue(0.1).fit(Walk())
    trained.unknown = None
    assert trained.fit(Walk()).rejection_ is None
    assert trained.judged_ is None


def test_probabilities_of_one_cue_are_held_out_where_a_diagram_is_wanted() -> None:
    svm = SVM(kernel=RBF(gamma=0.1), probability="sigmoid")
    trained = Pipeline({"beams": (Beams(), svm)})
    assert trained.fit(Walk()).judged_ is None
    assert len(trained.fit(Walk(), reliability=True).judged_ or []) == 5
    margins = Pipeline({"beams": (Beams(), SVM(kernel=RBF(gamma=0.1)))})
    assert margins.fit(Walk(), reliability=True).judged_ is None


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
