"""Whether ``out=`` may be written: checked here for all commands, before anything is read."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path
from typing import Any

from placecue.atomic import checked_by, remove_dead_parts
from placecue.checks import check_flag
from placecue.commands.inputs import Inputs
from placecue.commands.paths import path_of
from placecue.errors import UsageError

#: How many of the files that are in the way are named.
NAMED = 3


@contextmanager
def guarded(
    config: Mapping[str, Any], writes: Sequence[str] | None, resumes: str | None = None
) -> Iterator[None]:
    """Run a command in a ``with`` block that keeps what it reads, and what others have written.

    As soon as the block has written anything, files of an older run are removed that it has not
    replaced. What killed runs have left is removed at once.

    Parameters
    ----------
    config : mapping
        The config of the command: ``out``, ``overwrite``, and all that names what it reads.
    writes : sequence of str, or None
        The files that it writes into the folder ``out``; None where ``out`` is a file, or null for
        no file.
    resumes : str, optional
        A folder ``out`` that holds a file of this name is gone on with.

    Raises
    ------
    UsageError
        If ``out`` is, holds, or would replace something that is read; or if results are there
        and ``overwrite`` is not true.
    """
    inputs = Inputs(config)
    with checked_by(inputs.check):
        if writes is None:
            if config.get("out") is not None:
                _check_file(path_of(config, "out"), inputs, _overwrites(config))
            yield
            return
        # What knows the files of a run imports much that other commands do without.
        from placecue.commands.files import of_older_run
        from placecue.evaluation.training_report import SEARCHES

        out = path_of(config, "out")
        if resumes is not None and (out / resumes).is_file():
            _check_not_read(out, inputs)
            yield
            return
        folders = {out, *((out / name).parent for name in writes)}
        for folder in folders:
            remove_dead_parts(folder)
            remove_dead_parts(folder / SEARCHES)
        older = [path for folder in folders for path in of_older_run(folder)]
        written = [out / name for name in writes]
        _check_folder(out, inputs, _overwrites(config), {*older, *written})
        with _leaving_nothing_older(older, written):
            yield


def _overwrites(config: Mapping[str, Any]) -> bool:
    overwrite: bool = config.get("overwrite", False)
    check_flag("overwrite", overwrite)
    return overwrite


def _check_file(out: Path, inputs: Inputs, overwrite: bool) -> None:
    _check_not_read(out, inputs)
    if not os.path.lexists(out) or out.is_dir():  # which the writer says
        return
    _check_not_around(out, inputs)
    if out.exists() and not out.is_file():
        raise UsageError(f"out={out} is no ordinary file; give another out=")
    if not overwrite:
        raise UsageError(f"out={out} is there already: {_way_out('replace it')}")


def _check_folder(out: Path, inputs: Inputs, overwrite: bool, written: Iterable[Path]) -> None:
    _check_not_read(out, inputs)
    for path in sorted(written):
        named = inputs.named(path)
        if named is not None:
            raise UsageError(
                f"out={out} holds {path.relative_to(out)}, which {named} reads: give another out="
            )
    found = list(islice(_files(out), NAMED + 1))
    if not found:
        return
    _check_not_around(out, inputs)
    if not overwrite:
        names = [str(path.relative_to(out)) for path in found[:NAMED]]
        more = ", ..." if len(found) > NAMED else ""
        raise UsageError(
            f"out={out} is not empty ({', '.join(names)}{more}): {_way_out('replace results')}"
        )


def _check_not_read(out: Path, inputs: Inputs) -> None:
    named = inputs.named(out)
    if named is not None:
        raise UsageError(f"out={out} is what {named} reads: give another out=")


def _check_not_around(out: Path, inputs: Inputs) -> None:
    named = inputs.around(out)
    if named is not None:
        raise UsageError(
            f"out={out} is there already and lies in {named}, which is read: give another out="
        )


def _way_out(what: str) -> str:
    return f"give overwrite=true to {what}, or another out="


def _files(folder: Path) -> Iterator[Path]:
    for parent, folders, names in os.walk(folder):
        folders.sort()
        yield from (Path(parent) / name for name in sorted(names))


@contextmanager
def _leaving_nothing_older(older: Iterable[Path], written: Iterable[Path]) -> Iterator[None]:
    """Remove what is of an older run once the block has put anything beside it."""
    before = {path: _state(path) for path in (*older, *written)}
    try:
        yield
    finally:
        untouched = {path for path, state in before.items() if _state(path) == state}
        if len(untouched) < len(before):
            for path in untouched.intersection(older):
                path.unlink(missing_ok=True)
                with suppress(OSError):  # other files are there
                    path.parent.rmdir()


def _state(path: Path) -> tuple[int, ...] | None:
    """Return what tells a file from the one that takes its place."""
    try:
        found = path.lstat()
    except OSError:
        return None
    # An inode may be used again, but not at the same time.
    return found.st_dev, found.st_ino, found.st_ctime_ns
