"""Any data set: a table with one row an observation, or files whose names tell it all."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.faults import Faults
from placecue.observation import PARTS, Image, LaserScan, Observation, Pose2D
from placecue.source import Source
from placecue_sources import ranges
from placecue_sources.archive import open_archive
from placecue_sources.contents import digest_of, existing
from placecue_sources.image_files import encoded
from placecue_sources.order import InOrder
from placecue_sources.stamps import UNITS
from placecue_sources.table_rows import Clock, CsvRows, NameRows, Places, Row, Rows
from placecue_sources.tags import stem

ANGLES = {"rad": 1.0, "deg": math.pi / 180}
#: No robot is farther from any origin than once around the Earth, m.
FARTHEST = 4.1e7


class Table(Source):
    """One observation for each row of a CSV file, or for each file whose name fits a pattern.

    A row says any of ``stamp``, ``image``, ``scan``, ``x``, ``y``, ``theta``, ``label`` and
    ``scene`` (which rows are near-copies of one another; see :class:`placecue.Observation`). An
    empty cell is a part that is not there. ``image`` names a file; ``scan`` names a file of
    ranges (``.npy``, ``.csv``, ``.txt``) or holds them, separated by blanks, commas or semicolons.
    Rows that do not parse, files that are missing and scans with a wrong number of beams are
    counted and said once; a row that is left with no image, scan or pose is left out. Rows with
    the same time are kept.

    Parameters
    ----------
    path : str
        A CSV file, plain or gzip, whose first line names the columns; with ``pattern`` a folder,
        or a tar, which stays packed.
    columns : mapping of str to str, optional
        The column (or named group of the pattern) that holds each of ``stamp``, ``image``,
        ``scan``, ``x``, ``y``, ``theta``, ``label``, ``scene``; by default those called so.
    pattern : str, optional
        Regular expression searched in the names of files, folders included, such as
        ``(?P<label>[^/]+)/(?P<stamp>[0-9.]+)[.]png``. The file itself is the image, or the scan.
    where : mapping of str to str, optional
        Columns or groups, and the value that a row must have there to be read.
    root : str, optional
        The folder that names of files start from; by default that of the CSV file.
    delimiter : str
        What separates the cells of the CSV file.
    stamp_unit : {"s", "ms", "us", "ns", "iso", "none"}
        How times are written, from 1970; ``iso`` is ISO 8601. Without a time, or with ``none``,
        rows are numbered.
    rate : float
        Rows a second where they are numbered.
    angle_unit : {"rad", "deg"}
        Unit of ``theta``; without ``theta`` the heading is 0.
    frame : str
        The frame that poses are given in.
    field_of_view : float
        Angle of a scan from the first beam to the last, degrees, ahead of the robot.
    clockwise : bool
        Whether the ranges of a scan come from left to right.
    beams : int, optional
        Number of beams of every scan; by default that of the first.
    range_min, range_max : float
        What is not between is no measurement, m.
    parts : sequence of {"image", "scan", "pose", "label"}, optional
        What the observations hold; by default everything.
    reorder : int
        How many rows of a CSV file are held back to put them in order of time.
    conditions : mapping of str to str, optional
        Metadata: conditions of the recording, such as ``{illumination: cloudy, run: "1"}``.
    """

    def __init__(
        self,
        path: str,
        columns: Mapping[str, str] | None = None,
        pattern: str | None = None,
        where: Mapping[str, str] | None = None,
        root: str | None = None,
        delimiter: str = ",",
        stamp_unit: str = "s",
        rate: float = 5.0,
        angle_unit: str = "rad",
        frame: str = "map",
        field_of_view: float = 180.0,
        clockwise: bool = False,
        beams: int | None = None,
        range_min: float = 0.0,
        range_max: float = 80.0,
        parts: Sequence[str] | None = None,
        reorder: int = 100,
        conditions: Mapping[str, str] | None = None,
    ) -> None:
        self.path = path
        self.columns = columns
        self.pattern = pattern
        self.where = where
        self.root = root
        self.delimiter = delimiter
        self.stamp_unit = stamp_unit
        self.rate = rate
        self.angle_unit = angle_unit
        self.frame = frame
        self.field_of_view = field_of_view
        self.clockwise = clockwise
        self.beams = beams
        self.range_min = range_min
        self.range_max = range_max
        self.parts = parts
        self.reorder = reorder
        self.conditions = conditions

    @property
    def name(self) -> str:  # type: ignore[override]
        """The file's name, or the folder's."""
        return stem(self.path) if self.pattern else Path(self.path).name

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """What was given."""
        return {key: str(value) for key, value in (self.conditions or {}).items()}

    @property
    def wanted(self) -> Sequence[str]:
        """The parts that observations hold."""
        return PARTS if self.parts is None else self.parts

    def __iter__(self) -> Iterator[Observation]:
        self._check()
        faults = Faults(self.name)
        cells = _Cells(self, faults)
        empty = True
        with self._rows(faults) as rows:
            ordered = InOrder(rows, 0 if self.pattern else self.reorder)
            for row in _repeats_counted(ordered, faults):
                observation = cells.observation(row, rows.read)
                if observation is not None:
                    empty = False
                    yield observation
        faults.add("rows are too far out of order and were left out", "see reorder", ordered.late)
        if empty:
            raise DataError(f"{self.path} gives no observation: {faults.told() or 'it is empty'}")
        faults.report()

    def count(self) -> int:
        """Return the number of rows that have a time; the table is read for it."""
        self._check()
        with self._rows(Faults(self.name)) as rows:
            return sum(1 for _ in rows)

    def digest(self) -> str:
        """Return a digest of the table, of the files that it names, and of the parameters."""
        parameters = {
            key: value for key, value in vars(self).items() if key not in ("path", "conditions")
        }
        files = hashlib.sha256()
        with self._rows(Faults(self.name)) as rows:
            for row in rows:
                files.update(repr(sorted(row.cells.items())).encode("utf-8", "backslashreplace"))
                for name in _named(row):
                    files.update(hashlib.sha256(_content(rows, name)).digest())
        parameters["files"] = files.hexdigest()
        return digest_of(parameters, [])

    @contextmanager
    def _rows(self, faults: Faults) -> Iterator[Rows]:
        clock = Clock(self.stamp_unit, self.rate)
        places = Places(self.columns, self.where)
        if self.pattern is None:
            path = existing(self.path)
            root = path.parent if self.root is None else Path(self.root).expanduser()
            yield CsvRows(path, self.delimiter, places, root, clock, faults)
            return
        with open_archive(self.path, faults) as archive:
            yield NameRows(archive, self.pattern, places, clock, faults)

    def _check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        check_choice("stamp_unit", self.stamp_unit, UNITS)
        if len(self.delimiter) != 1:
            raise UsageError(f"delimiter is {self.delimiter!r}; give one character")
        check_choice("angle_unit", self.angle_unit, tuple(ANGLES))
        for part in self.wanted or ("nothing",):
            check_choice("parts", part, PARTS)
        for name in ("rate", "field_of_view"):
            check_number(name, getattr(self, name), above=0)
        check_number("range_min", self.range_min, least=0)
        check_number("range_max", self.range_max, above=self.range_min)
        if self.beams is not None:
            check_whole("beams", self.beams, least=1)
        check_whole("reorder", self.reorder, least=0)


class _Cells:
    """Turns rows into observations; what cannot be read is counted and left out."""

    def __init__(self, table: Table, faults: Faults) -> None:
        self.table = table
        self.faults = faults
        self.beams = table.beams

    def observation(self, row: Row, read: Callable[[str], bytes]) -> Observation | None:
        """Return the observation of a row; None where nothing was measured."""
        wanted = self.table.wanted
        image = self._image(row, read) if "image" in wanted else None
        scan = self._scan(row, read) if "scan" in wanted else None
        pose = self._pose(row) if "pose" in wanted else None
        if image is None and scan is None and pose is None:
            self.faults.add("rows hold no image, scan or pose and were left out", row.where)
            return None
        label = row.cells.get("label") if "label" in wanted else None
        scene = row.cells.get("scene")
        return Observation(row.stamp, image=image, scan=scan, pose=pose, label=label, scene=scene)

    def _image(self, row: Row, read: Callable[[str], bytes]) -> Callable[[], Image] | None:
        name = row.cells.get("image")
        if name is None:
            return None
        try:
            return encoded(read(name), name)
        except (DataError, UnusableObservation) as error:
            self.faults.add("images cannot be read", f"{row.where}: {error}")
            return None

    def _scan(self, row: Row, read: Callable[[str], bytes]) -> LaserScan | None:
        cell = row.cells.get("scan")
        if cell is None:
            return None
        table = self.table
        try:
            found = (
                ranges.ranges_of(cell)
                if ranges.is_list(cell)
                else ranges.ranges_in(read(cell), cell)
            )
            self.beams = self.beams or found.size
            if found.size != self.beams:
                raise ValueError(f"{found.size} beams where {self.beams} are due")
        except (DataError, ValueError, EOFError) as error:
            self.faults.add("scans cannot be read", f"{row.where}: {error}")
            return None
        limits = (table.range_min, table.range_max)
        return ranges.scan_of(found, table.field_of_view, *limits, table.clockwise)

    def _pose(self, row: Row) -> Pose2D | None:
        said = [row.cells.get(key) for key in ("x", "y")]
        if None in said:
            return None
        try:
            x, y, theta = (float(cell or "") for cell in (*said, row.cells.get("theta", "0")))
            if not math.isfinite(x + y + theta):
                raise ValueError(f"{x}, {y}, {theta} is not finite")
            if math.hypot(x, y) > FARTHEST:
                raise ValueError(f"{x:g}, {y:g} is {math.hypot(x, y):g} m away")
        except ValueError as error:
            self.faults.add("poses do not parse and were left out", f"{row.where}: {error}")
            return None
        heading = theta * ANGLES[self.table.angle_unit]
        if abs(heading) > 2 * math.pi:
            kind = "headings are more than a whole turn: if they are degrees, angle_unit=deg"
            self.faults.add(kind, f"{row.where}: {heading:g} rad")
        return Pose2D(x, y, heading, self.table.frame)


def _repeats_counted(rows: InOrder[Row], faults: Faults) -> Iterator[Row]:
    before = None
    for row in rows:
        if row.stamp == before:
            faults.add("rows have the time of another", row.where)
        before = row.stamp
        yield row


def _named(row: Row) -> list[str]:
    """Return the files that a row names."""
    cells = row.cells
    scan = [cells["scan"]] if "scan" in cells and not ranges.is_list(cells["scan"]) else []
    return [cells["image"], *scan] if "image" in cells else scan


def _content(rows: Rows, name: str) -> bytes:
    try:
        return rows.read(name)
    except DataError:
        return b""
