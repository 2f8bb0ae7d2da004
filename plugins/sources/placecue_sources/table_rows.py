"""Rows of a table: the lines of a CSV file, or the names of files taken apart."""

from __future__ import annotations

import csv
import posixpath
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from placecue.errors import DataError, UnusableObservation, UsageError, choices
from placecue.faults import Faults
from placecue_sources import ranges, stamps
from placecue_sources.archive import Archive
from placecue_sources.contents import lines, read_bytes
from placecue_sources.image_files import is_image, natural

#: What a row can say.
KEYS = ("stamp", "image", "scan", "x", "y", "theta", "label", "scene")
SHOWN = 3
#: Letters of the names of columns that are shown.
LISTED = 200


@dataclass(frozen=True, slots=True)
class Row:
    """What a row says.

    Parameters
    ----------
    stamp : int
        Time, ns.
    cells : mapping of str to str
        By the keys of ``KEYS``; what is empty or not there is missing.
    where : str
        Where the row stands, for messages.
    """

    stamp: int
    cells: Mapping[str, str]
    where: str


class Clock:
    """Gives each row its time: what its cell says, or its number at an even rate.

    Parameters
    ----------
    unit : {"s", "ms", "us", "ns", "iso", "none"}
        How times are written; ``none`` numbers the rows.
    rate : float
        Rows a second where they are numbered; the first comes one step after 0.
    """

    def __init__(self, unit: str, rate: float) -> None:
        self.unit = unit
        self.step = 1e9 / rate
        self.number = 0

    def stamp(self, cells: Mapping[str, str], numbered: bool) -> int:
        """Return the time of the next row, ns, or raise ValueError."""
        self.number += 1
        if numbered or self.unit == "none":
            return round(self.number * self.step)
        if "stamp" not in cells:
            raise ValueError("no stamp")
        return stamps.nanoseconds(cells["stamp"], self.unit)


class Places:
    """Says where each key stands among the names of columns or groups, and which rows to read.

    Parameters
    ----------
    columns : mapping of str to str, or None
        Name of the column of each key; None takes the columns that are called like a key.
    where : mapping of str to str, or None
        Columns, and the value that a row must have there.
    """

    def __init__(self, columns: Mapping[str, str] | None, where: Mapping[str, str] | None) -> None:
        self.columns = columns
        self.where = where or {}

    def of_keys(self, names: Sequence[str], origin: str) -> dict[str, int]:
        """Return the place of each key, or raise UsageError where a name is not there.

        Parameters
        ----------
        names : sequence of str
            What columns there are.
        origin : str
            Where they come from, for messages.
        """
        if self.columns is None:
            found = {key: names.index(key) for key in KEYS if key in names}
            if not found:
                listed = " ".join(", ".join(names).split())[:LISTED] or "nothing"
                raise UsageError(
                    f"{origin} names none of {', '.join(KEYS)} but {listed}; say which is which "
                    "with columns"
                )
            return found
        for key, name in self.columns.items():
            if key not in KEYS:
                raise UsageError(f"columns has no place for {key!r}; {choices(key, KEYS)}")
            self._check(name, names, origin)
        return {key: names.index(name) for key, name in self.columns.items()}

    def of_conditions(self, names: Sequence[str], origin: str) -> dict[int, str]:
        """Return what a row must have at which place, or raise UsageError."""
        for name in self.where:
            self._check(name, names, origin)
        return {names.index(name): str(value) for name, value in self.where.items()}

    def _check(self, name: str, names: Sequence[str], origin: str) -> None:
        if name not in names:
            raise UsageError(f"{origin} has no {name!r}; {choices(name, names)}")


class Rows(ABC):
    """The rows of a table, and the files that they name."""

    @abstractmethod
    def __iter__(self) -> Iterator[Row]:
        """Yield the rows as they come; those without a time are counted and left out."""

    @abstractmethod
    def read(self, name: str) -> bytes:
        """Return what is in a file that a row names, or raise DataError."""


