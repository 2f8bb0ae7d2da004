"""The frames of an RGB-D data set: a table of files, or two folders of files of the same names."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from placecue.errors import DataError, UsageError, choices
from placecue_sources.nearest_times import are_times, paired

SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".ppm", ".pgm", ".bmp", ".webp", ".exr")


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame.

    Parameters
    ----------
    stamp : int
        Time, ns.
    image, depth : Path or None
        Its files, whether they are there or not; None where none is named.
    label : str or None
        The place.
    scene : str or None
        What it belongs to; see :class:`placecue.Observation`.
    """

    stamp: int
    image: Path | None
    depth: Path | None
    label: str | None = None
    scene: str | None = None


@dataclass(frozen=True, slots=True)
class Columns:
    """Names of a table's columns; None where the table has no such column.

    Parameters
    ----------
    image, depth : str or None
        Paths of the files, relative to the table.
    label : str or None
        The place; an empty cell is a frame without a label.
    stamp : str or None
        Time, s.
    scene : str or None
        The scene.
    """

    image: str | None
    depth: str | None
    label: str | None
    stamp: str | None
    scene: str | None = None

    def named(self) -> list[str]:
        """Return the names that are given."""
        every = (self.image, self.depth, self.label, self.stamp, self.scene)
        return [name for name in every if name is not None]


def frames_of_table(path: Path, columns: Columns, rate: float) -> list[Frame]:
    """Return the frames that a CSV file lists, in order of time.

    Parameters
    ----------
    path : Path
        The table; its first line names the columns.
    columns : Columns
        What they mean.
    rate : float
        Frames a second, where no column gives the time: frame n then has the time n / rate.

    Raises
    ------
    DataError
        If the file cannot be read, lists nothing, or holds a time that is no number.
    UsageError
        If a named column is not there.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, skipinitialspace=True)
            present = [name.strip() for name in reader.fieldnames or []]
            reader.fieldnames = present
            rows = [(reader.line_num, row) for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"cannot read the table of frames {path}: {error}") from error
    for name in columns.named():
        if name not in present:
            raise UsageError(f"{path} has no column '{name}'; {choices(name, present)}")
    if not rows:
        raise DataError(f"{path} lists no frame: only its first line is there")
    found = [
        _frame(row, columns, path.parent, round(number / rate * 1e9), f"{path}, line {line}")
        for number, (line, row) in enumerate(rows, start=1)
    ]
    return sorted(found, key=lambda frame: frame.stamp)


def frames_of_folders(images: Path, depths: Path, rate: float) -> list[Frame]:
    """Return the frames of two folders, paired by file name without its ending.

    Where names are times that differ between the folders, as in the RGB-D data set of TUM, the
    nearest go together, and they are the times of the frames.

    Parameters
    ----------
    images, depths : Path
        The folders. A name that is in one of them only makes a frame without the other part.
    rate : float
        Frames a second: frame n, counted from 1 in order of name, has the time n / rate.

    Raises
    ------
    DataError
        If neither folder holds a picture, or their times are too far apart.
    """
    pictures, maps = _by_stem(images), _by_stem(depths)
    if pictures and maps and pictures.keys().isdisjoint(maps) and are_times((*pictures, *maps)):
        return [
            Frame(stamp, pictures.get(image or ""), maps.get(depth or ""))
            for stamp, image, depth in paired(list(pictures), list(maps), str(images.parent))
        ]
    names = sorted(pictures.keys() | maps.keys(), key=_natural)
    if not names:
        raise DataError(f"no picture in {images} and none in {depths}; check the folders' names")
    return [
        Frame(round(number / rate * 1e9), pictures.get(name), maps.get(name))
        for number, name in enumerate(names, start=1)
    ]


def select(
    frames: Sequence[Frame], classes: Collection[str] | None, min_frames: int, where: str
) -> list[Frame]:
    """Return the frames of the wanted classes.

    Parameters
    ----------
    frames : sequence of Frame
        All of them.
    classes : collection of str or None
        Classes to keep; None keeps all, and frames without a label.
    min_frames : int
        Classes with fewer frames are left out; frames without a label are not.
    where : str
        Name of the data set, for messages.

    Raises
    ------
    UsageError
        If a wanted class does not occur, or nothing is left.
    """
    counts = Counter(frame.label for frame in frames if frame.label is not None)
    for name in classes or ():
        if name not in counts:
            raise UsageError(f"{where} has no frame of the class '{name}'; {choices(name, counts)}")
    kept = [
        frame
        for frame in frames
        if (classes is None or frame.label in classes)
        and (frame.label is None or counts[frame.label] >= min_frames)
    ]
    if not kept:
        largest = max(counts, key=lambda name: counts[name])
        raise UsageError(
            f"min_frames={min_frames} leaves no frame of {where}: the largest class, '{largest}', "
            f"has {counts[largest]}"
        )
    return kept


def _frame(
    row: Mapping[str, str | None], columns: Columns, folder: Path, stamp: int, line: str
) -> Frame:
    def cell(name: str | None) -> str:
        return (row.get(name or "") or "").strip()

    if columns.stamp is not None:
        stamp = _nanoseconds(cell(columns.stamp), f"'{columns.stamp}' of {line}")
    image, depth = cell(columns.image), cell(columns.depth)
    return Frame(
        stamp,
        folder / image if image else None,
        folder / depth if depth else None,
        cell(columns.label) or None,
        cell(columns.scene) or None,
    )


def _nanoseconds(seconds: str, where: str) -> int:
    try:
        return round(float(seconds) * 1e9)
    except (ValueError, OverflowError) as error:
        raise DataError(f"{where}: '{seconds}' is no time in s") from error


def _by_stem(folder: Path) -> dict[str, Path]:
    if not folder.is_dir():
        return {}
    files = (path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    return {path.stem: path for path in files}


def _natural(name: str) -> list[tuple[int, int, str]]:
    """Return a key that puts ``frame10`` after ``frame9``."""
    parts = re.split(r"(\d+)", name)
    return [(1, int(part), "") if part.isdigit() else (0, 0, part) for part in parts]
