"""Folds keep classes whole in training and neighbours together."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from sklearn.base import clone

from placecue import (
    Blocks,
    ByLog,
    DataError,
    FoldScheme,
    InterleavedChunks,
    Shuffled,
    UsageError,
)

SECOND = 1_000_000_000


def test_chunks_are_dealt_in_turn_within_each_class() -> None:
    # 5 Hz, 10 s of a class is two chunks of 5 s; then 10 s of another.
    labels = np.repeat(["a", "b"], 50)
    stamps = np.arange(100) * SECOND // 5
    fold = InterleavedChunks(n_folds=5, seconds=5.0).assign(labels, stamps)
    assert fold.tolist() == [0] * 25 + [1] * 25 + [0] * 25 + [1] * 25


def test_a_chunk_ends_where_the_robot_left_the_class() -> None:
    labels = np.array(["a"] * 5 + ["b"] * 50 + ["a"] * 5)
    stamps = np.arange(60) * SECOND // 5
    fold = InterleavedChunks(n_folds=5, seconds=5.0).assign(labels, stamps)
    assert fold[:5].tolist() == [0] * 5
    assert fold[-5:].tolist() == [1] * 5


def test_a_chunk_ends_at_a_new_log() -> None:
    labels = np.repeat("a", 10)
    stamps = np.concatenate([np.arange(5), np.arange(5)]) * SECOND // 5
    fold = InterleavedChunks().assign(labels, stamps)
    assert fold.tolist() == [0] * 5 + [1] * 5


@pytest.mark.parametrize("scheme", [InterleavedChunks(), Blocks(), Shuffled()])
@given(labels=st.lists(st.sampled_from("abcd"), min_size=8, max_size=120))
def test_every_class_is_in_training_and_no_sample_twice_held_out(scheme, labels) -> None:  # type: ignore[no-untyped-def]
    labels = np.array(labels + list("aabbccdd"))
    seen: list[int] = []
    for training, held_out in scheme.split(labels):
        assert set(labels[training]) == set(labels)
        assert not set(training) & set(held_out)
        seen += held_out.tolist()
    assert len(seen) == len(set(seen))


def test_a_class_of_one_sample_is_named() -> None:
    with pytest.raises(DataError, match="class 'attic' has one sample"):
        list(InterleavedChunks().split(np.array(["a", "a", "attic"])))


def test_shuffled_folds_are_even_within_each_class() -> None:
    labels = np.repeat(["a", "b", "c", "d"], [10, 20, 35, 5])
    fold = Shuffled(n_folds=5, seed=1).assign(labels)
    for name, size in (("a", 2), ("b", 4), ("c", 7), ("d", 1)):
        assert np.bincount(fold[labels == name]).tolist() == [size] * 5
    assert (fold == Shuffled(n_folds=5, seed=1).assign(labels)).all()
    assert (fold != Shuffled(n_folds=5, seed=2).assign(labels)).any()


def three_logs() -> tuple[np.ndarray, np.ndarray]:
    """Five samples of four classes each; the second log is later by an hour, the third earlier."""
    labels = np.tile(np.repeat(["a", "b", "c", "d"], 5), 3)
    times = np.arange(20) * SECOND // 5
    return labels, np.concatenate([times, times + 3600 * SECOND, times - 60 * SECOND])


def test_by_log_holds_out_each_log_in_turn() -> None:
    labels, stamps = three_logs()
    held_out = [h.tolist() for _, h in ByLog().split(labels, stamps)]
    assert held_out == [list(range(20)), list(range(20, 40)), list(range(40, 60))]
    assert len(list(ByLog(n_folds=2).split(labels, stamps))) == 2


def test_by_log_trains_on_the_first_and_tests_on_the_second() -> None:
    labels, stamps = three_logs()
    ((training, held_out),) = ByLog(only_last=True).split(labels[:40], stamps[:40])
    assert training.tolist() == list(range(20))
    assert held_out.tolist() == list(range(20, 40))


def test_by_log_needs_two_logs() -> None:
    with pytest.raises(DataError, match="need two logs or more, and the 20 samples look like one"):
        list(ByLog().split(*(each[:20] for each in three_logs())))


def test_fewer_samples_than_folds_give_fewer_folds() -> None:
    labels = np.array(["a", "a", "b", "b", "c", "c", "d", "d"])
    for scheme in (Blocks(), Shuffled(), InterleavedChunks()):
        splits = list(scheme.split(labels))
        assert 1 <= len(splits) < 5
        assert all(set(labels[training]) == set("abcd") for training, _ in splits)


def test_folds_that_hold_nothing_out_are_an_error() -> None:
    labels = np.repeat(["a", "b", "c", "d"], 5)
    stamps = np.arange(20) * SECOND // 5 + np.repeat([0, 100, 200, 300], 5) * SECOND
    with pytest.raises(DataError, match="none of the 20 samples can be held out"):
        list(ByLog().split(labels, stamps))


@pytest.mark.parametrize("scheme", [InterleavedChunks(seconds=1.0), Blocks(), Shuffled()])
def test_copies_of_one_moment_are_not_parted(scheme: FoldScheme) -> None:
    labels = np.repeat(["a", "b", "c", "d"], [33, 21, 9, 60])  # every moment three times
    stamps = np.repeat(np.arange(41), 3) * SECOND
    fold = scheme.assign(labels, stamps).reshape(41, 3)
    assert (fold == fold[:, :1]).all()
    assert set(fold[:11, 0]) == set(range(5))
    once = scheme.assign(labels[::3], stamps[::3])
    assert (fold[:, 0] == once).all()


def test_samples_without_time_between_them_are_still_cut() -> None:
    labels = np.repeat(["a", "b", "c", "d"], 10)
    for scheme in (Blocks(), Shuffled()):
        fold = scheme.assign(labels, np.zeros(40, dtype=np.int64))
        assert np.bincount(fold).tolist() == [8] * 5


def test_by_log_begins_another_log_where_the_group_changes() -> None:
    # Two logs recorded one right after the other: neither time nor silence tells them apart.
    labels = np.tile(np.repeat(["a", "b", "c", "d"], 5), 2)
    stamps = np.arange(40) * SECOND // 5
    groups = np.repeat([7, 3], 20)
    with pytest.raises(DataError, match="look like one"):
        list(ByLog().split(labels, stamps))
    held_out = [h.tolist() for _, h in ByLog().split(labels, stamps, groups)]
    assert held_out == [list(range(20)), list(range(20, 40))]
    # Time still tells, within a group as well.
    assert len(list(ByLog().split(*three_logs(), np.zeros(60, dtype=int)))) == 3


class Alternating(FoldScheme):
    """One's own scheme, as a plugin would bring it."""

    def assign(
        self, labels: ArrayLike, stamps: ArrayLike | None = None, groups: ArrayLike | None = None
    ) -> np.ndarray:
        return np.arange(len(np.asarray(labels))) % self.n_folds


def test_one_s_own_scheme_needs_to_say_no_more_than_which_fold() -> None:
    labels = np.repeat(["a", "b", "c", "d"], 4)
    held_out = [each.tolist() for _, each in Alternating(n_folds=2).split(labels)]
    assert held_out == [list(range(0, 16, 2)), list(range(1, 16, 2))]
    assert clone(Alternating(n_folds=2)).get_params() == {"n_folds": 2}


@pytest.mark.parametrize(
    ("scheme", "message"),
    [
        (Blocks(n_folds=1), r"folds\.n_folds must be 2 or more, got 1"),
        (Shuffled(n_folds=2.5), r"folds\.n_folds must be 2 or more, got 2.5"),  # type: ignore[arg-type]
        (InterleavedChunks(seconds=0), r"folds\.seconds must be above 0, got 0"),
        (InterleavedChunks(n_folds=0), r"folds\.n_folds must be 2 or more, got 0"),
        (ByLog(gap=-1), r"folds\.gap must be above 0, got -1"),
    ],
)
def test_wrong_parameters_are_named_when_they_are_used(scheme: FoldScheme, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        list(scheme.split(*three_logs()))
