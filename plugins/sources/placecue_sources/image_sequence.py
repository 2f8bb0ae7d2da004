"""Recordings of images named by time and pose, with scans and odometry in CURE text files."""

from __future__ import annotations

import logging
import posixpath
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from functools import lru_cache
from typing import ClassVar

from placecue.checks import check_choice, check_number
from placecue.errors import DataError, UnusableObservation
from placecue.faults import Faults
from placecue.observation import PARTS, Image, LaserScan, Observation, Pose2D
from placecue.source import Source
from placecue_sources import cure
from placecue_sources.archive import Archive, open_archive
from placecue_sources.contents import digest_of, existing, open_bytes
from placecue_sources.image_files import encoded
from placecue_sources.image_names import Moment
from placecue_sources.tags import stem
from placecue_sources.text_records import PoseTrack, TextRecords

log = logging.getLogger(__name__)

POSES = ("corrected", "odometry")
SCANS = "scans.tdf"
ODOMETRY = "odom.tdf"


class ImageSequence(Source):
    """One observation for each image of a sequence; its subclasses say what differs.

    Names and times are held, files are read when their turn comes.

    Parameters
    ----------
    path : str
        The sequence: its folder, or its tar, which stays packed.
    parts : sequence of {"image", "scan", "pose", "label"}, optional
        What the observations hold; by default everything.
    pose : {"corrected", "odometry"}
        Poses of the image names, in frame ``map``, or of ``odom.tdf``, in frame ``odom``.
    tolerance : float
        How far in time the scan of an image, or the odometry, may be from it, s.
    field_of_view : float, optional
        Angle from the first to the last beam, degrees; by default what the records say.
    max_range : float, optional
        Longest range that is a measurement, m; by default what the records say.
    scans, odometry : str, optional
        ``scans.tdf`` and ``odom.tdf`` where they lie elsewhere.
    conditions : mapping of str to str, optional
        Metadata to add to, or to put in the place of, what the names say.
    """

    #: Files beside the images that are read besides scans and odometry.
    texts: ClassVar[tuple[str, ...]] = ()
    #: Parameters that change the observations.
    digested: ClassVar[tuple[str, ...]] = ("pose", "tolerance", "field_of_view", "max_range")

    def __init__(
        self,
        path: str,
        parts: Sequence[str] | None = None,
        pose: str = "corrected",
        tolerance: float = 0.15,
        field_of_view: float | None = None,
        max_range: float | None = None,
        scans: str | None = None,
        odometry: str | None = None,
        conditions: Mapping[str, str] | None = None,
    ) -> None:
        self.path = path
        self.parts = parts
        self.pose = pose
        self.tolerance = tolerance
        self.field_of_view = field_of_view
        self.max_range = max_range
        self.scans = scans
        self.odometry = odometry
        self.conditions = conditions

    @property
    def name(self) -> str:  # type: ignore[override]
        """The folder's name, or the tar's."""
        return stem(self.path)

    @abstractmethod
    def _moments(
        self, archive: Archive, names: Sequence[str], folder: str, faults: Faults
    ) -> list[Moment]:
        """Return the moments of a sequence in order of time, with their labels."""

    def __iter__(self) -> Iterator[Observation]:
        self._check()
        faults = Faults(self.name)
        with ExitStack() as stack:
            archive = stack.enter_context(open_archive(self.path, faults))
            names, folder = self._names(archive)
            moments = self._moments(archive, names, folder, faults)
            files = _Files(self, archive, names, folder, faults, stack)
            for moment in moments:
                yield files.observation(moment)
        faults.report()

    def count(self) -> int:
        """Return the number of observations, from the names alone."""
        self._check()
        with open_archive(self.path, Faults(self.name)) as archive:
            names, folder = self._names(archive)
            return len(self._moments(archive, names, folder, Faults(self.name)))

    def digest(self) -> str:
        """Return a digest of the files that are read and of the parameters."""
        parameters = {key: getattr(self, key) for key in self.digested}
        parameters["parts"] = sorted(self.wanted)
        with open_archive(self.path, Faults(self.name)) as archive:
            names, folder = self._names(archive)
            texts = (beside(names, folder, name) for name in (*self.texts, SCANS, ODOMETRY))
            used = [name for name in names if posixpath.dirname(name) == folder]
            used += [name for name in texts if name is not None]
            parameters["files"] = archive.digest(used, posixpath.dirname(folder))
        elsewhere = [existing(path) for path in (self.scans, self.odometry) if path]
        return digest_of(parameters, elsewhere)

    @property
    def wanted(self) -> Sequence[str]:
        """The parts that observations hold."""
        return PARTS if self.parts is None else self.parts

    def _check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        check_choice("pose", self.pose, POSES)
        for part in self.wanted or ("nothing",):
            check_choice("parts", part, PARTS)
        check_number("tolerance", self.tolerance, least=0)
        for name in ("field_of_view", "max_range"):
            if getattr(self, name) is not None:
                check_number(name, getattr(self, name), above=0)

    def _names(self, archive: Archive) -> tuple[list[str], str]:
        """Return the names of all files, and the folder of the images."""
        names = archive.names()
        return names, self._folder(names, str(archive.path))

    @abstractmethod
    def _folder(self, names: Sequence[str], path: str) -> str:
        """Return the folder of the images."""


