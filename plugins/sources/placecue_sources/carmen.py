"""CARMEN text logs: laser scans and odometry of many public data sets."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import DataError
from placecue.observation import Observation
from placecue.source import Source
from placecue_sources.carmen_records import (
    MalformedRecord,
    Odometry,
    OldLaser,
    Record,
    RobotLaser,
)
from placecue_sources.contents import digest_of, existing, lines
from placecue_sources.order import InOrder

log = logging.getLogger(__name__)

LASERS = ("front", "rear")
PARTS = ("scan", "pose")
POSES = ("corrected", "odometry")

# Words that lines of a CARMEN log begin with, to say what is in a log that is of no use.
KNOWN = frozenset(
    b"PARAM SYNC ODOM TRUEPOS FLASER RLASER RAWLASER1 RAWLASER2 ROBOTLASER1 ROBOTLASER2 "
    b"NMEAGGA NMEARMC".split()
)


class CarmenLog(Source):
    """A CARMEN log: one observation for each laser scan, or for each odometry reading.

    Of ``FLASER`` and ``ROBOTLASER1``, which hold the same scans where both are logged, the kind
    that comes first is read. Records whose time is not after 0 are left out: tools that correct
    the poses write such copies. Lines that do not parse are counted and reported once.

    Parameters
    ----------
    path : str
        The log, plain or gzip (told by its content).
    laser : {"front", "rear"}
        ``FLASER`` and ``ROBOTLASER1``, or ``ROBOTLASER2``. ``RLASER`` does not say how its laser
        is mounted, and is not read.
    parts : sequence of {"scan", "pose"}
        What the observations hold. ``["pose"]`` alone reads the ``ODOM`` records, which come more
        often than scans, in frame ``odom``.
    pose : {"corrected", "odometry"}
        Which pose goes with a scan: ``x y θ`` of an ``FLASER`` record, in frame ``map``, or its
        odometry, in frame ``odom``. Logs that were corrected by SLAM often hold the corrected
        pose in both places. ``ROBOTLASER1`` has one pose; this says what it is.
    field_of_view : float, optional
        Angle that the scanner covers, degrees. By default 180 for ``FLASER`` (181 and 361 beams
        from -90 to 90, of 180 and 360 the last is left out), and what the record says for
        ``ROBOTLASER1``.
    max_range : float, optional
        Longest range that is a measurement, m. By default 80 for ``FLASER`` (a SICK LMS gives
        81.83 to 81.91 where it measured nothing), and what the record says for ``ROBOTLASER1``.
    reorder : int
        How many observations are held back to put lines in order of time.
    """

    def __init__(
        self,
        path: str,
        laser: str = "front",
        parts: Sequence[str] = PARTS,
        pose: str = "corrected",
        field_of_view: float | None = None,
        max_range: float | None = None,
        reorder: int = 100,
    ) -> None:
        self.path = path
        self.laser = laser
        self.parts = parts
        self.pose = pose
        self.field_of_view = field_of_view
        self.max_range = max_range
        self.reorder = reorder

    @property
    def name(self) -> str:  # type: ignore[override]
        """The file's name."""
        return Path(self.path).name

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """The format, and which laser and poses are read."""
        return {"format": "CARMEN", "laser": self.laser, "pose": self.pose}

    def __iter__(self) -> Iterator[Observation]:
        reading, ordered = self._open()
        yield from map(self._with_parts, ordered)
        reading.report(ordered.late)

    def count(self) -> int:
        """Return the number of observations; the log is read for it."""
        return sum(1 for _ in self._open()[1])

    def digest(self) -> str:
        """Return a digest of the file and of what is read from it."""
        keys = ("laser", "pose", "field_of_view", "max_range", "reorder")
        parameters = {key: getattr(self, key) for key in keys}
        parameters["parts"] = sorted(self.parts)
        return digest_of(parameters, [existing(self.path)])

    def _open(self) -> tuple[_Reading, InOrder[Observation]]:
        """Return the log, to be read from its beginning, and its observations in order."""
        reading = _Reading(existing(self.path), self._records())
        return reading, InOrder(reading, self.reorder)

    def _records(self) -> dict[bytes, Record]:
        """Return the readers of the wanted records, by the word that a line begins with."""
        self._check()
        if "scan" not in self.parts:
            return {b"ODOM": Odometry()}
        settings = (self.field_of_view, self.max_range, self.pose == "odometry")
        if self.laser == "rear":
            return {b"ROBOTLASER2": RobotLaser(*settings)}
        return {b"FLASER": OldLaser(*settings), b"ROBOTLASER1": RobotLaser(*settings)}

    def _check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        check_choice("laser", self.laser, LASERS)
        check_choice("pose", self.pose, POSES)
        for part in self.parts or ("nothing",):
            check_choice("parts", part, PARTS)
        for name in ("field_of_view", "max_range"):
            if getattr(self, name) is not None:
                check_number(name, getattr(self, name), above=0)
        check_whole("reorder", self.reorder, least=0)

    def _with_parts(self, observation: Observation) -> Observation:
        if "pose" in self.parts:
            return observation
        return Observation(observation.stamp, scan=observation.scan)


class _Reading:
    """The wanted records of a log as they come, and an account of what was passed over."""

    def __init__(self, path: Path, records: Mapping[bytes, Record]) -> None:
        self.path = path
        self.records = records
        self.seen: Counter[bytes] = Counter()
        self.malformed = 0
        self.first = ""

    def __iter__(self) -> Iterator[Observation]:
        kind = None
        for number, line in lines(self.path):
            word = line.split(None, 1)[:1]
            self.seen.update(KNOWN.intersection(word))
            if not word or word[0] not in self.records or kind not in (None, word[0]):
                continue
            observation = self._read(number, line)
            if observation is not None:
                kind = word[0]
                yield observation
        if kind is None:
            raise DataError(self._nothing())

    def _read(self, number: int, line: bytes) -> Observation | None:
        word, *fields = line.split()
        try:
            return self.records[word].read(fields)
        except MalformedRecord as error:
            self.malformed += 1
            self.first = self.first or f"line {number}, {word.decode()}: {error}"
            return None

    def report(self, late: int) -> None:
        """Warn once of lines that did not parse, and once of those too far out of order."""
        if self.malformed:
            log.warning(
                f"{self.path}: {self.malformed} lines do not parse and were left out; "
                f"the first: {self.first}"
            )
        if late:
            log.warning(
                f"{self.path}: {late} records are too far out of order of time and were left out; "
                "a larger reorder keeps them"
            )

    def _nothing(self) -> str:
        wanted = " or ".join(word.decode() for word in self.records)
        if not self.seen:
            return f"{self.path} is not a CARMEN log: no line begins with a word such as {wanted}"
        if self.malformed:
            return f"{self.path} has no {wanted} record that parses; the first: {self.first}"
        listed = ", ".join(f"{word.decode()} {n}" for word, n in sorted(self.seen.items()))
        return f"{self.path} has no {wanted} record with a time after 0; it has {listed}"
