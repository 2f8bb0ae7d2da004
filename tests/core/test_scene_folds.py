"""Folds of whole scenes: how they are dealt, and that no cut anywhere parts one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from placecue import (
    ByLog,
    DataError,
    FoldScheme,
    InterleavedChunks,
    Observation,
    Pipeline,
    Rows,
    Scenes,
    TrainingSet,
    Unknown,
)
from placecue.folds import cut
from placecue.learning.grouping import groups_of
from placecue.observation import Origin, Recording
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness, Walk


def test_scenes_are_dealt_from_the_largest_to_where_least_of_their_classes_is() -> None:
    # Of a: scenes of 1, 4, 3 and 2 samples; of b: two of 2. By size: a4, a3, a2, b2, b2, a1.
    # a4 to 0, a3 to 1, a2 to 1 (0.4 of a in fold 0, 0.3 in fold 1); no b yet: the first b2 to 0,
    # which has 4 samples where 1 has 5, the second to 1; a1 to 0 (0.4 of a against 0.5).
    groups = np.repeat([7, 3, 9, 1, 2, 8], [1, 4, 3, 2, 2, 2])
    labels = np.repeat(["a", "b"], [10, 4])
    fold = Scenes(2).assign(labels, None, groups)
    expected = np.repeat([0, 0, 1, 1, 0, 1], [1, 4, 3, 2, 2, 2])
    assert fold.tolist() == expected.tolist()


def test_a_scene_of_several_classes_goes_where_least_of_them_is() -> None:
    # Scene 0: 3 a, 1 b. Scene 1: 2 a, 1 b. Scene 2: 1 a, 1 b. Shares of (a, b): 3/6, 2/6, 1/6
    # and 1/3 each. Scene 0 to fold 0, scene 1 to fold 1; scene 2 has 1/6 * 3/6 + 1/9 in common
    # with fold 0 and 1/6 * 2/6 + 1/9 with fold 1.
    labels = np.array([*"aaab", *"aab", *"ab"])
    groups = np.repeat([0, 1, 2], [4, 3, 2])
    assert Scenes(2).assign(labels, None, groups).tolist() == [0] * 4 + [1] * 5


@given(scenes=st.lists(st.integers(0, 9), min_size=12, max_size=80), n_folds=st.integers(2, 5))
def test_no_scene_is_parted_and_every_class_is_trained_on(scenes: list[int], n_folds: int) -> None:
    groups = np.array([*scenes, 10, 10, 11, 11, 12, 12, 13, 13])
    labels = np.array([*"abcd"])[groups % 4]
    labels[-8:] = [*"aabbccdd"]
    seen: list[int] = []
    for training, held_out in Scenes(n_folds).split(labels, groups=groups):
        assert set(labels[training]) == set("abcd")
        whole = {name for name in set(groups[held_out]) if np.isin(name, groups[training])}
        # Only a class that has all its scenes in one fold keeps its part of a scene in training.
        for name in whole:
            alone = set(labels[training][groups[training] == name])
            assert not alone & set(labels[held_out])
        seen += held_out.tolist()
    assert len(seen) == len(set(seen))


def test_a_class_of_one_scene_is_trained_on_in_every_fold_and_never_scored() -> None:
    labels = np.repeat(["a", "a", "b"], 3)
    groups = np.repeat([0, 1, 2], 3)
    splits = list(Scenes(2).split(labels, groups=groups))
    assert len(splits) == 2
    for training, held_out in splits:
        assert set(labels[training]) == {"a", "b"}
        assert set(labels[held_out]) == {"a"}


@pytest.mark.parametrize("groups", [None, np.zeros(20, dtype=int)])
def test_one_scene_cannot_be_cut(groups: ArrayLike | None) -> None:
    with pytest.raises(DataError, match="need two scenes or more, and the 20 samples are of one"):
        list(Scenes().split(np.repeat(["a", "b"], 10), groups=groups))


class Told(FoldScheme):
    """Keeps what it is told of groups; every other pair of samples is held out."""

    told: ClassVar[list[list[int]]] = []

    def assign(
        self, labels: ArrayLike, stamps: ArrayLike | None = None, groups: ArrayLike | None = None
    ) -> np.ndarray:
        self.told.append(np.asarray(groups).tolist())
        return np.arange(len(np.asarray(labels))) // 2 % 2


class ToldLogs(Told):
    keeps = "log"


def test_a_scheme_is_told_scenes_and_one_by_log_the_logs() -> None:
    labels = np.array([*"abababab"])
    logs, scenes = np.repeat([0, 1], 4), np.repeat([0, 1, 2, 3], 2)
    groups = np.column_stack([logs, scenes])
    Told.told.clear()
    for scheme in (Told(2), ToldLogs(2)):
        cut(scheme, labels, None, groups)
        list(scheme.split(labels, None, groups))
    assert Told.told == [scenes.tolist()] * 2 + [logs.tolist()] * 2
    by_log = [held_out.tolist() for _, held_out in ByLog().split(labels, None, groups)]
    assert by_log == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert len(list(Scenes(4).split(labels, None, groups))) == 4


def origins(*logs: str) -> list[Origin | None]:
    return [Origin(Recording(log, log), number) for number, log in enumerate(logs)]


def test_a_scene_is_one_of_its_log() -> None:
    groups = groups_of(origins(*"AAABB"), ["1", "1", "2", "1", None])
    assert groups is not None
    logs, scenes = groups.T
    assert logs.tolist() == [0, 0, 0, 1, 1]
    assert len(set(scenes)) == 4
    assert scenes[0] == scenes[1]


def test_without_scenes_a_group_is_a_log() -> None:
    groups = groups_of(origins(*"BBA"), [None] * 3)
    assert groups is not None
    assert groups.tolist() == [1, 1, 0]
    assert groups_of([None, None], [None, None]) is None


def test_scenes_are_known_where_logs_are_not() -> None:
    groups = groups_of([None] * 3, ["2", "1", "2"])
    assert groups is not None
    assert groups.tolist() == [[0, 1], [0, 0], [0, 1]]


class Watched(Scenes):
    """Keeps the scenes of the rows on both sides of every cut."""

    cuts: ClassVar[list[tuple[set[int], set[int]]]] = []

    def split(
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> Iterator[tuple[Rows, Rows]]:
        scenes = np.asarray(groups)
        for training, held_out in super().split(labels, stamps, groups):
            self.cuts.append((set(scenes[training]), set(scenes[held_out])))
            yield training, held_out


def clips() -> list[Observation]:
    """Return a walk of 24 stays of 4 observations each, in each of which the scene is another."""
    walk = Walk(rounds=6, stay=4)
    return [
        Observation(
            each.stamp, image=each.image, scan=each.scan, label=each.label, scene=f"{n // 4}"
        )
        for n, each in enumerate(walk)
    ]


def searching() -> SVM:
    return SVM(RBF(), search={"C": [1, 100], "gamma": [0.1, 1.0]})


def likely() -> SVM:
    return SVM(RBF(0.1), probability="sigmoid")


@pytest.mark.parametrize("classifier", [searching, likely])
def test_no_cut_of_a_pipeline_parts_a_scene(
    classifier: Callable[[], SVM], monkeypatch: pytest.MonkeyPatch
) -> None:
    def otherwise(self: object, *samples: object) -> None:
        raise AssertionError("cut into chunks")

    monkeypatch.setattr(InterleavedChunks, "split", otherwise)
    Watched.cuts.clear()
    cues = {"beams": (Beams(), classifier()), "brightness": (Brightness(), classifier())}
    pipeline = Pipeline(cues, SVMDAS(searching()), Watched(2), Unknown(0.1)).fit(clips())
    assert pipeline.judged_ is not None
    assert sum(len(each.labels) for each in pipeline.judged_) == 96
    # The outer cut, that for the integrator and those of searches, in copies of it too.
    assert len(Watched.cuts) > 10
    assert {len(training | held_out) for training, held_out in Watched.cuts} >= {24, 12}
    assert not any(training & held_out for training, held_out in Watched.cuts)


def test_folds_that_part_scenes_are_said_once(caplog: pytest.LogCaptureFixture) -> None:
    Pipeline({"beams": (Beams(), SVM(RBF(0.1)))}, None, Scenes(2)).collect(clips())
    assert not caplog.records
    # Stays of 4 at 5 Hz in chunks of 0.4 s: each of the 24 scenes is parted.
    Pipeline({"beams": (Beams(), SVM(RBF(0.1)))}, None, InterleavedChunks(2, 0.4)).collect(clips())
    (record,) = caplog.records
    assert "folds InterleavedChunks part 24 of 24 scenes" in record.message
    caplog.clear()
    Pipeline({"beams": (Beams(), SVM(RBF(0.1)))}, None, ByLog()).collect(clips())
    assert not caplog.records  # of one log; whoever cuts says so


def test_a_training_set_cuts_scenes_of_a_part() -> None:
    labels = np.array([*"aabbaabb"])
    groups = np.column_stack([np.zeros(8, int), np.repeat([0, 1, 2, 3], 2)])
    training = TrainingSet(np.zeros((8, 1)), labels, groups=groups, folds=Scenes(2))
    # The second a goes to where no a is, the second b to where no b is.
    assert [h.tolist() for _, h in training.split()] == [[0, 1, 6, 7], [2, 3, 4, 5]]
    assert [h.tolist() for _, h in training.take(np.arange(2, 8)).split()] == [[0, 1], [4, 5]]
