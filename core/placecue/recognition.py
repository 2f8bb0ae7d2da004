"""What lies at a path, as far as it takes to tell one format from another."""

from __future__ import annotations

import gzip
import tarfile
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import ClassVar

#: How many bytes of a file are looked at, unpacked.
HEAD = 65536
#: How many names of a folder or an archive are looked at.
NAMES = 500
GZIP = b"\x1f\x8b"


@dataclass(frozen=True, slots=True)
class Found:
    """A file or folder that somebody wants to have read.

    Parameters
    ----------
    path : Path
        Where it is.
    head : bytes
        How a file begins, at most 64 kB, unpacked where it is gzip; empty for a folder.
    names : tuple of str
        Files in a folder or a tar, relative to it, with ``/``; the first few hundred.

    Attributes
    ----------
    BY_CONTENT, BY_SHAPE, NOT_AT_ALL : int
        How sure a source is that it reads this: by what it holds, by its name and shape, or not.
    """

    BY_CONTENT: ClassVar[int] = 2
    BY_SHAPE: ClassVar[int] = 1
    NOT_AT_ALL: ClassVar[int] = 0

    path: Path
    head: bytes = b""
    names: tuple[str, ...] = ()

    @property
    def suffix(self) -> str:
        """The end of the name, in small letters; empty for a folder."""
        return "" if self.path.is_dir() else self.path.suffix.lower()


def look(path: Path) -> Found:
    """Look at what lies at a path.

    Parameters
    ----------
    path : Path
        A file or a folder.

    Raises
    ------
    OSError
        If it is not there, or cannot be read.
    """
    if path.is_dir():
        return Found(path, names=tuple(islice(_files(path), NAMES)))
    head = _head(path)
    return Found(path, head, tuple(islice(_members(path, head), NAMES)))


def _files(folder: Path) -> Iterator[str]:
    """Yield names level by level, so that one full subfolder does not hide the others."""
    folders = [folder]
    for each in folders:  # grows while it is walked
        with suppress(OSError):
            for entry in islice(sorted(each.iterdir()), NAMES // 5):
                if entry.is_dir():
                    folders.append(entry)
                else:
                    yield entry.relative_to(folder).as_posix()


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        head = file.read(HEAD)
    if not head.startswith(GZIP):
        return head
    with suppress(OSError, EOFError, zlib.error), gzip.open(path) as packed:
        return packed.read(HEAD)
    return head


def _members(path: Path, head: bytes) -> Iterator[str]:
    if head[257:262] != b"ustar" and not path.name.lower().endswith((".tar", ".tbz2", ".txz")):
        return
    with suppress(tarfile.TarError, OSError, EOFError, zlib.error), tarfile.open(path) as archive:
        yield from (member.name.removeprefix("./") for member in archive if member.isfile())
