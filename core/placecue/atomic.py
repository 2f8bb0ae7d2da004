"""Files that are whole or not there at all.

What is being written has a name of its own beside the final one, and a lock that lasts as long as
its process: what a killed run has left is known by that, and removed by the next one.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from placecue.errors import DataError, UsageError

#: What unfinished files end in; they also begin with a point.
SUFFIX = ".placecue.part"

Check = Callable[[Path], None]
_checks: list[Check] = []
_unfinished: set[Part] = set()


class Part:
    """A file under a temporary name, which takes its own when it is complete.

    Parameters
    ----------
    path : Path
        The file to be; one that is there is replaced. Missing folders are made, and parts that
        killed runs have left beside it are removed.

    Attributes
    ----------
    temporary : Path
        Where to write; an empty file at first.

    Raises
    ------
    UsageError
        If the file cannot be written there, or may not be (:func:`checked_by`).
    """

    def __init__(self, path: Path) -> None:
        _check(path)
        self.path = path
        try:
            if path.is_dir():
                raise IsADirectoryError(21, "it is a folder")
            remove_dead_parts(made(path.parent))
            self.temporary, self._lock = _locked(path)
        except OSError as error:
            raise _unwritable(path, error) from error
        self._open = True
        _unfinished.add(self)

    def commit(self) -> None:
        """Give the file its name.

        Raises
        ------
        OSError
            If that cannot be done.
        UsageError
            If it may not be done (:func:`checked_by`).
        """
        _check(self.path)
        self.temporary.replace(self.path)
        self._let_go()

    def abort(self) -> None:
        """Remove what was written, unless it has its name already."""
        if self._open:
            self.temporary.unlink(missing_ok=True)
            self._let_go()

    def _let_go(self) -> None:
        self._open = False
        _unfinished.discard(self)
        os.close(self._lock)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside ``path`` that takes its name when the block succeeds.

    Raises
    ------
    UsageError
        If the file cannot be written there, or may not be (:func:`checked_by`).
    DataError
        If writing fails later, as on a full disk.
    """
    part = Part(path)
    try:
        yield part.temporary
        part.commit()
    except OSError as error:
        raise DataError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        part.abort()


@contextmanager
def checked_by(check: Check) -> Iterator[None]:
    """Ask a function before any file is written in this process, within a ``with`` block.

    Parameters
    ----------
    check : callable
        Takes the path of the file to be, and raises PlacecueError where it may not be written.
    """
    _checks.append(check)
    try:
        yield
    finally:
        _checks.remove(check)


def remove_dead_parts(folder: Path) -> None:
    """Remove what killed runs have left in a folder; parts of runs that are alive stay."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.startswith(".") and entry.name.endswith(SUFFIX):
                _remove_if_dead(Path(entry.path))


def abandon() -> None:
    """Remove all unfinished files of this process, which is about to end."""
    for part in list(_unfinished):
        with suppress(OSError):
            part.temporary.unlink(missing_ok=True)


def made(folder: Path) -> Path:
    """Make a folder with its parents and return it.

    Raises
    ------
    UsageError
        If it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _unwritable(folder, error) from error
    return folder


def write_text(path: Path, text: str) -> Path:
    """Write a text file, whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return path


def write_json(path: Path, data: Any) -> Path:
    """Write a JSON file, whole or not at all."""
    return write_text(path, json.dumps(data, indent=2, ensure_ascii=False) + "\n")


def _check(path: Path) -> None:
    for check in _checks:
        check(path)


def _locked(path: Path) -> tuple[Path, int]:
    """Make an empty file beside a path and lock it; return both."""
    while True:
        # Names have at most 255 bytes.
        name = f".{path.name[:50]}.{os.urandom(4).hex()}{SUFFIX}"
        temporary = path.with_name(name)
        lock = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
        with suppress(OSError):  # a file system without locks: its dead parts stay
            fcntl.flock(lock, fcntl.LOCK_EX)
        if os.fstat(lock).st_nlink:
            return temporary, lock
        os.close(lock)  # another run took it for dead before it was locked


def _remove_if_dead(part: Path) -> None:
    with suppress(OSError):  # gone meanwhile, or alive
        lock = os.open(part, os.O_RDWR | os.O_NONBLOCK | os.O_NOFOLLOW)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            part.unlink()
        finally:
            os.close(lock)


def _unwritable(path: Path, error: OSError) -> UsageError:
    reason = error.strerror or error
    return UsageError(f"cannot write to {path}: {reason}; choose another place with out=")
