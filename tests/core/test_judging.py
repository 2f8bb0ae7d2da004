"""What is said of unseen samples comes from nothing that has seen them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from placecue import Evidence, FeatureBatch, Observation, Pipeline, Scores, Unknown
from placecue.errors import ComponentError
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import PLACES, SECOND, Beams, Walk

SEARCH = {"C": [1, 10], "gamma": [0.1, 1.0]}


class Labelled(Walk):
    """A walk whose labels say nothing of the place: drawn at random, a chunk at a time."""

    def __iter__(self) -> Iterator[Observation]:
        generator = np.random.default_rng(1000 + self.seed)
        for observation in super().__iter__():
            yield observation.relabelled(PLACES[generator.integers(4)])


def two_cues() -> Pipeline:
    cues = {
        "beams": (Beams(4), SVM(RBF(), search=SEARCH)),
        "few": (Beams(2), SVM(RBF(), search=SEARCH, multiclass="oao")),
    }
    return Pipeline(cues, SVMDAS(SVM(RBF(), search=SEARCH)), unknown=Unknown(0.1))


@pytest.mark.parametrize("integration", [False, True], ids=["out of fold", "another log"])
def test_random_labels_come_out_at_chance(integration: bool) -> None:
    shares = []
    for seed in range(2):
        other = Labelled(rounds=2, seed=seed + 50) if integration else None
        trained = two_cues().fit(Labelled(rounds=3, seed=seed), other)
        assert trained.judged_ is not None
        right = np.concatenate([each.decisions()[1] for each in trained.judged_])
        shares.append(right.mean())
        assert trained.rejection_ is not None
        assert trained.rejection_.n_right == right.sum()
    # 480 or 320 decisions: a standard deviation of 2 or 2.4 points.
    assert np.mean(shares) == pytest.approx(0.25, abs=0.05)


def test_copies_see_nothing_of_what_they_are_judged_on() -> None:
    seen: list[tuple[str, set[int]]] = []

    class Watched(SVM):
        def train(self, training):  # type: ignore[no-untyped-def]
            seen.append(("classifier", set(np.asarray(training.stamps).tolist())))
            return super().train(training)

    class WatchedDAS(SVMDAS):
        def train(self, held_out):  # type: ignore[no-untyped-def]
            if len(held_out.evidence.cues) > 1:  # and not a copy for where one is missing
                seen.append(("integrator", set(np.asarray(held_out.stamps).tolist())))
            return super().train(held_out)

    cues = {"beams": (Beams(), Watched(RBF(0.1))), "few": (Beams(2), Watched(RBF(0.1)))}
    trained = Pipeline(cues, WatchedDAS(SVM(RBF(0.3))), unknown=Unknown(0.1)).fit(Walk())
    everything = {each.stamp for each in Walk()}
    assert [kind for kind, _ in seen] == ["classifier", "classifier", "integrator"] * 6
    assert all(stamps == everything for _, stamps in seen[:3])
    assert trained.judged_ is not None
    judged: set[int] = set()
    for number in range(5):
        of_fold = seen[3 * (number + 1) : 3 * (number + 2)]
        known = set.union(*(stamps for _, stamps in of_fold))
        part = len(trained.judged_[number].labels)
        assert len(known) == len(everything) - part
        judged |= everything - known
    assert judged == everything


def test_another_sequence_is_judged_by_copies_of_the_integrator_alone() -> None:
    searched: list[object] = []

    class Watched(SVMDAS):
        def train(self, held_out):  # type: ignore[no-untyped-def]
            searched.append((self.classifier.search, len(held_out), held_out.evidence.cues))
            return super().train(held_out)

    cues = {"beams": (Beams(), SVM(RBF(0.1))), "few": (Beams(2), SVM(RBF(0.1)))}
    das = Watched(SVM(RBF(), search=SEARCH))
    trained = Pipeline(cues, das, unknown=Unknown(0.1)).fit(Walk(), Walk(seed=2))
    # The whole, then five folds, each with a search of its own, for every set of cues.
    sets = [("beams", "few"), ("beams",), ("few",)]
    assert searched[:3] == [(SEARCH, 320, cues) for cues in sets]
    assert [each[2] for each in searched] == sets * 6
    assert [each[0] for each in searched] == [SEARCH] * 18
    assert sum(320 - each[1] for each in searched[3::3]) == 320
    assert trained.rejection_ is not None
    assert trained.rejection_.n_right + trained.rejection_.n_wrong == 320


class Broken(SVMDAS):
    """Does not integrate."""

    def integrate(self, evidence: Evidence) -> Scores:
        raise ZeroDivisionError("nothing to divide by")


class Short(SVMDAS):
    """Returns a row too few."""

    def integrate(self, evidence: Evidence) -> Scores:
        return super().integrate(evidence)[:-1]


@pytest.mark.parametrize("integration", [None, Walk(rounds=2, seed=2)])
@pytest.mark.parametrize("kind", [Broken, Short])
def test_a_judged_integrator_is_guarded(kind: type[SVMDAS], integration: Walk | None) -> None:
    cues = {"beams": (Beams(), SVM(RBF(0.1))), "few": (Beams(2), SVM(RBF(0.1)))}
    pipeline = Pipeline(cues, kind(SVM(RBF(0.3))), unknown=Unknown(0.1))
    with pytest.raises(ComponentError, match=f"^integrator {kind.__name__} .*integrate"):
        pipeline.fit(Walk(rounds=2), integration)


class Moody(SVM):
    """Fails at scans that begin far away."""

    def scores(self, features: FeatureBatch) -> Scores:
        if np.any(np.asarray(features)[:, 0] > 5.2):
            raise ZeroDivisionError("too far")
        return super().scores(features)


def test_samples_at_which_a_classifier_fails_are_not_judged() -> None:
    pipeline = Pipeline({"beams": (Beams(), Moody(RBF(0.1)))}, unknown=Unknown(0.1))
    with pytest.raises(ComponentError, match="too far"):
        pipeline.fit(Walk(rounds=2))
    pipeline.on_error = "skip"
    pipeline.fit(Walk(rounds=2))
    assert pipeline.judged_ is not None
    told = sum(len(each.decisions()[0]) for each in pipeline.judged_)
    far = sum(bool(each.scan.filled()[0] > 5.2) for each in Walk(rounds=2) if each.scan)
    assert 0 < far < 40
    assert told == 160 - far


def test_stamps_reach_the_integrator_s_folds() -> None:
    """The search inside SVM-DAS cuts along the stamps: a chunk of 2 s is never parted."""
    cut: list[np.ndarray] = []

    class Watched(SVM):
        def train(self, training):  # type: ignore[no-untyped-def]
            cut.extend(held_out for _, held_out in training.split())
            return super().train(training)

    cues = {"beams": (Beams(), SVM(RBF(0.1))), "few": (Beams(2), SVM(RBF(0.1)))}
    Pipeline(cues, SVMDAS(Watched(RBF(0.3)))).fit(Walk())
    stamps = np.array([each.stamp for each in Walk()])
    assert len(cut) == 5 * 3  # for both cues, and for each where the other is missing
    for held_out in cut:
        chunks = np.unique(stamps[held_out] // (2 * SECOND))
        assert len(held_out) == 10 * len(chunks)  # 2 s at 5 Hz
