"""Labels that stand beside a log: a CSV of intervals."""

from __future__ import annotations

import csv
import logging
from bisect import bisect_right
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from decimal import Decimal, InvalidOperation
from itertools import pairwise
from pathlib import Path

from placecue.errors import DataError
from placecue.limits import current_limits

log = logging.getLogger(__name__)

COLUMNS = ("start", "end", "label")
#: A further column, of what a model says; a line of it may be left without a label.
SUGGESTED = "suggested"
#: A number without a point that is at least this large is nanoseconds, anything else seconds.
NANOSECONDS_FROM = 10**14
#: Times have at most so many digits before the point; to write out more can take forever.
DIGITS = 25
#: The first line is no longer, letters.
LONGEST = 10_000
#: Letters of a cell that are shown.
SHOWN = 60
#: Clocks that are so far apart, ns, are not the same.
YEAR = 365 * 86_400 * 10**9


@dataclass(frozen=True, slots=True)
class Intervals:
    """Labels by interval of time, start included, end not.

    Parameters
    ----------
    starts, ends : tuple of int
        Stamps, ns, in order; intervals do not overlap.
    labels : tuple of str
        One an interval.
    path : str
        Where they were read, for messages.
    """

    starts: tuple[int, ...]
    ends: tuple[int, ...]
    labels: tuple[str, ...]
    path: str = field(default="the labels", repr=False)

    def at(self, stamp: int) -> str | None:
        """Return the label at a time, or None."""
        row = bisect_right(self.starts, stamp) - 1
        return self.labels[row] if row >= 0 and stamp < self.ends[row] else None

    def meets(self, start: int, end: int) -> bool:
        """Tell whether an interval has a part within a span of time, ns."""
        pairs = zip(self.starts, self.ends, strict=True)
        return any(first <= end and last > start for first, last in pairs)

    def check_clock(self, first: int, length: int, log_name: str) -> None:
        """Refuse labels whose times can only be of another clock, or in another unit.

        Parameters
        ----------
        first : int
            Stamp of the first observation of a log, ns.
        length : int
            How long the log is, ns.
        log_name : str
            The log, for messages.

        Raises
        ------
        DataError
            If the intervals are more than a year away from the log.
        """
        if self.starts[0] - (first + length) > YEAR or first - max(self.ends) > YEAR:
            raise DataError(self.apart(first, first + length, log_name))

    def tell_apart(self, seen: Seen, log_name: str) -> None:
        """Warn where no observation of a log lies in an interval."""
        if not len(seen) or self.meets(seen.first, seen.last):
            return
        log.warning(self.apart(seen.first, seen.last, log_name))

    def apart(self, first: int, last: int, log_name: str) -> str:
        """Say that no interval meets a log, whose observations are ``first`` to ``last``, ns."""
        own = _span(self.starts[0], max(self.ends))
        return (
            f"the intervals of {self.path} never meet the log: they span {own}, and {log_name} "
            f"spans {_span(first, last)}; give times on the log's own clock, in seconds "
            "(1700000000.25), nanoseconds or ISO 8601"
        )

    @classmethod
    def from_csv(cls, path: str | Path) -> Intervals:
        """Read a file with the columns ``start``, ``end`` and ``label``, named in its first line.

        Cells are separated by commas, or by semicolons or tabs as spreadsheets of many languages
        write them, with decimal commas. Times are seconds (``1700000000.25``), nanoseconds (whole
        numbers of 10^14 and more) or ISO 8601 (UTC where no zone is given), on the clock of the
        log's stamps.

        Raises
        ------
        DataError
            If the file cannot be read, a column is missing, a line makes no sense, or intervals
            overlap; the message names the line.
        """
        try:
            with Path(path).open(newline="", encoding="utf-8-sig") as file:
                cut = _delimiter(file.readline(LONGEST))
                file.seek(0)
                rows = csv.DictReader(file, skipinitialspace=True, delimiter=cut)
                names = [name.strip() for name in rows.fieldnames or []]
                rows.fieldnames = names
                missing = [column for column in COLUMNS if column not in names]
                if missing:
                    raise DataError(
                        f"{path}: the first line must name the columns start,end,label; it has "
                        f"{_short(','.join(names)) or 'nothing'}"
                    )
                found = []
                for row in rows:
                    if over := current_limits().over("rows", rows.line_num):
                        raise DataError(f"{path} has {rows.line_num} rows, {over}")
                    if cut != ",":
                        times = {each: (row[each] or "").replace(",", ".") for each in COLUMNS[:2]}
                        row |= times
                    if not _left_open(row):
                        found.append(_interval(row, f"{path}, line {rows.line_num}"))
        except UnicodeDecodeError as error:
            raise DataError(f"the labels {path} are no UTF-8 text: save them as UTF-8") from error
        except (OSError, csv.Error) as error:
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
        return cls(starts, ends, labels, str(path))


def _delimiter(header: str) -> str:
    return next((each for each in ",;\t" if each in header), ",")


class Seen:
    """The first and last stamp of the observations seen so far, ns."""

    def __init__(self) -> None:
        self.first = self.last = 0
        self._count = 0

    def add(self, stamp: int) -> None:
        """Take in an observation."""
        self.first = min(self.first, stamp) if self._count else stamp
        self.last = max(self.last, stamp) if self._count else stamp
        self._count += 1

    def __len__(self) -> int:
        return self._count


def _span(first: int, last: int) -> str:
    return f"{_shown(first)} to {_shown(last)}"


def _shown(stamp: int) -> str:
    """Return a time in seconds, and as a date where it is one of our days."""
    text = f"{stamp * 1e-9:.3f}"
    if not YEAR < stamp < 2**63:
        return f"{text} s"
    date = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(microseconds=stamp // 1000)
    return f"{text} s ({date:%Y-%m-%d %H:%M:%S} UTC)"


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


def _short(text: str) -> str:
    """Return the beginning of a text, in one line."""
    line = " ".join(text.split())
    return line if len(line) <= SHOWN else f"{line[:SHOWN]} ..."


def _nanoseconds(text: str | None, where: str) -> int:
    text = (text or "").strip()
    try:
        number = Decimal(text)
        if number.is_finite() and number.adjusted() > DIGITS:
            raise DataError(f"{where}: '{_short(text)}' is no time: it lies beyond the year 2262")
        whole = "." not in text and "e" not in text.lower()
        return int(number) if whole and number >= NANOSECONDS_FROM else int(number * 10**9)
    except (InvalidOperation, OverflowError, ValueError):
        pass
    try:
        time = datetime.fromisoformat(text)
    except ValueError as error:
        raise DataError(
            f"{where}: '{_short(text)}' is not a time; give seconds, nanoseconds or ISO 8601"
        ) from error
    time = time if time.tzinfo else time.replace(tzinfo=UTC)
    since = time - datetime(1970, 1, 1, tzinfo=UTC)
    return (since.days * 86400 + since.seconds) * 10**9 + since.microseconds * 1000
