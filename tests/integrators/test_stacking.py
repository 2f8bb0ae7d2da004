"""Stacking is scikit-learn's, on the same scores; four classes and mixed layouts."""

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier, StackingClassifier
from sklearn.linear_model import LogisticRegression

from peers import Columns, side_by_side
from placecue import OneAgainstAll, OneAgainstOne, Scores, StoredEvidence, UsageError
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_integrators.stacking import Stacking

CLASSES = ("corridor", "kitchen", "lab", "office")


@pytest.fixture(scope="module")
def labelled() -> tuple[StoredEvidence, np.ndarray]:
    """Margins of pairs by one cue, outputs a class by another."""
    generator = np.random.default_rng(11)
    codes = generator.integers(0, 4, 160)
    pairs = OneAgainstOne(CLASSES)
    vision = generator.normal(size=(160, 6))
    for column, (i, j) in enumerate(pairs.pairs):
        vision[:, column] += (codes == i) * 1.0 - (codes == j)
    laser = generator.normal(size=(160, 4)) + np.eye(4)[codes]
    scores = {"vision": Scores(vision, pairs), "laser": Scores(laser, OneAgainstAll(CLASSES))}
    return StoredEvidence(scores), np.array(CLASSES)[codes]


@pytest.mark.parametrize(
    ("estimator", "name", "params"),
    [
        (LogisticRegression(C=0.5), "linear_model.LogisticRegression", {"C": 0.5}),
        (
            RandomForestClassifier(20, random_state=0),
            "ensemble.RandomForestClassifier",
            {"n_estimators": 20},
        ),
    ],
)
def test_it_equals_scikit_learn_s(
    labelled: tuple[StoredEvidence, np.ndarray],
    estimator: LogisticRegression | RandomForestClassifier,
    name: str,
    params: dict[str, float],
) -> None:
    evidence, labels = labelled
    joined = side_by_side({cue: evidence.scores(cue).values for cue in evidence.cues})
    models = [("vision", Columns(0, 6)), ("laser", Columns(6, 10))]
    prefit = [(cue, each.fit(joined, labels)) for cue, each in models]
    peer = StackingClassifier(prefit, estimator, cv="prefit").fit(joined[:80], labels[:80])
    stacking = Stacking(ScikitLearn(f"sklearn.{name}", params))
    stacking.fit(evidence.take(range(80)), labels[:80])
    found = stacking.integrate(evidence.take(range(80, 160)))
    assert found.values == pytest.approx(peer.predict_proba(joined[80:]), abs=1e-9)
    assert np.array_equal(found.decide().labels, peer.predict(joined[80:]))


def test_a_sample_that_lacks_a_cue_is_left_out_and_cannot_be_told(
    labelled: tuple[StoredEvidence, np.ndarray],
) -> None:
    evidence, labels = labelled
    holes = evidence.scores("laser").values.copy()
    holes[::4] = np.nan
    holed = {"vision": evidence.scores("vision"), "laser": Scores(holes, OneAgainstAll(CLASSES))}
    whole = np.arange(160) % 4 != 0

    def fitted(on: StoredEvidence, truth: np.ndarray) -> Stacking:
        return Stacking(ScikitLearn("sklearn.linear_model.LogisticRegression")).fit(on, truth)

    found = fitted(StoredEvidence(holed), labels).integrate(StoredEvidence(holed))
    assert np.array_equal(found.available(), whole)
    same = fitted(evidence.take(whole), labels[whole]).integrate(evidence.take(whole))
    assert np.array_equal(found.values[whole], same.values)


def test_a_classifier_is_needed(labelled: tuple[StoredEvidence, np.ndarray]) -> None:
    with pytest.raises(UsageError, match="stacking needs a classifier, such as classifier="):
        Stacking().fit(*labelled)
