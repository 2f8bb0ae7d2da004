"""Names of images that hold their time and pose, as in the IDOL2 and COLD databases."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from placecue.errors import DataError
from placecue.faults import Faults
from placecue.observation import Pose2D
from placecue_sources import stamps
from placecue_sources.image_files import is_image

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
NAME = re.compile(
    rf"t(?P<time>\d+(?:\.\d+)?)(?:_r(?P<label>[^_]+))?"
    rf"_x(?P<x>{NUMBER})_y(?P<y>{NUMBER})_a(?P<a>{NUMBER})\.(?:png|jpe?g)"
)
SHOWN = 3


@dataclass(frozen=True, slots=True)
class Moment:
    """What the name of an image says.

    Parameters
    ----------
    stamp : int
        Time, ns.
    image : str
        Name of the file, without its folder.
    pose : Pose2D
        In frame ``map``.
    label : str or None
        The room, where the name says it.
    """

    stamp: int
    image: str
    pose: Pose2D
    label: str | None


def parse(image: str) -> Moment | None:
    """Return what a name says; None where it says nothing."""
    match = NAME.fullmatch(image)
    if match is None:
        return None
    try:
        stamp = stamps.nanoseconds(match["time"])
    except ValueError:
        return None
    x, y, theta = (float(match[key]) for key in "xya")
    return Moment(stamp, image, Pose2D(x, y, theta, "map"), match["label"])


def folders_of_images(names: Iterable[str], path: str, camera: str | None) -> list[str]:
    """Return the folders of an archive that hold images with telling names, sorted.

    Parameters
    ----------
    names : iterable of str
        All files of the archive.
    path : str
        The archive; it may itself be the folder that is looked for.
    camera : str or None
        What the folder is called; None takes any.
    """
    found = set()
    for name in names:
        folder, image = posixpath.split(name)
        called = posixpath.basename(folder or path.rstrip("/"))
        if camera in (None, called) and NAME.fullmatch(image):
            found.add(folder)
    return sorted(found)


def only(folders: Sequence[str], names: Sequence[str], path: str, example: str) -> str:
    """Return the one folder that there is.

    Parameters
    ----------
    folders : sequence of str
        The folders of images.
    names : sequence of str
        All files, for messages.
    path : str
        The archive, for messages.
    example : str
        What images are called, for messages.

    Raises
    ------
    DataError
        If there is none, or more than one.
    """
    if len(folders) == 1:
        return folders[0]
    if not folders:
        listed = f"files such as {', '.join(names[:SHOWN])}" if names else "no files"
        raise DataError(f"{path} holds no images named like {example}; it holds {listed}")
    raise DataError(
        f"{path} holds {len(folders)} sequences ({', '.join(folders[:SHOWN])}, ...); name the "
        "folder or tar of one"
    )


def moments(images: Iterable[str], faults: Faults) -> list[Moment]:
    """Return what the names of images say, in order of time.

    Parameters
    ----------
    images : iterable of str
        Names without folders; what is not called like an image is passed over.
    faults : Faults
        Takes the names that say nothing, and times that come again.
    """
    found = []
    for image in images:
        moment = parse(image)
        if moment is not None:
            found.append(moment)
        elif is_image(image):
            faults.add("names of images do not parse and were left out", image)
    found.sort(key=lambda moment: (moment.stamp, moment.image))
    _count_repeated(found, faults)
    return found


def _count_repeated(found: Sequence[Moment], faults: Faults) -> None:
    for before, after in pairwise(found):
        if before.stamp == after.stamp:
            faults.add("images have the time of another", after.image)
