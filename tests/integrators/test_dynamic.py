"""Log-linear pooling: the formula by hand, the fit against other solvers, and the dark."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import log_softmax, softmax
from sklearn.metrics import balanced_accuracy_score

from placecue import (
    DataError,
    DecisionList,
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
    Scores,
    StoredEvidence,
    UsageError,
)
from placecue_integrators.calibrated import Calibration, class_evidence
from placecue_integrators.dynamic import Dynamic

CLASSES = ("corridor", "kitchen", "lab", "office")
LAYOUT = OneAgainstAll(CLASSES)


def dark_half(n: int, seed: int) -> tuple[StoredEvidence, np.ndarray]:
    """A laser that is fair throughout; a camera that is good by day and a weaker noise by night."""
    generator = np.random.default_rng(seed)
    codes = generator.integers(0, 4, n)
    true = np.eye(4)[codes]
    night = (np.arange(n) % 2 == 0)[:, None]
    camera = np.where(night, 0, 5 * true) + generator.normal(size=(n, 4))
    laser = 1.5 * true + generator.normal(size=(n, 4))
    scores = {"camera": Scores(camera, LAYOUT), "laser": Scores(laser, LAYOUT)}
    return StoredEvidence(scores), np.array(CLASSES)[codes]


def balanced_loss(logits: np.ndarray, labels: np.ndarray) -> float:
    """Mean over classes of the mean log loss."""
    codes = np.searchsorted(CLASSES, labels)
    losses = -log_softmax(logits, axis=1)[np.arange(len(codes)), codes]
    return float(np.mean([losses[codes == code].mean() for code in np.unique(codes)]))


def calibrated(evidence: StoredEvidence, labels: np.ndarray, penalty: float) -> list[np.ndarray]:
    """Slope over scale, then biases, of each cue, by a solver without bounds or gradients."""
    found = []
    for cue in evidence.cues:
        values = evidence.scores(cue).values
        values = values - values.mean(axis=1, keepdims=True)
        scale = values.std()

        def loss(at: np.ndarray, values: np.ndarray = values / scale) -> float:
            logits = at[0] * values + at[1:]
            return balanced_loss(logits, labels) + penalty / (2 * len(labels)) * (at @ at)

        at = minimize(loss, np.zeros(5), method="BFGS", options={"gtol": 1e-9}).x
        found.append(np.array([at[0] / scale, *at[1:]]))
    return found


def log_probabilities(evidence: StoredEvidence, learned: list[np.ndarray]) -> np.ndarray:
    each = []
    for cue, at in zip(evidence.cues, learned, strict=True):
        values = evidence.scores(cue).values
        each.append(log_softmax(at[0] * values + at[1:], axis=1))
    return np.array(each)


def certainties(logs: np.ndarray) -> np.ndarray:
    return 1 + (np.exp(logs) * logs).sum(axis=-1, keepdims=True) / np.log(4)


def test_the_formula_by_hand() -> None:
    dynamic = Dynamic()
    dynamic.cues_ = ["camera", "laser"]
    dynamic.layouts_ = [LAYOUT, OneAgainstAll(CLASSES)]
    dynamic.slopes_, dynamic.scales_ = np.array([2.0, 3.0]), np.array([4.0, 1.0])
    dynamic.biases_ = np.array([[0, 0, 0, np.log(3)], [0, 0, 0, 0]])
    dynamic.weights_ = np.array([[0.5, 1.5], [2.0, 0.25]])
    camera = np.array([[2 * np.log(2), 0, 0, 0]])  # half of it: odds 2 : 1 : 1 : 3
    laser = np.array([[0.0, 0, np.log(2), 0]])  # thrice: odds 1 : 1 : 8 : 1
    evidence = StoredEvidence(
        {"camera": Scores(camera, LAYOUT), "laser": Scores(laser, OneAgainstAll(CLASSES))}
    )
    p, q = np.array([2, 1, 1, 3]) / 7, np.array([1, 1, 8, 1]) / 11
    sure = [1 - sum(-each * np.log(each)) / np.log(4) for each in (p, q)]
    weights = 0.5 * (1 - sure[0]) + 1.5 * sure[0], 2.0 * (1 - sure[1]) + 0.25 * sure[1]
    expected = p ** weights[0] * q ** weights[1]
    found = dynamic.integrate(evidence)
    assert found.layout == Probabilities(CLASSES)
    assert found.values[0] == pytest.approx(expected / expected.sum())


@pytest.mark.parametrize("penalty", [1.0, 0.05])
def test_the_fit_is_the_minimum_that_other_solvers_find(penalty: float) -> None:
    evidence, labels = dark_half(120, seed=1)
    dynamic = Dynamic(penalty=penalty).fit(evidence, labels)
    learned = calibrated(evidence, labels, penalty)
    for i, at in enumerate(learned):
        assert dynamic.slopes_[i] / dynamic.scales_[i] == pytest.approx(at[0], abs=1e-4)
        assert dynamic.biases_[i] == pytest.approx(at[1:], abs=1e-4)
    logs = log_probabilities(evidence, learned)
    sure = certainties(logs)

    def loss(at: np.ndarray) -> float:
        u, v = at.reshape(2, 2, 1, 1).swapaxes(0, 1)
        logits = ((u * (1 - sure) + v * sure) * logs).sum(axis=0)
        drawn = penalty / (2 * len(labels)) * ((at - 1) ** 2).sum()
        return balanced_loss(logits, labels) + drawn

    found = minimize(loss, np.ones(4), method="SLSQP", bounds=[(0, None)] * 4, tol=1e-12).x
    assert dynamic.weights_.ravel() == pytest.approx(found, abs=1e-3)


def test_a_camera_in_the_dark_counts_less_and_that_beats_fixed_weights() -> None:
    evidence, labels = dark_half(600, seed=2)
    fresh, truth = dark_half(4000, seed=3)
    dynamic = Dynamic(penalty=0.01).fit(evidence, labels)
    unsure, certain = dynamic.weights_[0]
    assert unsure < 0.5 * certain
    # The rival: the same calibrated probabilities, and the best weights that every sample shares.
    learned = calibrated(evidence, labels, 0.01)
    logs = log_probabilities(evidence, learned)

    def loss(at: np.ndarray) -> float:
        return balanced_loss(np.einsum("t,tnk->nk", at, logs), labels)

    fixed = minimize(loss, np.ones(2), bounds=[(0, None)] * 2).x
    rival = softmax(np.einsum("t,tnk->nk", fixed, log_probabilities(fresh, learned)), axis=1)
    scores = dynamic.integrate(fresh)
    assert balanced_loss(np.log(scores.values), truth) < balanced_loss(np.log(rival), truth) - 0.02
    right = balanced_accuracy_score(truth, scores.decide().labels)
    assert right > balanced_accuracy_score(truth, np.array(CLASSES)[rival.argmax(axis=1)]) + 0.01
    alone = [balanced_accuracy_score(truth, fresh.scores(c).decide().labels) for c in fresh.cues]
    assert right > max(alone) + 0.1


def test_without_weights_a_sample_each_cue_has_one() -> None:
    evidence, labels = dark_half(200, seed=2)
    fixed = Dynamic(penalty=0.5, per_sample=False).fit(evidence, labels)
    assert np.array_equal(fixed.weights_[:, 0], fixed.weights_[:, 1])
    logs = log_probabilities(evidence, calibrated(evidence, labels, 0.5))

    def loss(at: np.ndarray) -> float:
        drawn = 0.5 / (2 * len(labels)) * ((at - 1) ** 2).sum()
        return balanced_loss(np.einsum("t,tnk->nk", at, logs), labels) + drawn

    found = minimize(loss, np.ones(2), method="SLSQP", bounds=[(0, None)] * 2, tol=1e-12).x
    assert fixed.weights_[:, 0] == pytest.approx(found, abs=1e-3)
    expected = softmax(np.einsum("t,tnk->nk", found, logs), axis=1)
    assert fixed.integrate(evidence).values == pytest.approx(expected, abs=1e-3)


def test_a_cue_that_is_worse_than_chance_says_nothing() -> None:
    evidence, labels = dark_half(200, seed=4)
    liar = Scores(-evidence.scores("laser").values, LAYOUT)
    both = StoredEvidence({"camera": evidence.scores("camera"), "liar": liar})
    dynamic = Dynamic().fit(both, labels)
    assert dynamic.slopes_[1] == 0
    other = StoredEvidence({**{"camera": both.scores("camera")}, "liar": liar[::-1]})
    assert np.array_equal(dynamic.integrate(both).values, dynamic.integrate(other).values)


@pytest.mark.parametrize(
    "layout",
    [
        OneAgainstAll(CLASSES),
        OneAgainstOne(CLASSES),
        ModifiedOneAgainstAll(CLASSES),
        Probabilities(CLASSES),
        DecisionList(CLASSES, ("lab", "kitchen", "office", "corridor")),
    ],
    ids=lambda layout: layout.name,
)
def test_scores_of_every_layout_are_calibrated(layout: Layout) -> None:
    generator = np.random.default_rng(5)
    codes = generator.integers(0, 4, 2000)
    outputs = 2 * np.eye(4)[codes] + generator.normal(size=(2000, 4))
    values = {
        "one_against_one": np.stack([outputs[:, i] - outputs[:, j] for i, j in _pairs()], axis=1),
        "modified_one_against_all": outputs - 2,
        "probabilities": softmax(3 * outputs, axis=1),  # far too sure
    }.get(layout.name, outputs)
    labels = np.array(CLASSES)[codes]
    evidence = StoredEvidence({"cue": Scores(values, layout)})
    dynamic = Dynamic().fit(evidence.take(range(1000)), labels[:1000])
    found = dynamic.integrate(evidence.take(range(1000, 2000)))
    # Reliability: of decisions that are made with about p, about p are right.
    best, right = found.values.max(axis=1), found.decide().labels == labels[1000:]
    own = evidence.scores("cue")[1000:].decide().labels == labels[1000:]
    assert right.mean() > own.mean() - 0.02
    for low, high in ((0.3, 0.6), (0.6, 0.85), (0.85, 1.0)):
        some = (low <= best) & (best < high)
        assert some.sum() > 50
        assert right[some].mean() == pytest.approx(best[some].mean(), abs=0.12)


def _pairs() -> tuple[tuple[int, int], ...]:
    return OneAgainstOne(CLASSES).pairs


def test_what_speaks_for_a_class() -> None:
    pairs = np.array([[3.0, -1, 2, 1, 4, -2]])  # c|k, c|l, c|o, k|l, k|o, l|o
    found = class_evidence(Scores(pairs, OneAgainstOne(CLASSES)))
    # The worst of corridor 3 -1 2, kitchen -3 1 4, lab 1 -1 -2, office -2 -4 2; their mean is -2.5.
    assert found[0] == pytest.approx([1.5, -0.5, 0.5, -1.5])
    values = np.array([[-1.0, 0.5, 2, 0]])
    modified = class_evidence(Scores(values, ModifiedOneAgainstAll(CLASSES)))
    assert modified[0] == pytest.approx([-0.125, 0.375, -1.125, 0.875])
    impossible = class_evidence(Scores(np.eye(4), Probabilities(CLASSES)))
    assert np.isfinite(impossible).all()


def test_the_unit_of_the_scores_does_not_matter() -> None:
    evidence, labels = dark_half(100, seed=6)
    expected = Dynamic().fit(evidence, labels).integrate(evidence)
    for factor in (1e-12, 1e12):
        other = {c: Scores(factor * evidence.scores(c).values, LAYOUT) for c in evidence.cues}
        found = Dynamic().fit(StoredEvidence(other), labels).integrate(StoredEvidence(other))
        assert found.values == pytest.approx(expected.values, abs=1e-5)


def test_scores_beyond_all_that_was_seen_leave_numbers() -> None:
    evidence, labels = dark_half(100, seed=6)
    far = np.array([[1e300, -1e300, 0, 0], [-1e300, 0, 0, 0]])
    both = StoredEvidence({c: Scores(far, LAYOUT) for c in evidence.cues})
    values = Dynamic().fit(evidence, labels).integrate(both).values
    assert values[0] == pytest.approx([1, 0, 0, 0])
    assert values.sum(axis=1) == pytest.approx([1, 1])


def test_scores_that_never_change_tell_nothing() -> None:
    evidence, labels = dark_half(100, seed=6)
    still = {"laser": evidence.scores("laser"), "still": Scores(np.full((100, 4), 0.7), LAYOUT)}
    alone = {"laser": still["laser"]}
    found = Dynamic().fit(StoredEvidence(still), labels).integrate(StoredEvidence(still))
    expected = Dynamic().fit(StoredEvidence(alone), labels).integrate(StoredEvidence(alone))
    assert found.values == pytest.approx(expected.values, abs=0.02)


def test_one_sample_is_integrated_as_many_are() -> None:
    evidence, labels = dark_half(60, seed=7)
    dynamic = Dynamic().fit(evidence, labels)
    each = [dynamic.integrate(evidence.take([row])).values[0] for row in range(60)]
    assert np.array(each).tobytes() == dynamic.integrate(evidence).values.tobytes()


def test_a_sample_that_lacks_a_cue_is_left_out_and_cannot_be_told() -> None:
    evidence, labels = dark_half(80, seed=8)
    holes = evidence.scores("camera").values.copy()
    holes[::4, 2] = np.nan
    holed = StoredEvidence({"camera": Scores(holes, LAYOUT), "laser": evidence.scores("laser")})
    whole = np.arange(80) % 4 != 0
    found = Dynamic().fit(holed, labels).integrate(holed)
    assert np.array_equal(found.available(), whole)
    part = evidence.take(whole)
    same = Dynamic().fit(part, labels[whole]).integrate(part)
    assert np.array_equal(found.values[whole], same.values)
    assert not getattr(Dynamic, "gaps", False)


def test_what_cannot_be_learned_from_is_refused() -> None:
    evidence, labels = dark_half(20, seed=9)
    with pytest.raises(DataError, match=r"scores of all cues \(camera, laser\), got 20 of lab"):
        Dynamic().fit(evidence, np.full(20, "lab"))
    with pytest.raises(DataError, match=r"need held-out samples of two classes .* got 1 of "):
        Dynamic().fit(evidence.take([0]), labels[:1])
    nowhere = Scores(np.full((20, 4), np.nan), LAYOUT)
    with pytest.raises(DataError, match=r"scores of all cues \(a\), got none$"):
        Dynamic().fit(StoredEvidence({"a": nowhere}), labels)
    with pytest.raises(UsageError, match="penalty is 0; give a number above 0"):
        Dynamic(penalty=0).fit(evidence, labels)


def test_a_class_without_held_out_samples_does_no_harm() -> None:
    evidence, labels = dark_half(100, seed=10)
    some = labels != "lab"
    dynamic = Dynamic().fit(evidence.take(some), labels[some])
    found = dynamic.integrate(evidence)
    assert np.isfinite(found.values).all()
    assert (found.decide().labels[some] == labels[some]).mean() > 0.7


def test_the_calibration_keeps_the_order_but_for_the_biases() -> None:
    evidence, labels = dark_half(200, seed=11)
    speaks = class_evidence(evidence.scores("laser"))
    calibration = Calibration.fit(speaks, np.searchsorted(CLASSES, labels), 1.0)
    unbiased = calibration.log_probabilities(speaks) - calibration.bias
    assert np.array_equal(unbiased.argmax(axis=1), speaks.argmax(axis=1))


def test_what_a_model_folder_says_must_fit_together() -> None:
    evidence, labels = dark_half(40, seed=12)
    dynamic = Dynamic().fit(evidence, labels)
    dynamic.check_learned()
    dynamic.weights_ = dynamic.weights_[:1]
    with pytest.raises(
        ValueError, match=r"2 cues, biases \(2, 4\), and the others of shapes .*\(1, 2\)"
    ):
        dynamic.check_learned()
