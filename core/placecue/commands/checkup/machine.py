"""The machine: where results, features and temporary files go, the terminal, the GPU."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from placecue.commands.checkup.finding import Finding
from placecue.commands.features import cache_of
from placecue.errors import PlacecueError

#: With less room than this, bytes, archives and sweeps may not fit.
LITTLE = 10**9


def machine(config: Mapping[str, Any]) -> Iterator[Finding]:
    """Look at the machine."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    yield Finding("ok", "processors", f"{cores}")
    yield _gpu()
    yield _cache(config)
    yield _temporary()
    yield _here()
    encoding = getattr(sys.stdout, "encoding", None) or "none"
    terminal = "a terminal" if sys.stdout.isatty() else "no terminal"
    yield Finding("ok", "output", f"{encoding}, {terminal}")


def _gpu() -> Finding:
    cards = sorted(Path("/dev").glob("nvidia[0-9]*"))
    if cards or shutil.which("nvidia-smi"):
        return Finding("ok", "GPU", f"{len(cards) or 'some'}; placecue computes on processors")
    return Finding("ok", "GPU", "none; placecue computes on processors and needs none")


def _cache(config: Mapping[str, Any]) -> Finding:
    try:
        folder, most = cache_of(config)
    except PlacecueError as error:
        return Finding("wrong", "cache", str(error))
    if folder is None:
        return Finding("note", "cache", "none, features are extracted anew in each run",
                       "cache.folder=PATH keeps them")  # fmt: skip
    if not _writable(folder):
        mend = "give cache.folder=PATH, or set PLACECUE_CACHE"
        return Finding("wrong", "cache", f"{folder} cannot be written", mend)
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    limit = "without limit" if most is None else f"of at most {most:.0f} GB"
    return Finding("ok", "cache", f"{folder}, {size / 1e9:.2f} GB {limit}")


def _temporary() -> Finding:
    try:
        folder = Path(tempfile.gettempdir())
    except OSError as error:
        return Finding("wrong", "temporary files", str(error), "set TMPDIR to a folder of yours")
    free = shutil.disk_usage(folder).free
    told = f"{folder}, {free / 1e9:.1f} GB free"
    if free > LITTLE:
        return Finding("ok", "temporary files", told)
    return Finding("note", "temporary files", told, "set TMPDIR to a folder with more room")


def _here() -> Finding:
    folder = Path.cwd()
    if _writable(folder):
        return Finding("ok", "working folder", f"{folder}")
    return Finding("note", "working folder", f"{folder} cannot be written", "give out=PATH")


def _writable(folder: Path) -> bool:
    """Tell whether a folder can be written, or made."""
    there = next(each for each in (folder, *folder.absolute().parents) if each.exists())
    return there.is_dir() and os.access(there, os.W_OK | os.X_OK)
