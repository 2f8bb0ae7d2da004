"""What a command reads, which it must never write onto."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from placecue.commands.features import cache_of
from placecue.errors import UsageError

#: What stands under these keys is a name, never a path.
NAMES = ("plugin", "label_map", "unmapped_labels", "encoding", "topic", "on_error")
#: Files are told by these, whatever they are called: device and inode.
Identity = tuple[int, int]


class Inputs:
    """The files and folders that a config names, out= apart, known by device and inode.

    Parameters
    ----------
    config : mapping
        The config of a command. Whatever in it is the path of something that is there counts as
        being read, since plugins call their parameters as they like.
    """

    def __init__(self, config: Mapping[str, Any]) -> None:
        # The cache is looked up below, and out= may be made of other keys, such as out_dir.
        read = {k: v for k, v in config.items() if k != "cache" and not k.startswith("out")}
        self._named: dict[Identity, str] = {}
        # Keys near the top are what was typed: log rather than source.path.
        for key, path in sorted(_paths(read), key=lambda found: found[0].count(".")):
            found = identity(path)
            if found is not None and path != Path("/"):  # a separator, not all there is
                self._named.setdefault(found, f"{key}={path}")
        with suppress(UsageError):  # said where the cache is opened
            cache, _ = cache_of(config)
            found = identity(cache) if cache is not None else None
            if found is not None:
                self._named.setdefault(found, f"cache.folder={cache}")

    def named(self, path: Path) -> str | None:
        """Return the key and value that name a file or folder, or None.

        Parameters
        ----------
        path : Path
            Another name of it will do: a link of either kind, in other letters where case does not
            matter.
        """
        found = identity(path)
        return None if found is None else self._named.get(found)

    def around(self, path: Path) -> str | None:
        """Return the key and value of the nearest folder that is read and holds a path, or None."""
        found = (self.named(folder) for folder in path.absolute().resolve().parents)
        return next((named for named in found if named is not None), None)

    def check(self, path: Path) -> None:
        """Refuse to write a file that is read.

        Raises
        ------
        UsageError
            If it is.
        """
        named = self.named(path)
        if named is not None:
            raise UsageError(f"cannot write {path}: {named} reads it; give another out=")


def identity(path: Path) -> Identity | None:
    """Return device and inode of what a path leads to; None where that is nothing."""
    try:
        found = path.stat()
    except (OSError, ValueError):  # nothing there, or no path at all
        return None
    return found.st_dev, found.st_ino


def _paths(value: Any, key: str = "") -> Iterator[tuple[str, Path]]:
    """Yield what may be paths in a config, with their keys."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            if name not in NAMES:
                yield from _paths(inner, f"{key}.{name}" if key else str(name))
    elif isinstance(value, (list, tuple)):
        for inner in value:
            yield from _paths(inner, key)
    elif isinstance(value, (str, Path)) and str(value):
        yield key, Path(value)
        with suppress(RuntimeError):  # a user without a home
            if str(value).startswith("~"):
                yield key, Path(value).expanduser()
    elif isinstance(value, int) and "." not in key:
        yield key, Path(str(value))  # a name of digits alone, such as a year
