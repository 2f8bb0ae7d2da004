"""Folds by log where a part of the samples, as of two logs, is of one log only."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from placecue import ByLog, Classifier, InterleavedChunks, Observation, Pipeline, Unknown
from placecue.training_set import TrainingSet
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import SECOND, Beams, Walk

SEARCH = {"C": [1, 100], "gamma": [0.1, 1.0]}
LATER = 1000 * SECOND


def logs(*seeds: int) -> list[Observation]:
    """Return the observations of walks that lie far apart in time."""
    return [
        Observation(each.stamp + number * LATER, scan=each.scan, label=each.label)
        for number, seed in enumerate(seeds)
        for each in Walk(rounds=2, stay=6, seed=seed)
    ]


def searching() -> SVM:
    return SVM(RBF(), search=SEARCH)


def likely() -> SVM:
    return SVM(RBF(0.1), probability="sigmoid")


def own_folds() -> SVM:
    return SVM(RBF(), search=SEARCH, folds=ByLog())


def last_left() -> SVM:
    return SVM(RBF(), search=SEARCH, refit=False)


@pytest.mark.parametrize(
    ("folds", "classifier"),
    [
        (ByLog(), searching),
        (ByLog(), likely),
        (ByLog(), own_folds),
        (ByLog(only_last=True), searching),
        (ByLog(only_last=True), last_left),
    ],
)
def test_each_of_two_logs_is_judged_by_what_the_other_taught(
    folds: ByLog, classifier: Callable[[], Classifier]
) -> None:
    cues = {"beams": (Beams(), classifier()), "few": (Beams(2), classifier())}
    pipeline = Pipeline(cues, SVMDAS(searching()), folds, Unknown(0.1)).fit(logs(1, 2))
    assert pipeline.judged_ is not None
    assert [len(each.labels) for each in pipeline.judged_] == (
        [48] if folds.only_last else [48] * 2
    )
    assert pipeline.rejection_ is not None


def test_an_integration_log_may_be_one() -> None:
    cues = {"beams": (Beams(), searching()), "few": (Beams(2), searching())}
    pipeline = Pipeline(cues, SVMDAS(searching()), ByLog(), Unknown(0.1))
    pipeline.fit(logs(1, 2), logs(3))
    assert pipeline.held_out_ is not None
    assert len(pipeline.held_out_) == 48


def test_a_part_is_cut_by_log_as_long_as_it_can_be() -> None:
    labels = np.array(["a", "b"] * 6)
    training = TrainingSet(np.zeros((12, 1)), labels, groups=np.repeat([0, 1, 2], 4), folds=ByLog())
    two, one = training.take(np.arange(8)), training.take(np.arange(4))
    assert [held_out.tolist() for _, held_out in two.split()] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    chunks = InterleavedChunks().split(labels[:4])
    for (_, ours), (_, theirs) in zip(one.split(), chunks, strict=True):
        np.testing.assert_array_equal(ours, theirs)
