"""The files of a recording: in a folder, or in a tar that stays packed."""

from __future__ import annotations

import bz2
import gzip
import hashlib
import io
import lzma
import os
import posixpath
import tarfile
import tempfile
import zlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from io import BufferedReader
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.faults import Faults

PACKED: dict[bytes, Any] = {b"\x1f\x8b": gzip.open, b"BZh": bz2.open, b"\xfd7zXZ": lzma.open}
DAMAGED = "places in the tar are cut or damaged; what lies there is left out"


class Archive(ABC):
    """Files by their names relative to the archive, with ``/`` between folders.

    Only names are held; a context manager.

    Parameters
    ----------
    path : Path
        Where it lies.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    @abstractmethod
    def names(self) -> list[str]:
        """Return the names of all files, sorted."""

    @abstractmethod
    def open(self, name: str) -> BufferedReader:
        """Open a file to be read at any position; it may raise OSError or KeyError."""

    def read(self, name: str) -> bytes:
        """Return all of a file.

        Raises
        ------
        UnusableObservation
            If it is not there, or cannot be read to its end.
        """
        try:
            with self.open(name) as file:
                return file.read()
        except (OSError, KeyError, tarfile.TarError) as error:
            raise UnusableObservation(f"{name} in {self.path} cannot be read: {error}") from error

    def open_text(self, name: str) -> BufferedReader:
        """Open a file that must be readable.

        Raises
        ------
        DataError
            If it is not.
        """
        try:
            return self.open(name)
        except (OSError, KeyError, tarfile.TarError) as error:
            raise DataError(f"{name} in {self.path} cannot be read: {error}") from error

    def digest(self, names: Iterable[str], root: str = "") -> str:
        """Return a digest of files and their names below ``root``; the same packed or not."""
        digest = hashlib.sha256()
        for name in names:
            digest.update(posixpath.relpath(name, root or ".").encode("utf-8", "surrogateescape"))
            try:
                with self.open(name) as file:
                    digest.update(hashlib.file_digest(file, "sha256").digest())
            except (OSError, KeyError, tarfile.TarError):
                digest.update(b"unreadable")
        return digest.hexdigest()

    def close(self) -> None:  # noqa: B027 - a folder has nothing to close
        """Let go of what is open."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class Folder(Archive):
    """A folder and all folders in it."""

    def names(self) -> list[str]:
        """Return the names of all files, sorted."""
        return sorted(
            (Path(folder) / file).relative_to(self.path).as_posix()
            for folder, _, files in os.walk(self.path)
            for file in files
        )

    def open(self, name: str) -> BufferedReader:
        """Open a file."""
        return (self.path / name).open("rb")


class Tar(Archive):
    """A tar, plain or compressed with gzip, bzip2 or xz.

    A plain tar is read where it lies. A compressed one cannot be read at any position, so it is
    decompressed once into a temporary file without a name. A cut or damaged tar gives the
    members that are whole.

    Parameters
    ----------
    path : Path
        The file.
    faults : Faults
        Takes what is cut or damaged.

    Raises
    ------
    DataError
        If it cannot be read, or holds no file.
    """

    def __init__(self, path: Path, faults: Faults) -> None:
        super().__init__(path)
        self._file = _plain(path, faults)
        try:
            tarfile.TarFile(fileobj=self._file)
            self._file.seek(0)
            # Past the first header, whatever makes no sense is skipped up to the next header.
            self._tar = tarfile.TarFile(fileobj=self._file, ignore_zeros=True)
        except tarfile.TarError as error:
            self._file.close()
            raise DataError(f"{path} is neither a folder nor a tar: {error}") from error
        self._members = {posixpath.normpath(each.name): each for each in self._index(faults)}

    def names(self) -> list[str]:
        """Return the names of all files, sorted."""
        return sorted(self._members)

    def open(self, name: str) -> BufferedReader:
        """Open a member."""
        file = self._tar.extractfile(self._members[name])
        assert isinstance(file, BufferedReader)  # members that are no files were left out
        return file

    def close(self) -> None:
        """Close the tar."""
        self._tar.close()
        self._file.close()

    def _index(self, faults: Faults) -> Iterator[tarfile.TarInfo]:
        """Yield the members that are files, whatever lies between them."""
        size = self._file.seek(0, os.SEEK_END)
        expected: int | None = 0  # None within what is already known to be damaged
        while True:
            try:
                member = self._tar.next()
            except (tarfile.TarError, OSError) as error:
                if expected is not None:
                    faults.add(DAMAGED, f"byte {self._tar.offset}, {error}")
                self._tar.offset += tarfile.BLOCKSIZE
                expected = None
                if self._tar.offset >= size:
                    return
                continue
            if member is None:
                return
            if expected is not None and expected < member.offset and self._is_damaged(expected):
                faults.add(DAMAGED, f"byte {expected}")
            expected = self._tar.offset
            if member.isreg():
                yield member

    def _is_damaged(self, position: int) -> bool:
        """Tell whether no header stands where one should; padding and notes are no damage."""
        self._file.seek(position)
        try:
            tarfile.TarInfo.frombuf(self._file.read(tarfile.BLOCKSIZE), "utf-8", "surrogateescape")
        except tarfile.HeaderError:
            self._file.seek(position)
            return any(self._file.read(tarfile.BLOCKSIZE))
        return False


def open_archive(path: str, faults: Faults) -> Archive:
    """Open a folder or a tar.

    Parameters
    ----------
    path : str
        ``~`` is the home directory.
    faults : Faults
        Takes what is cut or damaged.

    Raises
    ------
    UsageError
        If there is nothing.
    DataError
        If a file is no tar.
    """
    found = Path(path).expanduser()
    if found.is_dir():
        return Folder(found)
    if not found.exists():
        raise UsageError(f"there is no folder and no tar {path}; check the path")
    return Tar(found, faults)


def _plain(path: Path, faults: Faults) -> IO[bytes]:
    """Open a tar, decompressed if need be."""
    try:
        file = path.open("rb")
        magic = file.read(max(map(len, PACKED)))
        file.seek(0)
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error.strerror}") from error
    for begin, unpack in PACKED.items():
        if magic.startswith(begin):
            with file:
                return _unpacked(unpack(file), faults)
    return file


def _unpacked(packed: Any, faults: Faults) -> IO[bytes]:
    """Return the content of a compressed file as a temporary file."""
    plain = tempfile.TemporaryFile()  # noqa: SIM115 - closed by the archive that it becomes
    try:
        # Small pieces, so that little is lost before a cut.
        while piece := packed.read1(io.DEFAULT_BUFFER_SIZE):
            plain.write(piece)
    except (EOFError, OSError, zlib.error, lzma.LZMAError) as error:
        faults.add(DAMAGED, f"byte {plain.tell()} of the content, {error}")
    plain.seek(0)
    return plain
