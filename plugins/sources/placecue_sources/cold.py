"""The COLD database: three laboratories, under changing illumination."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from placecue.errors import UnusableObservation
from placecue.faults import Faults
from placecue_sources.archive import Archive
from placecue_sources.categories import category
from placecue_sources.image_names import Moment, folders_of_images, moments, only
from placecue_sources.image_sequence import ImageSequence, beside
from placecue_sources.tags import ILLUMINATION, conditions

EXAMPLE = "t<seconds>_x<m>_y<m>_a<rad>.jpeg"
PLACES = "places.lst"
LABORATORY = re.compile(r"(?P<laboratory>freiburg|ljubljana|saarbrue?cken|stockholm)")
PART = re.compile(r"part_?(?P<part>[a-z])(?![a-z])")
PATH = re.compile(r"(?:seq|path)_?(?P<path>\d+)")
FLOOR = re.compile(r"floor_?(?P<floor>\d+)")
PATTERNS = (LABORATORY, PART, PATH, FLOOR, ILLUMINATION)


class Cold(ImageSequence):
    """A sequence of COLD: images, laser scans, poses and rooms.

    Images are ``std_cam/t<seconds>_x<m>_y<m>_a<rad>.jpeg``, ``localization/places.lst`` names the
    room of each, ``odom_scans/scans.tdf`` and ``odom_scans/odom.tdf`` hold what the robot
    measured. An image that is listed but missing gives an observation without it. What is absent
    is said once, and the rest is read.

    Ullah, Pronobis, Caputo, Luo, Jensfelt: The COLD Database, KTH, CVAP 2007:1, 2007.

    Parameters
    ----------
    path : str
        The sequence: its folder, or its tar, which stays packed. Laboratory, part, path,
        illumination and run are told from the names in its path, such as
        ``freiburg/part_a/seq1_cloudy2``.
    camera : str
        The folder of the images.
    keep_instances : bool
        Whether ``2PO1-A`` stays itself, or becomes its category ``2PO``.
    parts, pose, tolerance, field_of_view, max_range, scans, odometry, conditions
        See :class:`ImageSequence`.
    """

    texts = (PLACES,)
    digested = (*ImageSequence.digested, "keep_instances")

    def __init__(
        self,
        path: str,
        camera: str = "std_cam",
        keep_instances: bool = False,
        parts: Sequence[str] | None = None,
        pose: str = "corrected",
        tolerance: float = 0.15,
        field_of_view: float | None = None,
        max_range: float | None = None,
        scans: str | None = None,
        odometry: str | None = None,
        conditions: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(
            path,
            parts=parts,
            pose=pose,
            tolerance=tolerance,
            field_of_view=field_of_view,
            max_range=max_range,
            scans=scans,
            odometry=odometry,
            conditions=conditions,
        )
        # Not under its own name: ``camera`` of a source is what is known of the optics.
        self.image_folder = camera
        self.keep_instances = keep_instances

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """Data set, sequence, laboratory, part, path, illumination and run."""
        return cold_conditions("cold", self.path, self.conditions)

    def _folder(self, names: Sequence[str], path: str) -> str:
        """Return the folder of the images; where there are none, where they would be."""
        folders = folders_of_images(names, path, self.image_folder)
        places = [name for name in names if posixpath.basename(name) == PLACES]
        if not folders and len(places) == 1:
            return posixpath.join(
                posixpath.dirname(posixpath.dirname(places[0])), self.image_folder
            )
        return only(folders, names, path, f"{self.image_folder}/{EXAMPLE}")

    def _moments(
        self, archive: Archive, names: Sequence[str], folder: str, faults: Faults
    ) -> list[Moment]:
        places = self._places(archive, beside(names, folder, PLACES), faults)
        images = {posixpath.basename(name) for name in names if posixpath.dirname(name) == folder}
        found = []
        for moment in moments(sorted(images | places.keys()), faults):
            label = places.get(moment.image)
            if label is None:
                faults.add(f"images have no label in {PLACES}", moment.image)
            elif not self.keep_instances:
                label = category(label)
            found.append(replace(moment, label=label))
        return found

    def _places(self, archive: Archive, name: str | None, faults: Faults) -> dict[str, str]:
        """Return the room of each image."""
        if name is None:
            return {}
        try:
            text = archive.read(name).decode("utf-8", "replace")
        except UnusableObservation as error:
            faults.add("files cannot be read", str(error))
            return {}
        places = {}
        for number, line in enumerate(text.splitlines(), 1):
            fields = line.split()
            if len(fields) == 2:
                places[posixpath.basename(fields[0])] = fields[1]
            elif fields:
                faults.add("lines do not parse and were left out", f"{name}, line {number}")
        return places


def cold_conditions(dataset: str, path: str, given: Mapping[str, str] | None) -> dict[str, str]:
    """Return the metadata of a sequence of one of the COLD data sets."""
    found = conditions(dataset, path, PATTERNS, given)
    if found.get("laboratory") == "saarbruecken" and "laboratory" not in (given or {}):
        found["laboratory"] = "saarbrucken"
    return found
