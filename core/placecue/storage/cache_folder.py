"""What lies in a feature cache: a folder for each log and cue, listed and removed as one."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from placecue.atomic import write_text
from placecue.errors import DataError
from placecue.storage import shard, strict_json
from placecue.storage.guarded import read_bytes

ABOUT = "about.json"
FORMAT = "placecue/features"
DAY = 86_400.0
#: Bytes that what is said of a folder may take.
ABOUT_SIZE = 2**20


@dataclass(frozen=True, slots=True)
class Kept:
    """The features of one log by one cue, or a cue that has learned.

    Parameters
    ----------
    folder : Path
        Where it lies.
    about : mapping of str to plain data
        ``log``, ``cue``, ``version``, ``parameters`` and so on.
    size : int
        Bytes.
    used : float
        When it was last used, s since 1970.
    """

    folder: Path
    about: Mapping[str, Any]
    size: int
    used: float

    @property
    def samples(self) -> int:
        """The number of observations."""
        return sum(shard.count(path) for path in self.folder.glob("[0-9]*.npz"))


def describe(folder: Path, about: Mapping[str, Any]) -> None:
    """Say what is kept in a folder, once, before anything is put into it.

    Raises
    ------
    PlacecueError
        If it cannot be written.
    """
    if not (folder / ABOUT).exists():
        write_text(folder / ABOUT, strict_json.dumps({"format": FORMAT, **about}).decode())


def touch(folder: Path) -> None:
    """Note that what is in a folder is being used."""
    with suppress(OSError):  # not there yet, or not ours to write to
        os.utime(folder / ABOUT)


def contents(cache: Path) -> list[Kept]:
    """Return what is in a cache, last used first; what placecue did not put there is left out."""
    found = (_kept(folder) for log in _folders(cache) for folder in _folders(log))
    return sorted((each for each in found if each is not None), key=lambda each: -each.used)


def trim(cache: Path, max_bytes: float | None = None, unused_days: float | None = None) -> int:
    """Remove what was used least recently.

    Parameters
    ----------
    cache : Path
        The cache.
    max_bytes : float, optional
        What stays takes no more.
    unused_days : float, optional
        What stays was used within so many days.

    Returns
    -------
    int
        Bytes removed.
    """
    total = removed = 0
    oldest = -float("inf") if unused_days is None else time.time() - unused_days * DAY
    for each in contents(cache):
        total += each.size
        if each.used < oldest or (max_bytes is not None and total > max_bytes):
            shutil.rmtree(each.folder, ignore_errors=True)
            removed += each.size
            with suppress(OSError):  # other cues of the log are there
                each.folder.parent.rmdir()
    return removed


def _kept(folder: Path) -> Kept | None:
    try:
        about = strict_json.loads(read_bytes(folder / ABOUT, ABOUT_SIZE), folder / ABOUT)
        used = (folder / ABOUT).stat().st_mtime
        paths = list(folder.iterdir())
    except (OSError, DataError):
        return None
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        return None
    size = 0
    for path in paths:
        with suppress(OSError):  # gone meanwhile
            size += path.stat().st_size
    return Kept(folder, about, size, used)


def _folders(path: Path) -> list[Path]:
    """Return the folders in a folder; none where another run has just removed it."""
    try:
        with os.scandir(path) as entries:
            return [Path(each.path) for each in entries if each.is_dir()]
    except OSError:
        return []
