"""The IDOL2 database: two robots in five rooms of an office, under changing illumination."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping, Sequence

from placecue.faults import Faults
from placecue_sources.archive import Archive
from placecue_sources.image_names import Moment, folders_of_images, moments, only
from placecue_sources.image_sequence import ImageSequence
from placecue_sources.tags import ILLUMINATION, conditions

EXAMPLE = "t<seconds>_r<LABEL>_x<m>_y<m>_a<rad>.png"
PLATFORM = re.compile(r"(?P<platform>dum|min)_")


class Idol2(ImageSequence):
    """A sequence of IDOL2: images, laser scans, poses and rooms.

    Images are called ``t<seconds>_r<LABEL>_x<m>_y<m>_a<rad>.png``; ``scans.tdf`` and ``odom.tdf``
    may lie anywhere beside them. Where there are no scans the rest is read, and it is said. The
    labels are BO (one-person office), EO (two-person office), CR (corridor), KT (kitchen) and PA
    (printer area).

    Luo, Pronobis, Caputo, Jensfelt: The KTH-IDOL2 Database, KTH, CVAP 304, 2006.

    Parameters
    ----------
    path : str
        The sequence: its folder, or its tar, which stays packed. Platform, illumination and run
        are told from its name, such as ``dum_cloudy1``.
    parts, pose, tolerance, field_of_view, max_range, scans, odometry, conditions
        See :class:`ImageSequence`.
    """

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """Data set, sequence, platform, illumination and run."""
        return conditions("idol2", self.path, (PLATFORM, ILLUMINATION), self.conditions)

    def _folder(self, names: Sequence[str], path: str) -> str:
        return only(folders_of_images(names, path, None), names, path, EXAMPLE)

    def _moments(
        self, archive: Archive, names: Sequence[str], folder: str, faults: Faults
    ) -> list[Moment]:
        found = moments(
            (posixpath.basename(name) for name in names if posixpath.dirname(name) == folder),
            faults,
        )
        for moment in found:
            if moment.label is None:
                faults.add("images have no room in their names", moment.image)
        return found
