"""Where numba keeps what it compiled, where it finds no place by itself.

Beside the modules and in the user's folder of caches it looks itself; a read-only installation
without a home has neither, and then nothing compiles at all.
"""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from collections.abc import Iterable, MutableMapping
from pathlib import Path

KEY = "NUMBA_CACHE_DIR"


def give_place(environment: MutableMapping[str, str], places: Iterable[Path]) -> None:
    """Name a folder for compiled code, unless one is named or one of the places can be written.

    Parameters
    ----------
    environment : mapping
        Where it is named: ``os.environ``.
    places : iterable of Path
        Where numba looks by itself.
    """
    if KEY in environment or any(map(_can_be_written, places)):
        return
    own = environment.get("PLACECUE_CACHE")
    if own and _can_be_written(Path(own)):
        environment[KEY] = str(Path(own) / "compiled")
        return
    try:
        # Not shared with other users: what lies in it is run.
        folder = tempfile.mkdtemp(prefix="placecue-")
    except OSError:
        return  # numba says it where something is compiled
    environment[KEY] = folder
    atexit.register(shutil.rmtree, folder, ignore_errors=True)


def arrange() -> None:
    """Do so for this process."""
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")  # noqa: PTH111
    give_place(os.environ, [Path(__file__).parent, Path(cache)])


def _can_be_written(place: Path) -> bool:
    """Tell whether a folder can be written; one that is not there yet is made."""
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(place, os.W_OK | os.X_OK)
