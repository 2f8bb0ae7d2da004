"""Evidence with gaps, views and unions."""

from __future__ import annotations

import numpy as np
import pytest

from placecue import (
    LaserScan,
    Observation,
    ObservedEvidence,
    OneAgainstAll,
    OneAgainstOne,
    Pipeline,
    Probabilities,
    Scores,
    StoredEvidence,
    UsageError,
)
from placecue.evidence import concatenate
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import SECOND, Beams, Walk, pipeline

CLASSES = ("corridor", "kitchen", "lab", "office", "printer")
GAP = np.nan


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


def stored(n: int = 4, missing: tuple[int, ...] = ()) -> StoredEvidence:
    first = np.arange(n * 5, dtype=float).reshape(n, 5)
    second = -np.arange(n * 10, dtype=float).reshape(n, 10)
    second[list(missing)] = GAP
    return StoredEvidence(
        {
            "vision": Scores(first, OneAgainstAll(CLASSES)),
            "laser": Scores(second, OneAgainstOne(CLASSES)),
        }
    )


def test_a_missing_cue_is_a_row_of_nan() -> None:
    evidence = stored(missing=(1, 3))
    assert evidence.available("laser").tolist() == [True, False, True, False]
    assert evidence.available("vision").all()
    assert evidence.used(0) == ("vision", "laser")
    assert evidence.used(1) == ("vision",)


@pytest.mark.parametrize(
    "rows", [[2, 0], np.array([2, 0]), np.array([True, False, True, False])[[0, 1, 2, 3]]]
)
def test_a_view_has_the_rows_asked_for(rows: object) -> None:
    evidence = stored(missing=(0,))
    view = evidence.take(rows)  # type: ignore[arg-type]
    expected = [0, 2] if isinstance(rows, np.ndarray) and rows.dtype == bool else [2, 0]
    assert len(view) == 2
    assert np.array_equal(view.scores("vision").values, evidence.scores("vision").values[expected])
    assert view.available("laser").tolist() == [row != 0 for row in expected]


def test_a_union_stands_in_order() -> None:
    whole = concatenate([stored(2), stored(3, missing=(2,))])
    assert len(whole) == 5
    assert whole.available("laser").tolist() == [True, True, True, True, False]
    assert whole.scores("vision").values[2].tolist() == [0, 1, 2, 3, 4]


def test_what_does_not_fit_is_not_joined() -> None:
    other = StoredEvidence({"vision": Scores(np.zeros((1, 5)), Probabilities(CLASSES))})
    alone = StoredEvidence({"vision": Scores(np.zeros((1, 5)), OneAgainstAll(CLASSES))})
    with pytest.raises(UsageError, match="cues vision, laser cannot be joined to evidence of vis"):
        concatenate([stored(), alone])
    with pytest.raises(UsageError, match=r"'vision' are OneAgainstAll.*Probabilities"):
        concatenate([alone, other])
    with pytest.raises(UsageError, match="no evidence to concatenate"):
        concatenate([])


def test_what_a_view_computes_the_whole_knows(fitted: Pipeline) -> None:
    walk = [Walk(seed=1).at(number) for number in range(6)]
    evidence = ObservedEvidence(walk, fitted.cues)
    view = evidence.take([4, 1]).take([1])
    found = view.scores("beams").values
    assert evidence.used(1) == ("beams",)
    assert evidence.used(4) == ()
    fresh = ObservedEvidence(walk, fitted.cues).scores("beams").values
    np.testing.assert_allclose(found, fresh[[1]], rtol=0, atol=1e-9)


class Counted(Beams):
    """Counts its extractions."""

    calls = 0

    def extract(self, observation: Observation) -> np.ndarray:
        Counted.calls += 1
        return super().extract(observation)


def test_each_part_is_computed_once() -> None:
    cues = {"beams": (Counted(), SVM(RBF(0.1)))}
    fitted = Pipeline(cues).fit(Walk())
    walk = [Walk(seed=1).at(number) for number in range(6)]
    evidence = ObservedEvidence(walk, fitted.cues)
    Counted.calls = 0
    evidence.take([1, 3]).scores("beams")
    evidence.scores("beams")
    evidence.scores("beams")
    assert Counted.calls == 6


def test_gaps_of_observed_evidence(fitted: Pipeline) -> None:
    walk = [Walk(seed=1).at(number) for number in range(4)]
    blind = LaserScan(np.zeros(6), np.full(6, np.nan), 0.0, 20.0)
    walk[1] = Observation(SECOND, image=walk[1].image, scan=blind)  # nothing valid in it
    walk[2] = Observation(SECOND, image=walk[2].image)  # no scan
    evidence = ObservedEvidence(walk, fitted.cues)
    # Before anything is extracted it is the parts that tell.
    assert evidence.available("beams").tolist() == [True, True, False, True]
    values = evidence.scores("beams").values
    assert evidence.available("beams").tolist() == [True, False, False, True]
    assert np.isnan(values[[1, 2]]).all()
    assert np.isfinite(values[[0, 3]]).all()
    assert "none of the 6 beams" in str(evidence.reason(1))
    assert "no scan" in str(evidence.reason(2))


class Watchful(SVM):
    """Never sees a gap."""

    def scores(self, features):  # type: ignore[no-untyped-def]
        assert np.isfinite(features).all()
        return super().scores(features)


def test_a_gap_never_reaches_a_model() -> None:
    evidence, labels = stored(40), np.repeat(np.array(CLASSES), 8)
    das = SVMDAS(Watchful(RBF(0.1))).fit(evidence, labels)
    gaps = stored(40, missing=(0, 7, 39))
    found = das.integrate(gaps)
    assert found.available().sum() == 37
    assert not found.available()[[0, 7, 39]].any()
    rest = np.setdiff1d(np.arange(40), [0, 7, 39])
    expected = das.integrate(evidence.take(rest)).values
    assert np.array_equal(found.values[rest], expected)
    again = SVMDAS(Watchful(RBF(0.1))).fit(gaps, labels)
    plain = SVMDAS(Watchful(RBF(0.1))).fit(evidence.take(rest), labels[rest])
    assert np.array_equal(again.integrate(evidence).values, plain.integrate(evidence).values)
