"""Labels that stand beside a log: a CSV of intervals."""

from __future__ import annotations

import csv
from bisect import bisect_right
from dataclasses import dataclass
from datetime import UTC, datetime
from decimal import Decimal, InvalidOperation
from itertools import pairwise
from pathlib import Path

from placecue.errors import DataError

COLUMNS = ("start", "end", "label")
#: A further column, of what a model says; a line of it may be left without a label.
SUGGESTED = "suggested"
#: A number without a point that is at least this large is nanoseconds, anything else seconds.
NANOSECONDS_FROM = 10**14


@dataclass(frozen=True, slots=True)
class Intervals:
    """Labels by interval of time, start included, end not.

    Parameters
    ----------
    starts, ends : tuple of int
        Stamps, ns, in order; intervals do not overlap.
    labels : tuple of str
        One an interval.
    """

    starts: tuple[int, ...]
    ends: tuple[int, ...]
    labels: tuple[str, ...]

    def at(self, stamp: int) -> str | None:
        """Return the label at a time, or None."""
        row = bisect_right(self.starts, stamp) - 1
        return self.labels[row] if row >= 0 and stamp < self.ends[row] else None

    @classmethod
    def from_csv(cls, path: str | Path) -> Intervals:
        """Read a file with the columns ``start``, ``end`` and ``label``, named in its first line.

        Times are seconds (``1700000000.25``), nanoseconds (whole numbers of 10^14 and more) or
        ISO 8601 (UTC where no zone is given), on the clock of the log's stamps.

        Raises
        ------
        DataError
            If the file cannot be read, a column is missing, a line makes no sense, or intervals
            overlap; the message names the line.
        """
        try:
            with Path(path).open(newline="", encoding="utf-8-sig") as file:
                rows = csv.DictReader(file, skipinitialspace=True)
                names = [name.strip() for name in rows.fieldnames or []]
                rows.fieldnames = names
                missing = [column for column in COLUMNS if column not in names]
                if missing:
                    raise DataError(
                        f"{path}: the first line must name the columns start,end,label; it has "
                        f"{','.join(names) or 'nothing'}"
                    )
                found = [
                    _interval(row, f"{path}, line {rows.line_num}")
                    for row in rows
                    if not _left_open(row)
                ]
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise DataError(f"cannot read the labels {path}: {error}") from error
        return cls._checked(sorted(found), path)

    @classmethod
    def _checked(cls, found: list[tuple[int, int, str, str]], path: str | Path) -> Intervals:
        if not found:
            raise DataError(f"{path} holds no labels: fill in the column label of a line or more")
        for (_, end, _, _), (start, _, _, line) in pairwise(found):
            if start < end:
                raise DataError(f"{line}: the interval overlaps the one before it in time")
        starts, ends, labels, _ = zip(*found, strict=True)
        return cls(starts, ends, labels)


def _left_open(row: dict[str, str | None]) -> bool:
    """Tell whether a moment that ``placecue suggest`` wrote has been given no label."""
    return SUGGESTED in row and not (row["label"] or "").strip()


def _interval(row: dict[str, str | None], line: str) -> tuple[int, int, str, str]:
    start, end = (_nanoseconds(row[column], f"{line}, {column}") for column in ("start", "end"))
    label = (row["label"] or "").strip()
    if not label:
        raise DataError(f"{line}: no label")
    if end <= start:
        raise DataError(f"{line}: the interval ends at or before its start")
    return start, end, label, line


def _nanoseconds(text: str | None, where: str) -> int:
    text = (text or "").strip()
    try:
        number = Decimal(text)
        whole = "." not in text and "e" not in text.lower()
        return int(number) if whole and number >= NANOSECONDS_FROM else int(number * 10**9)
    except (InvalidOperation, OverflowError, ValueError):
        pass
    try:
        time = datetime.fromisoformat(text)
    except ValueError as error:
        raise DataError(
            f"{where}: '{text}' is not a time; give seconds, nanoseconds or ISO 8601"
        ) from error
    time = time if time.tzinfo else time.replace(tzinfo=UTC)
    since = time - datetime(1970, 1, 1, tzinfo=UTC)
    return (since.days * 86400 + since.seconds) * 10**9 + since.microseconds * 1000
