"""Files as sources read them: opened with one clear line if they cannot be, and digested."""

from __future__ import annotations

import codecs
import gzip
import hashlib
import json
import logging
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

from placecue.errors import DataError, UsageError

log = logging.getLogger(__name__)

GZIP_MAGIC = b"\x1f\x8b"


def existing(path: str) -> Path:
    """Return the path of a file that is there, or raise UsageError.

    Parameters
    ----------
    path : str
        A file; ``~`` is the home directory.
    """
    found = Path(path).expanduser()
    if found.is_dir():
        raise UsageError(f"{path} is a folder; name a file in it")
    if not found.exists():
        raise UsageError(f"there is no file {path}; check the path")
    return found


def open_bytes(path: Path) -> IO[bytes] | gzip.GzipFile:
    """Open a file, plain or gzip by its first bytes, whatever it is called.

    Raises
    ------
    DataError
        If it cannot be read.
    """
    try:
        with path.open("rb") as file:
            packed = file.read(len(GZIP_MAGIC)) == GZIP_MAGIC
        return gzip.open(path) if packed else path.open("rb")
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error.strerror}") from error


def read_bytes(path: Path) -> bytes:
    """Return all of a small file.

    Raises
    ------
    DataError
        If it cannot be read.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error.strerror}") from error


def lines(path: Path, longest: int = 1 << 20) -> Iterator[tuple[int, bytes]]:
    """Yield the lines of a text file with their numbers from 1.

    A gzip file that is cut or damaged gives the lines before the damage, and one warning.

    Parameters
    ----------
    path : Path
        The file, plain or gzip.
    longest : int
        Lines with more bytes come in pieces, so that a file without lines fills no memory.
    """
    number = 0
    with open_bytes(path) as file:
        try:
            while line := file.readline(longest):
                number += 1
                yield number, line.removeprefix(codecs.BOM_UTF8) if number == 1 else line
        except (EOFError, gzip.BadGzipFile, zlib.error) as error:
            log.warning(f"{path} is cut or damaged after line {number} ({error}); used up to there")


def digest_of(parameters: Mapping[str, Any], paths: Sequence[Path]) -> str:
    """Return a digest of parameters (plain data) and of what is in files.

    Parameters
    ----------
    parameters : mapping of str to plain data
        What changes the observations, besides the files.
    paths : sequence of Path
        Files, in an order that matters; their names do not.
    """
    digest = hashlib.sha256(json.dumps(parameters, sort_keys=True, default=str).encode())
    for path in paths:
        try:
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        except OSError as error:
            raise DataError(f"{path} cannot be read: {error.strerror}") from error
    return digest.hexdigest()
