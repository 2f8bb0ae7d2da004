"""Text files with one record a line, looked up by time."""

from __future__ import annotations

import codecs
import zlib
from array import array
from collections.abc import Callable, Iterator, Sequence
from gzip import GzipFile
from tarfile import TarError
from typing import IO

import numpy as np
from numpy.typing import NDArray

from placecue.faults import Faults
from placecue.observation import Pose2D
from placecue_sources import stamps

Fields = Sequence[bytes]

#: Longer lines come in pieces, so that a file without lines fills no memory.
LONGEST_LINE = 1 << 20
#: Fields in which the time is looked for.
HEAD = 6


def words(line: bytes, most: int = -1) -> list[bytes]:
    """Return the fields of a line, which blanks or commas separate."""
    return line.replace(b",", b" ").split(None, most)


class TextRecords:
    """The lines of a file in order of time. Only times and positions are held.

    Lines without a time are counted and left out, but for one that names the columns; so are
    lines with the time of an earlier one. Lines out of order are sorted.

    Parameters
    ----------
    file : binary file
        Open as long as records are read.
    name : str
        What to call it in messages.
    stamp : callable
        Gives the time of a line, ns, from its first fields, or raises ValueError or IndexError.
    faults : Faults
        Takes what goes wrong.

    Attributes
    ----------
    stamps : ndarray of int64, shape (n,)
        Times, ns, increasing.
    """

    def __init__(
        self, file: IO[bytes] | GzipFile, name: str, stamp: Callable[[Fields], int], faults: Faults
    ) -> None:
        self.file = file
        self.name = name
        self.faults = faults
        times, starts = array("q"), array("q")
        for number, start, line in self._lines():
            try:
                time = stamp(words(line, HEAD))
                times.append(time)
                starts.append(start)
            except (ValueError, IndexError, ArithmeticError) as error:
                if number > 1 or not _names_columns(line):
                    self._broken(f"{name}, line {number}: {error or 'too short'}")
        found = np.array(times, dtype=np.int64)
        self._count_disorder(found)
        self.stamps, first = np.unique(found, return_index=True)
        self._starts = np.array(starts, dtype=np.int64)[first]

    def __len__(self) -> int:
        return self.stamps.size

    def fields(self, index: int) -> list[bytes]:
        """Return the fields of a record, read anew."""
        self.file.seek(int(self._starts[index]))
        return words(self.file.readline(LONGEST_LINE))

    def nearest(self, stamp: int, tolerance: int) -> int | None:
        """Return the record nearest to a time, or None if none is near enough (ns)."""
        return stamps.nearest(self.stamps, stamp, tolerance)

    def _lines(self) -> Iterator[tuple[int, int, bytes]]:
        """Yield the lines that hold something: number, position, content."""
        number = start = 0
        try:
            while line := self.file.readline(LONGEST_LINE):
                number += 1
                content = line.removeprefix(codecs.BOM_UTF8) if number == 1 else line
                if content.strip() and not content.startswith((b"#", b"%")):
                    yield number, start + len(line) - len(content), content
                start += len(line)
        except (OSError, EOFError, TarError, zlib.error) as error:
            self.faults.add(
                "files are cut or damaged; used up to there",
                f"{self.name} after line {number}: {error}",
            )

    def _broken(self, example: str) -> None:
        self.faults.add("lines do not parse and were left out", example)

    def _count_disorder(self, found: NDArray[np.int64]) -> None:
        late = int(np.sum(found[1:] < np.maximum.accumulate(found)[:-1])) if found.size else 0
        self.faults.add("lines out of order of time were sorted", self.name, late)
        repeated = found.size - np.unique(found).size
        self.faults.add("lines repeat the time of another and were left out", self.name, repeated)


class PoseTrack:
    """Poses in order of time, interpolated between.

    Parameters
    ----------
    records : TextRecords
        One pose a line.
    pose : callable
        Gives x (m), y (m) and heading (rad) from the fields of a line, or raises ValueError or
        IndexError.
    frame : str
        The frame that the poses are given in.
    """

    def __init__(
        self,
        records: TextRecords,
        pose: Callable[[Fields], tuple[float, float, float]],
        frame: str,
    ) -> None:
        self.frame = frame
        times, values = array("q"), array("d")
        for index, time in enumerate(records.stamps):
            try:
                here = pose(records.fields(index))
                if not np.isfinite(here).all():
                    raise ValueError(f"the pose {here} is not finite")
            except (ValueError, IndexError) as error:
                records.faults.add(
                    "poses do not parse and were left out", f"{records.name}: {error}"
                )
                continue
            times.append(int(time))
            values.extend(here)
        self.stamps = np.array(times, dtype=np.int64)
        poses = np.array(values, dtype=np.float64).reshape(-1, 3)
        self._columns = (poses[:, 0], poses[:, 1], np.unwrap(poses[:, 2]))

    def at(self, stamp: int, tolerance: int) -> Pose2D | None:
        """Return the pose at a time, or None if none was recorded near enough (ns)."""
        if stamps.nearest(self.stamps, stamp, tolerance) is None:
            return None
        times = self.stamps - stamp
        x, y, theta = (float(np.interp(0.0, times, column)) for column in self._columns)
        return Pose2D(x, y, theta, self.frame)


def _names_columns(line: bytes) -> bool:
    """Tell whether a line begins with words, as one that names the columns does."""
    return any(word[:1].isalpha() for word in words(line, 2)[:2])