def beside(names: Sequence[str], folder: str, file: str) -> str | None:
    """Return the file of a name that lies next to a folder or deeper, the highest first."""
    root = posixpath.dirname(folder)
    found = [name for name in names if posixpath.basename(name) == file]
    found = [name for name in found if not root or name.startswith(f"{root}/")]
    return min(found, key=lambda name: (name.count("/"), name), default=None)


class _Files:
    """The open files of one pass over a sequence."""

    def __init__(
        self,
        source: ImageSequence,
        archive: Archive,
        names: Sequence[str],
        folder: str,
        faults: Faults,
        stack: ExitStack,
    ) -> None:
        self.source = source
        self.archive = archive
        self.names = names
        self.folder = folder
        self.faults = faults
        self.stack = stack
        self.present = frozenset(names)
        self.tolerance = round(source.tolerance * 1e9)
        self.scans = self._scans()
        self.track = self._track()
        # A scan may be the nearest of two images in a row.
        self.scan_number = lru_cache(maxsize=1)(self._read_scan)

    def observation(self, moment: Moment) -> Observation:
        """Return the observation of a moment; what cannot be read is counted and left out."""
        wanted = self.source.wanted
        return Observation(
            moment.stamp,
            image=self._image(moment) if "image" in wanted else None,
            scan=None if self.scans is None else self._scan(self.scans, moment),
            pose=self._pose(moment) if "pose" in wanted else None,
            label=moment.label if "label" in wanted else None,
        )

    def _image(self, moment: Moment) -> Callable[[], Image] | None:
        name = posixpath.join(self.folder, moment.image)
        if name not in self.present:
            self.faults.add("images are missing", moment.image)
            return None
        try:
            return encoded(self.archive.read(name), name)
        except UnusableObservation as error:
            self.faults.add("images cannot be read", str(error))
            return None

    def _scan(self, scans: TextRecords, moment: Moment) -> LaserScan | None:
        number = scans.nearest(moment.stamp, self.tolerance)
        if number is None:
            self.faults.add("images have no scan near enough in time", moment.image)
            return None
        return self.scan_number(number)

    def _read_scan(self, number: int) -> LaserScan | None:
        assert self.scans is not None
        try:
            source = self.source
            return cure.scan(self.scans.fields(number), source.field_of_view, source.max_range)
        except (ValueError, IndexError) as error:
            self.faults.add("scans do not parse and were left out", str(error))
            return None

    def _pose(self, moment: Moment) -> Pose2D | None:
        if self.track is None:
            return moment.pose
        pose = self.track.at(moment.stamp, self.tolerance)
        if pose is None:
            self.faults.add("images have no odometry near enough in time", moment.image)
        return pose

    def _scans(self) -> TextRecords | None:
        if "scan" not in self.source.wanted:
            return None
        records = self._records(SCANS, self.source.scans)
        if records is None:
            log.warning(
                f"{self.source.name}: no {SCANS} in {self.source.path}, so there are no scans; "
                "the rest is read (source.scans=FILE names one that lies elsewhere)"
            )
        return records

    def _track(self) -> PoseTrack | None:
        if "pose" not in self.source.wanted or self.source.pose == "corrected":
            return None
        records = self._records(ODOMETRY, self.source.odometry)
        if records is None:
            raise DataError(
                f"no {ODOMETRY} in {self.source.path}; name one with source.odometry=FILE, or take "
                "the poses of the image names with source.pose=corrected"
            )
        return PoseTrack(records, cure.odometry, "odom")

    def _records(self, name: str, elsewhere: str | None) -> TextRecords | None:
        if elsewhere is not None:
            file = open_bytes(existing(elsewhere))
            self.stack.callback(file.close)
            return TextRecords(file, elsewhere, cure.stamp, self.faults)
        found = beside(self.names, self.folder, name)
        if found is None:
            return None
        member = self.stack.enter_context(self.archive.open_text(found))
        return TextRecords(member, found, cure.stamp, self.faults)
