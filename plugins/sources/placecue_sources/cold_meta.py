"""COLD-Meta: laser scans, odometry, poses and rooms of the COLD databases, without images."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import DataError
from placecue.faults import Faults
from placecue.observation import LaserScan, Observation, Pose2D
from placecue.source import Source
from placecue_sources import stamps
from placecue_sources.archive import Archive, open_archive
from placecue_sources.categories import category
from placecue_sources.cold import cold_conditions
from placecue_sources.contents import digest_of
from placecue_sources.image_sequence import POSES, beside
from placecue_sources.tags import stem
from placecue_sources.text_records import Fields, PoseTrack, TextRecords

PARTS = ("scan", "pose", "label")
SCANS = "scans.dat"
LABELS = "labels.dat"
TRACKS = {"corrected": ("canonical_poses.dat", "map"), "odometry": ("odometry.dat", "odom")}
FILES = (SCANS, LABELS, *(name for name, _ in TRACKS.values()))


class ColdMeta(Source):
    """A sequence of COLD-Meta: one observation for each laser scan.

    Every file has one record a line, an id and a time (s) first, separated by blanks or commas:
    ``odometry.dat`` and ``canonical_poses.dat`` go on with x, y (m) and heading (rad),
    ``labels.dat`` with the room, ``scans.dat`` with the ranges (m), the right end of the field of
    view first. A first line that names columns is passed over. Without ``scans.dat`` there is one
    observation for each pose. What is absent is said once, and the rest is read.

    The database's page (coldb.org, "metadata") gives the columns of ``odometry.dat``; where the
    other files differ, ``ranges_from`` and ``label_column`` say so.

    Parameters
    ----------
    path : str
        The sequence: its folder, or its tar, which stays packed. Laboratory, floor, path,
        illumination and run are told from the names in its path, such as
        ``cold-stockholm/floor4_cloudy_a1``.
    keep_instances : bool
        Whether ``l4-2PO-1`` and ``2PO1-A`` stay themselves, or become their category ``2PO``.
    parts : sequence of {"scan", "pose", "label"}, optional
        What the observations hold; by default everything.
    pose : {"corrected", "odometry"}
        Poses of ``canonical_poses.dat``, in frame ``map``, or of ``odometry.dat``, in frame
        ``odom``.
    tolerance : float
        How far in time the pose and the label may be from the scan, s.
    field_of_view : float
        Angle from the first to the last beam, degrees.
    max_range : float
        Longest range that is a measurement, m. A SICK LMS gives 81.83 and more for none.
    ranges_from : int
        Column of the first range in ``scans.dat``, counted from 0.
    label_column : int
        Column of the room in ``labels.dat``, counted from 0.
    conditions : mapping of str to str, optional
        Metadata to add to, or to put in the place of, what the names say.
    """

    def __init__(
        self,
        path: str,
        keep_instances: bool = False,
        parts: Sequence[str] | None = None,
        pose: str = "corrected",
        tolerance: float = 0.1,
        field_of_view: float = 180.0,
        max_range: float = 80.0,
        ranges_from: int = 2,
        label_column: int = 2,
        conditions: Mapping[str, str] | None = None,
    ) -> None:
        self.path = path
        self.keep_instances = keep_instances
        self.parts = parts
        self.pose = pose
        self.tolerance = tolerance
        self.field_of_view = field_of_view
        self.max_range = max_range
        self.ranges_from = ranges_from
        self.label_column = label_column
        self.conditions = conditions

    @property
    def name(self) -> str:  # type: ignore[override]
        """The folder's name, or the tar's."""
        return stem(self.path)

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """Data set, sequence, laboratory, floor, path, illumination and run."""
        return cold_conditions("cold_meta", self.path, self.conditions)

    @property
    def wanted(self) -> Sequence[str]:
        """The parts that observations hold; a command may ask for images, which are not here."""
        return PARTS if self.parts is None else [part for part in self.parts if part in PARTS]

    def __iter__(self) -> Iterator[Observation]:
        self._check()
        faults = Faults(self.name)
        with ExitStack() as stack:
            archive = stack.enter_context(open_archive(self.path, faults))
            yield from _Files(self, archive, faults, stack)
        faults.report()

    def count(self) -> int:
        """Return the number of records that give an observation; the scans are read for it."""
        self._check()
        with ExitStack() as stack:
            archive = stack.enter_context(open_archive(self.path, Faults(self.name)))
            return len(_Files(self, archive, Faults(self.name), stack).stamps)

    def digest(self) -> str:
        """Return a digest of the files and of the parameters."""
        keys = ("keep_instances", "pose", "tolerance", "field_of_view", "max_range")
        columns = ("ranges_from", "label_column")
        parameters = {key: getattr(self, key) for key in (*keys, *columns)}
        parameters["parts"] = sorted(self.wanted)
        with open_archive(self.path, Faults(self.name)) as archive:
            found = [beside(archive.names(), "", name) for name in FILES]
            parameters["files"] = [archive.digest([name], name) for name in found if name]
        return digest_of(parameters, [])

    def _check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        check_choice("pose", self.pose, POSES)
        for part in self.parts or PARTS:
            check_choice("parts", part, ("image", *PARTS))
        check_number("tolerance", self.tolerance, least=0)
        check_number("field_of_view", self.field_of_view, above=0)
        check_number("max_range", self.max_range, above=0)
        check_whole("ranges_from", self.ranges_from, least=2)
        check_whole("label_column", self.label_column, least=2)


class _Files:
    """The open files of one pass over a sequence."""

    def __init__(
        self, source: ColdMeta, archive: Archive, faults: Faults, stack: ExitStack
    ) -> None:
        self.source = source
        self.archive = archive
        self.faults = faults
        self.stack = stack
        self.names = archive.names()
        self.tolerance = round(source.tolerance * 1e9)
        wanted = source.wanted
        self.scans = self._records(SCANS) if "scan" in wanted else None
        self.labels = self._records(LABELS) if "label" in wanted else None
        self.track = self._track() if "pose" in wanted or self.scans is None else None
        self.stamps = self._stamps()

    def __iter__(self) -> Iterator[Observation]:
        for number, time in enumerate(self.stamps):
            stamp = int(time)
            scan = None if self.scans is None else self._scan(self.scans, number)
            if scan is None and self.scans is not None:
                continue
            yield Observation(stamp, scan=scan, pose=self._pose(stamp), label=self._label(stamp))

    def _stamps(self) -> NDArray[np.int64]:
        driver = self.track if self.scans is None else self.scans
        if driver is None or not len(driver.stamps):
            raise DataError(
                f"{self.source.path} holds no {SCANS} and no {TRACKS[self.source.pose][0]} with "
                "records that parse, so there is nothing to read"
            )
        return driver.stamps

    def _scan(self, scans: TextRecords, number: int) -> LaserScan | None:
        try:
            ranges = np.array(scans.fields(number)[self.source.ranges_from :]).astype(np.float64)
            if not ranges.size:
                raise ValueError("no ranges")
        except ValueError as error:
            self.faults.add("scans do not parse and were left out", f"{SCANS}: {error}")
            return None
        half = np.deg2rad(self.source.field_of_view) / 2
        angles = np.linspace(-half, half, ranges.size)
        return LaserScan(angles, ranges, 0.0, self.source.max_range)

    def _pose(self, stamp: int) -> Pose2D | None:
        if self.track is None or "pose" not in self.source.wanted:
            return None
        pose = self.track.at(stamp, self.tolerance)
        if pose is None:
            self.faults.add("scans have no pose near enough in time", f"at stamp {stamp}")
        return pose

    def _label(self, stamp: int) -> str | None:
        if self.labels is None:
            return None
        number = self.labels.nearest(stamp, self.tolerance)
        if number is None:
            self.faults.add("scans have no label near enough in time", f"at stamp {stamp}")
            return None
        fields = self.labels.fields(number)
        if len(fields) <= self.source.label_column:
            self.faults.add("labels are missing in their lines", f"{LABELS} at stamp {stamp}")
            return None
        label = fields[self.source.label_column].decode("utf-8", "replace")
        return label if self.source.keep_instances else category(label)

    def _track(self) -> PoseTrack | None:
        name, frame = TRACKS[self.source.pose]
        records = self._records(name)
        return None if records is None else PoseTrack(records, _pose, frame)

    def _records(self, name: str) -> TextRecords | None:
        found = beside(self.names, "", name)
        if found is None:
            self.faults.add("files are absent; the rest is read", name)
            return None
        file = self.stack.enter_context(self.archive.open_text(found))
        return TextRecords(file, name, _stamp, self.faults)


def _stamp(fields: Fields) -> int:
    return stamps.nanoseconds(fields[1].decode())


def _pose(fields: Fields) -> tuple[float, float, float]:
    return float(fields[2]), float(fields[3]), float(fields[4])
