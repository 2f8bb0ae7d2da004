"""Where the messages of a bag lie on disk."""

from __future__ import annotations

import struct
from pathlib import Path

from placecue.errors import DataError
from placecue.logs.mcap.linear import MAGIC

BAG_MAGIC = b"#ROSBAG V"
SQLITE_MAGIC = b"SQLite format 3\x00"
#: Endings of the storage files of ROS 2 bags.
STORAGES = (".db3", ".mcap")


def storage_of(path: Path) -> Path:
    """Return what to read of a bag: a ROS 1 bag, the folder of a ROS 2 bag, or a file of it.

    Parameters
    ----------
    path : Path
        What the user named. In a folder without metadata, as a recorder that was killed leaves
        it, the only storage file is taken.

    Raises
    ------
    DataError
        If it is no bag.
    """
    if path.is_dir():
        return path if (path / "metadata.yaml").is_file() else _only_file(path)
    try:
        with path.open("rb") as file:
            start = file.read(16)
    except FileNotFoundError as error:
        raise DataError(f"no such bag: {path}") from error
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}") from error
    if start.startswith(MAGIC):
        raise DataError(f"{path} is an MCAP log and no bag; read it with source=mcap")
    if start.startswith(BAG_MAGIC) or (start == SQLITE_MAGIC and path.suffix == ".db3"):
        return path
    hint = "; give it the ending .db3" if start == SQLITE_MAGIC else f"; it begins with {start!r}"
    raise DataError(f"{path} is neither a ROS 1 bag nor a storage file (.db3) of a ROS 2 bag{hint}")


def files_of(storage: Path) -> list[Path]:
    """Return the files of a bag in order of name."""
    if storage.is_file():
        return [storage]
    return sorted(path for path in storage.iterdir() if path.is_file())


def missing_bytes(path: Path) -> int:
    """Return how many bytes a sqlite file lacks by its own header; 0 for other files.

    The size of a page is at byte 16, their number at 28, which is right where the counters at 24
    and 92 agree (https://www.sqlite.org/fileformat.html, section 1.3).
    """
    with path.open("rb") as file:
        head = file.read(100)
    if len(head) < 100 or not head.startswith(SQLITE_MAGIC):
        return 0
    page, counter, pages = struct.unpack_from(">H6xII", head, 16)
    (valid,) = struct.unpack_from(">I", head, 92)
    size = (65536 if page == 1 else page) * pages
    return max(size - path.stat().st_size, 0) if counter == valid else 0


def _only_file(folder: Path) -> Path:
    files = sorted(path for path in folder.iterdir() if path.suffix in STORAGES)
    if len(files) == 1:
        return files[0]
    if files:
        raise DataError(
            f"{folder} has {len(files)} storage files and no metadata.yaml to order them; "
            f"name one of {', '.join(path.name for path in files)}, or run: ros2 bag reindex"
        )
    bags = sorted(path.name for path in folder.glob("*.bag"))
    advice = f"name one of {', '.join(bags)}" if bags else "name the folder that has them"
    raise DataError(f"{folder} is no ROS 2 bag: no metadata.yaml and no .db3 file; {advice}")
