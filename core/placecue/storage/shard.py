"""Features of some dozens of neighbouring observations by one cue, in one file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from placecue.errors import DataError, UnusableObservation
from placecue.features import Features, single, stack
from placecue.storage.arrays import from_parts, parts_of, read_arrays, write_arrays

#: Observations to a file: few enough that a killed run loses a second or so of work.
SIZE = 64


@dataclass(frozen=True, slots=True)
class Entry:
    """What is known of one observation.

    Parameters
    ----------
    stamp : int
        Its time, ns, which tells that it is the same one.
    features : ndarray or csr_array, or None
        None where it was unusable.
    reason : str
        Why it was unusable.
    """

    stamp: int
    features: Features | None
    reason: str = ""

    def unusable(self) -> UnusableObservation:
        """Return why there are no features."""
        return UnusableObservation(self.reason)

    def get(self) -> Features:
        """Return the features, of an observation that was usable."""
        assert self.features is not None
        # A copy: the shard's arrays may then go, and nobody writes into them.
        return self.features.copy()


class Shard:
    """Entries by number of observation, on disk and in memory.

    Parameters
    ----------
    path : Path
        The file; one that is not there or damaged counts as empty.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.entries = _read(path)
        self.changed = False

    def keep(self, number: int, entry: Entry) -> None:
        """Add an entry."""
        self.entries[number] = entry
        self.changed = True

    def save(self) -> None:
        """Write what is new, whole or not at all; what another process has written stays.

        Raises
        ------
        PlacecueError
            If it cannot be written.
        """
        if not self.changed:
            return
        entries = dict(sorted((_read(self.path) | self.entries).items()))
        usable = {n: e.features for n, e in entries.items() if e.features is not None}
        arrays = {
            "numbers": np.array(list(entries), np.int64),
            "stamps": np.array([each.stamp for each in entries.values()], np.int64),
            "usable": np.array([each.features is not None for each in entries.values()]),
            "reasons": np.array([each.reason for each in entries.values()], np.str_),
        }
        what: dict[str, Any] = {}
        if usable:
            taken_apart = parts_of(stack(list(usable.values())))
            if taken_apart is None:
                return  # features of a kind that cannot be kept
            what, parts = taken_apart
            arrays |= {f"features.{name}": array for name, array in parts.items()}
        write_arrays(self.path, {"what": np.array(json.dumps(what)), **arrays})
        self.changed = False


def count(path: Path) -> int:
    """Return the number of entries in a file."""
    try:
        return len(read_arrays(path, ["numbers"])["numbers"])
    except (DataError, TypeError):  # TypeError: a number alone has no length
        return 0


def _read(path: Path) -> dict[int, Entry]:
    try:
        arrays = read_arrays(path)
        what = json.loads(str(arrays["what"]))
        parts = {k.removeprefix("features."): v for k, v in arrays.items() if "features." in k}
        batch = from_parts(what, parts) if what else None
        entries, row = {}, 0
        for number, stamp, usable, reason in zip(
            *(arrays[name].tolist() for name in ("numbers", "stamps", "usable", "reasons")),
            strict=True,
        ):
            features = None
            if usable:
                assert batch is not None
                features = single(batch, row)
                row += 1
            entries[number] = Entry(stamp, features, reason)
        return entries
    except Exception:  # damage has many names; what cannot be read is extracted again
        return {}