class CsvRows(Rows):
    """The lines of a CSV file, plain or gzip.

    Parameters
    ----------
    path : Path
        The file; its first line names the columns.
    delimiter : str
        What separates cells.
    places : Places
        Where the keys stand in a line, and which lines to read.
    root : Path
        The folder that names of files start from.
    clock : Clock
        Gives times.
    faults : Faults
        Takes what goes wrong.
    """

    def __init__(
        self,
        path: Path,
        delimiter: str,
        places: Places,
        root: Path,
        clock: Clock,
        faults: Faults,
    ) -> None:
        self.path = path
        self.delimiter = delimiter
        self.places = places
        self.root = root
        self.clock = clock
        self.faults = faults

    def __iter__(self) -> Iterator[Row]:
        text = (line.decode("utf-8", "replace") for _, line in lines(self.path))
        reader = csv.reader(text, delimiter=self.delimiter, skipinitialspace=True)
        header = [name.strip("\ufeff \t") for name in self._next(reader) or []]
        origin = f"the first line of {self.path}"
        _check_cut(header, origin)
        places = self.places.of_keys(header, origin)
        conditions = self.places.of_conditions(header, origin)
        while (cells := self._next(reader)) is not None:
            where = f"line {reader.line_num}"
            if not cells:
                continue
            try:
                if len(cells) != len(header):
                    raise ValueError(f"{len(cells)} cells where {len(header)} are due")
                if any(cells[place].strip() != value for place, value in conditions.items()):
                    continue
                found = _filled({key: cells[place] for key, place in places.items()})
                yield Row(self.clock.stamp(found, "stamp" not in places), found, where)
            except ValueError as error:
                self.faults.add("rows do not parse and were left out", f"{where}: {error}")

    def _next(self, reader: Iterator[list[str]]) -> list[str] | None:
        """Return the cells of the next line that can be taken apart; None at the end."""
        while True:
            try:
                return next(reader)
            except StopIteration:
                return None
            except csv.Error as error:
                self.faults.add("rows do not parse and were left out", str(error))

    def read(self, name: str) -> bytes:
        """Return what is in a file."""
        return read_bytes(self.root / name)


class NameRows(Rows):
    """The names of the files in a folder or tar, in order of time.

    Parameters
    ----------
    archive : Archive
        Where they are.
    pattern : str
        Regular expression, searched in each name (with its folders); its named groups are the
        columns.
    places : Places
        Which groups the keys are, and which names to read.
    clock : Clock
        Gives times; numbered names come in natural order (2 before 10).
    faults : Faults
        Takes what goes wrong.

    Raises
    ------
    UsageError
        If the pattern is none, or lacks a group.
    DataError
        If no name fits it.
    """

    def __init__(
        self,
        archive: Archive,
        pattern: str,
        places: Places,
        clock: Clock,
        faults: Faults,
    ) -> None:
        self.archive = archive
        self.clock = clock
        self.faults = faults
        try:
            self.pattern = re.compile(pattern)
        except re.error as error:
            raise UsageError(f"pattern {pattern!r} is no regular expression: {error}") from error
        self.groups = list(self.pattern.groupindex)
        origin = f"pattern {pattern!r}"
        self.keys = places.of_keys(self.groups, origin)
        self.conditions = places.of_conditions(self.groups, origin)

    def __iter__(self) -> Iterator[Row]:
        names = self.archive.names()
        matched = [name for name in names if _is_data(name) and self.pattern.search(name)]
        if not matched:
            listed = f"it holds {', '.join(names[:SHOWN])}" if names else "it holds no files"
            raise DataError(
                f"no image or scan in {self.archive.path} has a name that fits the pattern "
                f"{self.pattern.pattern!r}; {listed}"
            )
        return iter(sorted(self._rows(sorted(matched, key=natural)), key=lambda row: row.stamp))

    def _rows(self, names: Iterable[str]) -> Iterator[Row]:
        for name in names:
            match = self.pattern.search(name)
            assert match is not None  # it is one of the matched names
            values = [match[group] for group in self.groups]
            if any(values[place] != value for place, value in self.conditions.items()):
                continue
            said = {key: values[place] for key, place in self.keys.items()}
            itself = "image" if is_image(name) else "scan"
            cells = _filled({itself: name, **said})
            try:
                yield Row(self.clock.stamp(cells, "stamp" not in self.keys), cells, name)
            except ValueError as error:
                self.faults.add("names do not parse and were left out", f"{name}: {error}")

    def read(self, name: str) -> bytes:
        """Return what is in a file."""
        try:
            return self.archive.read(posixpath.normpath(name))
        except UnusableObservation as error:
            raise DataError(str(error)) from error


def _check_cut(header: Sequence[str], origin: str) -> None:
    """Refuse a header in one piece that something else than the delimiter would cut."""
    other = next((each for each in ";\t|" if len(header) == 1 and each in header[0]), None)
    if other is not None:
        raise UsageError(
            f"{origin} is one cell, '{header[0][:LISTED]}'; if its columns are separated by "
            f"{other!r}, give delimiter={other!r}"
        )


def _is_data(name: str) -> bool:
    return is_image(name) or not ranges.is_list(name)


def _filled(cells: Mapping[str, str | None]) -> dict[str, str]:
    return {key: cell.strip() for key, cell in cells.items() if cell and cell.strip()}
