"""Files that may have come from anybody: opened without waiting, and only if they are plain files.

Opening a pipe waits for whoever writes into it, and a device or a link gives what no one put into
the folder.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path

from placecue.errors import DataError

_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0)
_FLAGS |= getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


@contextmanager
def opened(path: Path) -> Iterator[BufferedReader]:
    """Open a plain file for reading.

    Raises
    ------
    DataError
        If there is none, it is a link, a folder, a pipe or a device, or it cannot be read.
    """
    try:
        _check_plain(path, os.lstat(path))  # before it is opened: opening a device may do something
        descriptor = os.open(path, _FLAGS)
    except FileNotFoundError as error:
        raise DataError(f"{path} is missing") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise DataError(f"{path} cannot be read: {reason}") from error
    with os.fdopen(descriptor, "rb") as file:
        _check_plain(path, os.fstat(descriptor))
        yield file


def size_of(file: BufferedReader) -> int:
    """Return the size of an open file, bytes."""
    return os.fstat(file.fileno()).st_size


def read_bytes(path: Path, limit: int) -> bytes:
    """Return what is in a plain file of no more than ``limit`` bytes.

    Raises
    ------
    DataError
        If :func:`opened` raises it, or the file is larger.
    """
    with opened(path) as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise DataError(f"{path} is larger than the {limit / 2**20:.0f} MiB that it may have")
    return data


def _check_plain(path: Path, status: os.stat_result) -> None:
    if stat.S_ISLNK(status.st_mode):
        raise DataError(f"{path} is a link: put the file itself into its place")
    if not stat.S_ISREG(status.st_mode):
        raise DataError(f"{path} is no plain file")
