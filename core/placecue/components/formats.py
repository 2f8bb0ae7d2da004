"""Which source reads a file or folder: the sources themselves say, by what is in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path

from placecue.components.hooks import Component
from placecue.components.registry import Registry
from placecue.errors import FOREIGN, UsageError
from placecue.recognition import Found, look


def source_of(path: Path, registry: Registry) -> str | None:
    """Return the name of the source that reads what lies at a path.

    Parameters
    ----------
    path : Path
        A file or a folder.
    registry : Registry
        Its sources are asked.

    Returns
    -------
    str or None
        None where nothing lies there, or it cannot be read: opening it says why.

    Raises
    ------
    UsageError
        If no source knows it, or several claim it with equal right.
    """
    try:
        found = look(path)
    except OSError:
        return None
    sure = {each.name: _asked(each, found) for each in _sources(registry)}
    most = max(sure.values(), default=0)
    names = sorted(name for name, how in sure.items() if how == most)
    if most <= 0:
        raise UsageError(_unknown(path, found, registry))
    if len(names) > 1:
        listed = " or ".join(f"source={name}" for name in names)
        raise UsageError(f"{path} could be of several formats: say which with {listed}")
    return names[0]


def source_of_all(paths: Sequence[Path], registry: Registry) -> str | None:
    """Return the one source that reads all paths; None where they are not all there.

    Raises
    ------
    UsageError
        See :func:`source_of`; or if they are of several formats.
    """
    found = {path: source_of(path, registry) for path in paths}
    names = {name for name in found.values() if name is not None}
    if len(names) > 1:
        told = ", ".join(f"{path} is {name}" for path, name in found.items() if name)
        raise UsageError(f"logs of several formats ({told}): placecue convert makes MCAP of each")
    return next(iter(names), None)


def _sources(registry: Registry) -> Iterator[Component]:
    for each in registry:
        if each.component.kind == "source" and each.component.recognise:
            yield each.component


def _asked(component: Component, found: Found) -> int:
    module, _, function = component.recognise.partition(":")
    try:
        return int(getattr(import_module(module), function)(found))
    except FOREIGN:  # a plugin's fault must not keep others from reading
        return 0


def _unknown(path: Path, found: Found, registry: Registry) -> str:
    looked = "; ".join(f"{each.name}: {each.summary}" for each in _sources(registry))
    if path.is_dir():
        what = f"a folder with {', '.join(found.names[:3]) or 'no file'}"
    else:
        what = f"a file that begins with {found.head[:8]!r}" if found.head else "an empty file"
    return f"{path} is nothing that placecue knows ({what}); looked for {looked}; or give source="
