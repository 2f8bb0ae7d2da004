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
from collections.abc import Iterable, Iterator, Mapping
from io import BufferedReader
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.faults import Faults
from placecue.limits import current_limits

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

    @abstractmethod
    def size(self, name: str) -> int:
        """Return the size of a file when it is read, bytes; it may raise what opening does."""

    def read(self, name: str) -> bytes:
        """Return all of a file.

        Raises
        ------
        UnusableObservation
            If it is not there, cannot be read to its end, or is larger than ``limits.file``.
        """
        try:
            size = self.size(name)
            if over := current_limits().over("file", size):
                raise UnusableObservation(f"{name} in {self.path} has {size} bytes, {over}")
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
    """A folder and all folders in it; links to folders are followed, once each.

    Parameters
    ----------
    path : Path
        The folder.
    faults : Faults
        Takes links that lead nowhere.

    Raises
    ------
    DataError
        If it holds more files than ``limits.members``.
    """

    def __init__(self, path: Path, faults: Faults) -> None:
        super().__init__(path)
        self._faults = faults
        self._names: list[str] | None = None

    def names(self) -> list[str]:
        """Return the names of all files, sorted."""
        if self._names is None:
            self._names = self._found()
        return list(self._names)

    def _found(self) -> list[str]:
        found: list[str] = []
        for folder, inner, files in os.walk(self.path, followlinks=True):
            inner[:] = [name for name in inner if not _leads_back(Path(folder) / name)]
            for lost in [name for name in files if _leads_nowhere(Path(folder) / name)]:
                files.remove(lost)
                where = (Path(folder) / lost).relative_to(self.path).as_posix()
                self._faults.add("links lead nowhere and were left out", where)
            found += ((Path(folder) / file).relative_to(self.path).as_posix() for file in files)
            check_members(self.path, len(found))
        return sorted(found)

    def size(self, name: str) -> int:
        """Return the size of a file, bytes."""
        return (self.path / name).stat().st_size

    def open(self, name: str) -> BufferedReader:
        """Open a file."""
        return (self.path / name).open("rb")


def _leads_nowhere(path: Path) -> bool:
    """Tell whether a name without an ending, as folders have it, is a link to nothing."""
    return not path.suffix and path.is_symlink() and not path.exists()


def _leads_back(folder: Path) -> bool:
    """Tell whether a folder is a link to one that it lies in, which would never end."""
    return folder.is_symlink() and folder.parent.resolve().is_relative_to(folder.resolve())


def check_members(path: Path, count: int) -> None:
    """Refuse a folder or tar with more files than one may have.

    Raises
    ------
    DataError
        If it has too many.
    """
    over = current_limits().over("members", count)
    if over:
        raise DataError(f"{path} holds {count} files, {over}")


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
        self._members: dict[str, tarfile.TarInfo] = {}
        for each in self._index(faults):
            self._members[posixpath.normpath(each.name)] = each
            check_members(path, len(self._members))
        self._follow_links(faults)

    def names(self) -> list[str]:
        """Return the names of all files, sorted."""
        return sorted(self._members)

    def size(self, name: str) -> int:
        """Return the size of a member, bytes."""
        return self._members[name].size

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
            if member.isreg() or member.islnk() or member.issym():
                yield member

    def _follow_links(self, faults: Faults) -> None:
        """Put the files that links lead to in their places, those of linked folders too."""
        links = {name: each for name, each in self._members.items() if not each.isreg()}
        files = {name: each for name, each in self._members.items() if each.isreg()}
        for name, link in links.items():
            for inner, member in _led_to(name, link, links, files):
                self._members[inner] = member
            if not self._members[name].isreg():
                del self._members[name]
                within = any(each.startswith(f"{name}/") for each in self._members)
                faults.add("links in the tar lead nowhere and were left out", name, int(not within))

    def _is_damaged(self, position: int) -> bool:
        """Tell whether no header stands where one should; padding and notes are no damage."""
        self._file.seek(position)
        try:
            tarfile.TarInfo.frombuf(self._file.read(tarfile.BLOCKSIZE), "utf-8", "surrogateescape")
        except tarfile.HeaderError:
            self._file.seek(position)
            return any(self._file.read(tarfile.BLOCKSIZE))
        return False


def _led_to(
    name: str,
    link: tarfile.TarInfo,
    links: Mapping[str, tarfile.TarInfo],
    files: Mapping[str, tarfile.TarInfo],
) -> Iterator[tuple[str, tarfile.TarInfo]]:
    """Yield the files that a link stands for, with the names that it gives them."""
    target, passed = name, set()
    while (step := links.get(target)) is not None and target not in passed:
        passed.add(target)
        # A symbolic link is given from where it lies, a hard one from the beginning of the tar.
        start = posixpath.dirname(target) if step.issym() else ""
        target = posixpath.normpath(posixpath.join(start, step.linkname))
    if target in files:
        yield name, files[target]
    for each, member in files.items():
        if each.startswith(f"{target}/"):
            yield f"{name}/{each[len(target) + 1 :]}", member


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
        return Folder(found, faults)
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


def _write(plain: IO[bytes], piece: bytes) -> None:
    try:
        plain.write(piece)
        plain.flush()
    except OSError as error:
        plain.close()
        raise DataError(
            f"there is no room to unpack the tar in {tempfile.gettempdir()} ({error.strerror}): "
            "make room, name another folder with TMPDIR, or unpack it yourself"
        ) from error


def _unpacked(packed: Any, faults: Faults) -> IO[bytes]:
    """Return the content of a compressed file as a temporary file."""
    plain = tempfile.TemporaryFile()  # noqa: SIM115 - closed by the archive that it becomes
    try:
        # Small pieces, so that little is lost before a cut.
        while piece := packed.read1(io.DEFAULT_BUFFER_SIZE):
            _write(plain, piece)
    except (EOFError, OSError, zlib.error, lzma.LZMAError) as error:
        faults.add(DAMAGED, f"byte {plain.tell()} of the content, {error}")
    plain.seek(0)
    return plain
