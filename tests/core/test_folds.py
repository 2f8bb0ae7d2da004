"""Folds keep classes whole in training and neighbours together."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from placecue import Blocks, DataError, InterleavedChunks

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


@pytest.mark.parametrize("scheme", [InterleavedChunks(), Blocks()])
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
