"""Images sorted into folders: one folder a class."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Mapping
from pathlib import Path

from placecue.checks import check_number
from placecue.errors import DataError, UnusableObservation
from placecue.faults import Faults
from placecue.observation import Observation
from placecue.source import Source
from placecue_sources.archive import Archive, open_archive
from placecue_sources.contents import digest_of
from placecue_sources.image_files import encoded, is_image, natural
from placecue_sources.tags import stem


class ImageFolder(Source):
    """One observation for each image; the first folder in its path is its label.

    Classes come one after the other, the images of each in natural order (2 before 10), numbered
    at an even rate. The folder that an image lies in, within that of its class, is its scene.
    Images that lie in no folder, or cannot be read, are counted and said once. Hidden files and
    folders, whose names begin with a point, are no images and no classes.

    Parameters
    ----------
    path : str
        The folder that holds a folder a class, with further folders in it or not; or a tar of it,
        which stays packed.
    rate : float
        Images a second; the first comes one step after 0.
    conditions : mapping of str to str, optional
        Metadata: conditions of the recording, such as ``{illumination: cloudy}``.
    """

    def __init__(
        self, path: str, rate: float = 5.0, conditions: Mapping[str, str] | None = None
    ) -> None:
        self.path = path
        self.rate = rate
        self.conditions = conditions

    @property
    def name(self) -> str:  # type: ignore[override]
        """The folder's name, or the tar's."""
        return stem(self.path)

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """What was given."""
        return {key: str(value) for key, value in (self.conditions or {}).items()}

    def __iter__(self) -> Iterator[Observation]:
        check_number("rate", self.rate, above=0)
        faults = Faults(self.name)
        read = 0
        with open_archive(self.path, faults) as archive:
            for number, (label, image, scene) in enumerate(self._images(archive, faults), 1):
                try:
                    source = encoded(archive.read(image), image)
                except UnusableObservation as error:
                    faults.add("images cannot be read and were left out", str(error))
                    continue
                read += 1
                stamp = round(number * 1e9 / self.rate)
                yield Observation(stamp, image=source, label=label, scene=scene)
        if not read:
            raise DataError(f"{self.path} gives no observation: {faults.told()}")
        faults.report()

    def count(self) -> int:
        """Return the number of images, from their names alone."""
        check_number("rate", self.rate, above=0)
        with open_archive(self.path, Faults(self.name)) as archive:
            return len(self._images(archive, Faults(self.name)))

    def digest(self) -> str:
        """Return a digest of the images, of their names and of the rate."""
        with open_archive(self.path, Faults(self.name)) as archive:
            images = [image for _, image, _ in self._images(archive, Faults(self.name))]
            root = self._root([name for name in archive.names() if not _is_hidden(name)])
            return digest_of({"rate": self.rate, "files": archive.digest(images, root)}, [])

    def _images(self, archive: Archive, faults: Faults) -> list[tuple[str, str, str | None]]:
        """Return label, name and scene of each image, in order."""
        names = [name for name in archive.names() if not _is_hidden(name)]
        root = self._root(names)
        found = []
        for name in filter(is_image, names):
            inside = posixpath.relpath(name, root or ".")
            label, _, rest = inside.partition("/")
            if rest:
                found.append((label, name, posixpath.dirname(inside) if "/" in rest else None))
            else:
                faults.add("images lie in no folder of a class and were left out", name)
        if not found:
            raise DataError(f"{self.path} holds no folder with images: one folder a class is due")
        return sorted(found, key=lambda each: (each[0], natural(each[1])))

    def _root(self, names: list[str]) -> str:
        """Return the folder that the classes are in: a tar often begins with its own name."""
        tops = {name.partition("/")[0] for name in names if is_image(name)}
        top = next(iter(tops), "")
        nested = all(name.count("/") > 1 for name in names if is_image(name))
        return top if len(tops) == 1 and nested and not Path(self.path).is_dir() else ""


def _is_hidden(name: str) -> bool:
    """Tell whether a file is one that programs keep for themselves, or lies among such."""
    return any(step.startswith(".") or step == "__MACOSX" for step in name.split("/"))
