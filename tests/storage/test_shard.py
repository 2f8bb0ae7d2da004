"""What two processes write of the same observations into one file."""

from pathlib import Path

import numpy as np

from placecue.storage.shard import Entry, Shard


def entry(stamp: int, value: float) -> Entry:
    return Entry(stamp, np.array([value, 1.0]))


def stored(path: Path) -> dict[int, float | str]:
    """What a third process finds: the first feature, or why there is none."""
    entries = Shard(path).entries
    return {
        number: each.reason if each.features is None else float(each.features[0])
        for number, each in entries.items()
    }


def test_what_another_process_has_written_stays(tmp_path: Path) -> None:
    path = tmp_path / "000000.npz"
    ours, theirs = Shard(path), Shard(path)  # both open the file before either writes
    theirs.keep(7, entry(70, 7.5))
    theirs.keep(3, Entry(30, None, "no scan"))
    theirs.save()
    ours.keep(5, entry(50, 5.5))
    ours.save()
    assert list(stored(path).items()) == [(3, "no scan"), (5, 5.5), (7, 7.5)]
    theirs.keep(1, entry(10, 1.5))
    theirs.save()
    assert list(stored(path)) == [1, 3, 5, 7]


def test_of_one_observation_that_both_have_the_last_written_counts(tmp_path: Path) -> None:
    path = tmp_path / "000000.npz"
    ours, theirs = Shard(path), Shard(path)
    theirs.keep(4, entry(40, 1.0))
    theirs.keep(5, entry(50, 2.0))
    theirs.save()
    # Such as of another log of the same digest: the stamps tell them apart.
    ours.keep(5, entry(51, 3.0))
    ours.save()
    assert stored(path) == {4: 1.0, 5: 3.0}
    assert {number: each.stamp for number, each in Shard(path).entries.items()} == {4: 40, 5: 51}
