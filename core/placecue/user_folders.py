"""Where in the user's home things may be kept."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """Return placecue's folder of caches, which need not be there.

    Raises
    ------
    RuntimeError
        Of a user without a home.
    """
    caches = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    return Path(caches, "placecue").expanduser()
