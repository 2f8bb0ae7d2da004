"""Rules over probabilities, by hand and against scikit-learn; four classes."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import log_softmax, softmax
from sklearn.ensemble import VotingClassifier

from peers import Columns, side_by_side
from placecue import DataError, OneAgainstAll, Probabilities, Scores, StoredEvidence, UsageError
from placecue_integrators.probability_rules import (
    MaxProbability,
    MeanProbability,
    ProbabilityRule,
    ProductProbability,
)

CLASSES = ("corridor", "kitchen", "lab", "office")
LAYOUT = Probabilities(CLASSES)
RULES = [MeanProbability, ProductProbability, MaxProbability]
GONE = [np.nan] * 4


def cues(*rows: list[float]) -> StoredEvidence:
    """One sample by a cue a row."""
    return StoredEvidence({str(i): Scores(np.array([r]), LAYOUT) for i, r in enumerate(rows)})


def joined(rule: ProbabilityRule, evidence: StoredEvidence) -> np.ndarray:
    labels = np.resize(CLASSES, len(evidence))
    scores = rule.fit(evidence, labels).integrate(evidence)
    assert scores.layout == LAYOUT
    return scores.values


def random_probabilities(n: int = 100) -> dict[str, np.ndarray]:
    generator = np.random.default_rng(0)
    return {cue: generator.dirichlet([0.5] * 4, size=n) for cue in ("crfh", "laser", "sift")}


TWO = [0.6, 0.3, 0.1, 0.0], [0.1, 0.4, 0.4, 0.1]


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        (MeanProbability(), [0.35, 0.35, 0.25, 0.05]),
        (ProductProbability(), [0.06 / 0.22, 0.12 / 0.22, 0.04 / 0.22, 0]),
        (MaxProbability(), [0.6 / 1.5, 0.4 / 1.5, 0.4 / 1.5, 0.1 / 1.5]),
    ],
)
def test_the_rules_by_hand(rule: ProbabilityRule, expected: list[float]) -> None:
    assert joined(rule, cues(*TWO))[0] == pytest.approx(expected)


@pytest.mark.parametrize("rule", RULES)
def test_one_cue_passes_through(rule: type[ProbabilityRule]) -> None:
    assert joined(rule(), cues(TWO[0]))[0] == pytest.approx(TWO[0])


@pytest.mark.parametrize("rule", RULES)
def test_a_missing_cue_is_left_out_and_without_any_there_is_nothing(
    rule: type[ProbabilityRule],
) -> None:
    values = np.array([TWO[0], GONE, GONE]), np.array([TWO[1], TWO[1], GONE])
    evidence = StoredEvidence({str(i): Scores(each, LAYOUT) for i, each in enumerate(values)})
    found = joined(rule(), evidence)
    assert found[0] == pytest.approx(joined(rule(), cues(*TWO))[0])
    assert found[1] == pytest.approx(TWO[1])
    assert np.isnan(found[2]).all()
    assert rule.gaps


def test_a_class_that_a_cue_calls_impossible_is_out_however_sure_the_others_are() -> None:
    found = joined(ProductProbability(), cues([0, 0.5, 0.25, 0.25], [0.98, 0.01, 0.01, 0]))
    assert found[0] == pytest.approx([0, 2 / 3, 1 / 3, 0])


def test_where_every_class_is_impossible_to_some_cue_the_fewest_vetoes_stay() -> None:
    # Corridor: vetoed twice; kitchen once, 0.5 * 0.4; lab once, 1 * 0.6; office three times.
    found = joined(ProductProbability(), cues([0, 0, 1, 0], [0.5, 0.5, 0, 0], [0, 0.4, 0.6, 0]))
    assert found[0] == pytest.approx([0, 0.2 / 0.8, 0.6 / 0.8, 0])


def test_that_is_what_it_tends_to_where_a_vanishing_probability_stands_for_none() -> None:
    rows = [[0, 0, 1, 0], [0.5, 0.5, 0, 0], [0, 0.4, 0.6, 0]]
    vanishing = np.prod(np.maximum(rows, 1e-9), axis=0)
    found = joined(ProductProbability(), cues(*rows))
    assert found[0] == pytest.approx(vanishing / vanishing.sum(), abs=1e-6)


def test_many_tiny_probabilities_do_not_vanish() -> None:
    row = [1e-200, 2e-200, 1e-201, 1]
    none_of_it = [1e-200, 1e-200, 1e-200, 0]
    found = joined(ProductProbability(), cues(row, row, row, none_of_it))
    assert found[0] == pytest.approx([1 / 9.001, 8 / 9.001, 0.001 / 9.001, 0])


def test_priors_are_taken_off_once_for_each_cue_but_one() -> None:
    labels = np.repeat(CLASSES, [5, 2, 1, 0])  # priors 6/12, 3/12, 2/12, 1/12
    rows = [0.4, 0.3, 0.2, 0.1], [0.2, 0.2, 0.2, 0.4], [0.25, 0.25, 0.25, 0.25]
    evidence = StoredEvidence(
        {str(i): Scores(np.array([row] * 8), LAYOUT) for i, row in enumerate(rows)}
    )
    rule = ProductProbability(priors="training").fit(evidence, labels)
    priors = np.array([6, 3, 2, 1]) / 12
    assert rule.priors_ == pytest.approx(priors)
    expected = np.prod(rows, axis=0) / priors**2
    assert rule.integrate(evidence).values[3] == pytest.approx(expected / expected.sum())
    without = cues(rows[0], GONE, GONE)
    assert rule.integrate(without).values[0] == pytest.approx(rows[0])  # a single cue: no division


def test_the_mean_is_scikit_learn_s_soft_voting() -> None:
    values = random_probabilities()
    evidence = StoredEvidence({cue: Scores(each, LAYOUT) for cue, each in values.items()})
    peers = [(cue, Columns(4 * i, 4 * i + 4)) for i, cue in enumerate(values)]
    together = side_by_side(values)
    peer = VotingClassifier(peers, voting="soft").fit(together, np.resize(CLASSES, 100))
    assert joined(MeanProbability(), evidence) == pytest.approx(peer.predict_proba(together))


@pytest.mark.parametrize("rule", RULES)
def test_one_sample_is_integrated_as_many_are(rule: type[ProbabilityRule]) -> None:
    values = random_probabilities()
    evidence = StoredEvidence({cue: Scores(each, LAYOUT) for cue, each in values.items()})
    found = joined(rule(), evidence)
    assert found.sum(axis=1) == pytest.approx(np.ones(100))
    fitted = rule().fit(evidence, np.resize(CLASSES, 100))
    each = [fitted.integrate(evidence.take([row])).values[0] for row in range(100)]
    assert np.array(each).tobytes() == found.tobytes()


@pytest.mark.parametrize("rule", RULES)
def test_other_scores_are_refused_and_the_words_that_help_are_named(
    rule: type[ProbabilityRule],
) -> None:
    mixed = StoredEvidence(
        {"laser": Scores(np.eye(4), LAYOUT), "crfh": Scores(np.eye(4), OneAgainstAll(CLASSES))}
    )
    said = (
        r"^cue 'crfh' gives one_against_all scores, and this integrator joins probabilities: set "
        r"integrator\.calibrate=true, or cues\.crfh\.classifier\.probability=sigmoid for an SVM, "
        r"cues\.crfh\.classifier\.output=probability for AdaBoost, or [^\n]*integrator=vote$"
    )
    with pytest.raises(UsageError, match=said):
        rule().fit(mixed, CLASSES)


MARGINS = np.random.default_rng(1).normal(size=(200, 4))


def logistic(values: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """A slope and a bias a class, by log loss with classes of equal weight, as scipy finds them."""
    evidence = values - values.mean(axis=1, keepdims=True)
    evidence /= np.sqrt((evidence**2).mean())
    weights = 1 / np.bincount(truth)[truth] / 4 * len(truth)

    def loss(x: np.ndarray) -> float:
        logs = log_softmax(x[0] * evidence + x[1:], axis=1)
        return float(-weights @ logs[np.arange(len(truth)), truth] + x @ x / 2)

    found = minimize(loss, np.zeros(5), tol=1e-10)
    return np.asarray(softmax(found.x[0] * evidence + found.x[1:], axis=1))


def test_other_scores_are_calibrated_where_asked() -> None:
    truth = (2 * MARGINS + np.random.default_rng(2).normal(size=(200, 4))).argmax(axis=1)
    given = np.random.default_rng(3).dirichlet([1.0] * 4, size=200)
    margins = np.where(np.arange(200)[:, None] % 5 == 0, np.nan, 10 * MARGINS)
    evidence = StoredEvidence(
        {"laser": Scores(given, LAYOUT), "crfh": Scores(margins, OneAgainstAll(CLASSES))}
    )
    rule = ProductProbability(calibrate=True)
    found = rule.fit(evidence, np.array(CLASSES)[truth]).integrate(evidence).values
    there = np.arange(200) % 5 != 0
    product = given[there] * logistic(margins[there], truth[there])
    assert found[there] == pytest.approx(product / product.sum(axis=1, keepdims=True), abs=1e-4)
    assert found[~there] == pytest.approx(given[~there])  # the cue is missing
    assert rule.summary() == "calibrated: crfh"


def test_a_cue_without_held_out_scores_cannot_be_calibrated() -> None:
    evidence = StoredEvidence(
        {
            "laser": Scores(np.eye(4), LAYOUT),
            "crfh": Scores(np.full((4, 4), np.nan), OneAgainstAll(CLASSES)),
        }
    )
    with pytest.raises(
        DataError, match=r"^the scores of cue 'crfh' cannot be calibrated: of the 0"
    ):
        MeanProbability(calibrate=True).fit(evidence, CLASSES)


def test_unknown_priors_are_refused() -> None:
    with pytest.raises(UsageError, match=r"priors is 'equall'; did you mean 'equal'\? available"):
        ProductProbability(priors="equall").fit(cues(TWO[0]), ["lab"])
